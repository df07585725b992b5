"""A run that is watched: it hangs on to the engine, offers moments, and obeys what pages ask for.

`sim.run` calls it after each tick and while the world waits. What a hand does, it does while the
world waits, between two ticks.
"""

from __future__ import annotations

import contextlib
import socket
from functools import partial
from time import monotonic, thread_time
from typing import TYPE_CHECKING

from sim.view.moment import Moment
from troupe.live.asks import Ask
from troupe.live.exchange import Exchange
from troupe.live.hands import Hands
from troupe.live.run_moments import RunMoments
from troupe.live.saved_world import saved_world
from troupe.live.scene import scene_of
from troupe.live.waits import Waits

if TYPE_CHECKING:
    from sim.engine import Engine

REFRESH = 0.25
"""Wall-clock seconds between two moments while the world stands."""


class Watch:
    """Hands the engine's moments to the exchange, and obeys what comes back.

    `paused`: the world stands until somebody lets it go on. `again`: whether the run may be begun
    again; then `restart` has the seed that was asked for. `stepped`: a program makes the steps.
    """

    def __init__(
        self,
        exchange: Exchange,
        *,
        paused: bool = False,
        again: bool = True,
        stepped: bool = False,
    ) -> None:
        self.exchange = exchange
        self.again = again
        self.stepped = stepped
        self.restart: int | None = None
        self.hold: int | None = 0 if paused else None
        """The tick at which the world is to stand; None: nowhere."""
        self._engine: Engine | None = None
        self._hands: Hands
        self._waits: Waits
        self._moments: RunMoments
        self._offered = 0.0
        self._seen: frozenset[int] = frozenset()
        self._ears: tuple[socket.socket, socket.socket] | None = None
        self._outcome: str | None = None

    # -- what the engine calls --------------------------------------------------------------

    def each_tick(self, engine: Engine) -> None:
        """Show where the run is, if somebody wants to know."""
        if engine is not self._engine:
            self._begin(engine)
        if self.exchange.selected or self._waits.kept:
            self._waits.begin(self.exchange.selected)
        if self.hold is not None:
            engine.context.held = self._stands(engine)
        if self.exchange.due:
            self._offer(engine)

    def while_waiting(self, engine: Engine) -> None:
        """Obey hands; show what they did, and for whom the world waits."""
        if engine is not self._engine:
            self._begin(engine)
        if self._idle():
            return
        self._waits.look(engine.crew.behind)
        asks = self.exchange.take()
        for ask in asks:
            self._obey(engine, ask)
        if self._hands.taken:
            self._hands.hold()
        engine.context.held = self._stands(engine)
        changed = bool(asks) or self.exchange.selected != self._seen
        if changed or (self.exchange.due and monotonic() - self._offered > REFRESH):
            self._offer(engine)

    def _idle(self) -> bool:
        """Whether nobody wants anything: the run asks several times a tick."""
        exchange = self.exchange
        return not (
            exchange.asked
            or exchange.selected
            or self._seen
            or self._hands.taken
            or self.hold is not None
            or (exchange.hungry and monotonic() - self._offered > REFRESH)
        )

    # -- what the command calls when the run is over -----------------------------------------

    def finish(self, outcome: str) -> None:
        """The run has ended; the last moment says how."""
        self._outcome = outcome
        self.exchange.wake = lambda: None
        if self._ears is not None:
            for ear in self._ears:
                ear.close()
            self._ears = None
        if self._engine is not None:
            self._offer(self._engine)

    def linger(self) -> None:
        """The run is over, and still looked at: cards show, and it may be begun again."""
        for ask in self.exchange.take():
            if ask.do == "again" and self.again and self._engine is not None:
                self._begin_again(self._engine, ask)
            elif ask.do not in ("pause", "go"):
                self.exchange.tell("the run is over")
        if self._engine is not None and self.exchange.selected != self._seen:
            self._offer(self._engine)

    def leave(self) -> None:
        """Nothing more of this run is shown."""
        self._engine, self._outcome, self.restart = None, None, None

    # -- how it hangs on to the engine ------------------------------------------------------

    def _begin(self, engine: Engine) -> None:
        self._engine = engine
        self._hands, self._waits = Hands(engine), Waits()
        self._moments = RunMoments(engine, self._hands, self._waits)
        engine.context.held = self._stands(engine)
        hearing, ringing = self._ears = socket.socketpair()
        hearing.setblocking(False)
        ringing.setblocking(False)

        def heard() -> None:
            with contextlib.suppress(BlockingIOError):
                hearing.recv(4096)

        def ring() -> None:
            with contextlib.suppress(OSError):  # it has been rung often enough, or all is over
                ringing.send(b"!")

        engine.server.watch(hearing, heard)
        self.exchange.wake = ring
        told = engine.settings
        self.exchange.world = partial(saved_world, engine.loaded)
        self.exchange.show(
            scene_of(
                engine.loaded,
                seed=told.seed,
                duration=told.duration,
                again=self.again,
                stepped=self.stepped,
            )
        )
        self._offer(engine)

    def _stands(self, engine: Engine) -> bool:
        return self.hold is not None and engine.ticks >= self.hold

    def _obey(self, engine: Engine, ask: Ask) -> None:
        if self.stepped and ask.do in ("pause", "go", "step", "pace"):
            self.exchange.tell("a program makes the steps of this run")
            return
        match ask.do:
            case "pause":
                if self.hold is None:
                    self._hands.note("pause")
                self.hold = engine.ticks
            case "go":
                self.hold = None
                engine.pace.begin(engine.time)
            case "step":
                self.hold = max(self.hold or 0, engine.ticks) + ask.count
            case "pace":
                engine.realtime = ask.numbers[0] if ask.numbers else None
            case "again" if self.again:
                self._begin_again(engine, ask)
                engine.crew.interrupted = True
            case "put":
                if not self._hands.put(ask.robot, ask.numbers):
                    self._tell(engine, ask.robot, "there is no room for it there")
            case "put_thing":
                if not self._hands.put_thing(ask.robot, ask.numbers):
                    self.exchange.tell("there is no room for it there")
            case "drive":
                refusal = self._hands.drive(ask.robot, ask.numbers)
                if refusal is not None:
                    self._tell(engine, ask.robot, refusal)
                elif engine.realtime is None:
                    engine.realtime = 1.0  # nobody can drive at a hundred times real time
            case "take":
                refusal = self._hands.take(ask.robot)
                if refusal is not None:
                    self._tell(engine, ask.robot, refusal)
            case "give":
                self._hands.give(ask.robot)

    def _begin_again(self, engine: Engine, ask: Ask) -> None:
        """With another seed, or the same; a run that stands stands at its beginning then."""
        self.restart = engine.settings.seed if ask.seed is None else ask.seed
        if self.hold is not None:
            self.hold = 0

    def _tell(self, engine: Engine, robot: int, what: str) -> None:
        if robot < len(engine.robots):
            self.exchange.tell(f"{engine.robots[robot].name}: {what}")

    def _offer(self, engine: Engine) -> None:
        began = thread_time()
        self._seen = self.exchange.selected
        moment = self.moment(engine)
        self._offered = monotonic()
        idle = engine.pace.ahead(engine.time) > 0.0
        self.exchange.offer(moment, thread_time() - began, idle=idle)

    def moment(self, engine: Engine) -> Moment:
        """What the engine is at."""
        return self._moments.now(self._seen, stands=self._stands(engine), outcome=self._outcome)
