"""A run that is watched: what the engine is at, and what hands do to it. Nothing else knows both.

It hangs on to the engine by what `sim.run` calls after each tick and while the world waits. What a
hand does, it does while the world waits, between two ticks; all of it is put down in the result,
and `Repeat` does it again.
"""

from __future__ import annotations

import contextlib
import math
import socket
from collections.abc import Iterable, Sequence
from dataclasses import replace
from time import monotonic, thread_time
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.result import Touch
from sim.view.moment import AWAITED, SETTLED, STALLED, TOUCHING, Moment, Robot
from sim.view.present import ENDED
from troupe.live.asks import Ask
from troupe.live.exchange import Exchange
from troupe.live.readings import Eyes, Shown
from troupe.live.scene import MOST_FANS, scene_of

if TYPE_CHECKING:
    from sim.engine import Engine

AWAITED_AFTER = 0.5
"""Wall-clock seconds of waiting after which a page tells for whom."""
MOST_AWAITED = 5
REFRESH = 0.25
"""Wall-clock seconds between two moments while the world stands."""
MOST_TOLD, MOST_SAID = 12, 20
"""Lines of a controller's output, and of what it said, on its robot's card."""


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
        self._eyes: Eyes
        self._paint: tuple[tuple[float, float], Any] = ((0.0, 0.0), None)
        self._offered = 0.0
        self._seen: frozenset[int] = frozenset()
        self._robots: list[Robot] = []
        self._waits: dict[int, tuple[float, float]] = {}  # robot: last wait, longest wait
        self._behind: dict[int, float] = {}
        self._ears: tuple[socket.socket, socket.socket] | None = None
        self._outcome: str | None = None

    # -- what the engine calls --------------------------------------------------------------

    def each_tick(self, engine: Engine) -> None:
        """Show where the run is, if somebody wants to know."""
        if engine is not self._engine:
            self._begin(engine)
        engine.context.held = self._stands(engine)
        if self.exchange.due:
            self._offer(engine)

    def while_waiting(self, engine: Engine) -> None:
        """Obey hands; show what they did, and for whom the world waits."""
        if engine is not self._engine:
            self._begin(engine)
        if self.exchange.selected:
            self._time_waits(engine)
        asks = self.exchange.take()
        for ask in asks:
            self._obey(engine, ask)
        engine.context.held = self._stands(engine)
        changed = bool(asks) or self.exchange.selected != self._seen
        if changed or (self.exchange.due and monotonic() - self._offered > REFRESH):
            self._offer(engine)

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
                seed = self._engine.settings.seed
                self.restart = seed if ask.seed is None else ask.seed
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
        self._eyes = Eyes(engine)
        self._robots, self._waits, self._behind = [], {}, {}
        self._paint = ((0.0, 0.0), None)
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

    # -- hands ------------------------------------------------------------------------------

    def _obey(self, engine: Engine, ask: Ask) -> None:
        if self.stepped and ask.do in ("pause", "go", "step", "pace"):
            self.exchange.tell("a program makes the steps of this run")
            return
        match ask.do:
            case "pause":
                if self.hold is None:
                    note(engine, "pause")
                self.hold = engine.ticks
            case "go":
                self.hold = None
                engine.pace.begin(engine.time)
            case "step":
                self.hold = max(self.hold or 0, engine.ticks) + ask.count
            case "pace":
                engine.realtime = ask.numbers[0] if ask.numbers else None
            case "again" if self.again:
                self.restart = engine.settings.seed if ask.seed is None else ask.seed
                engine.crew.interrupted = True
            case "put":
                if not put(engine, ask.robot, ask.numbers):
                    self._tell(engine, ask.robot, "there is no room for it there")
            case "put_thing":
                if not put_thing(engine, ask.robot, ask.numbers):
                    self.exchange.tell("there is no room for it there")
            case "drive":
                refusal = drive(engine, ask.robot, ask.numbers)
                if refusal:
                    self._tell(engine, ask.robot, refusal)
                elif engine.realtime is None:
                    engine.realtime = 1.0  # nobody can drive at a hundred times real time

    def _tell(self, engine: Engine, robot: int, what: str) -> None:
        if robot < len(engine.robots):
            self.exchange.tell(f"{engine.robots[robot].name}: {what}")

    def _time_waits(self, engine: Engine) -> None:
        """How long the world waited for those who are selected, as far as it can be seen here."""
        now, behind = monotonic(), engine.crew.behind
        for robot in self.exchange.selected:
            if robot in behind:
                self._behind[robot] = behind[robot].since
            elif (since := self._behind.pop(robot, None)) is not None:
                wait = now - since
                self._waits[robot] = wait, max(wait, self._waits.get(robot, (0.0, 0.0))[1])

    # -- moments ----------------------------------------------------------------------------

    def _offer(self, engine: Engine) -> None:
        began = thread_time()
        self._seen = self.exchange.selected
        moment = self.moment(engine)
        self._offered = monotonic()
        cost, idle = thread_time() - began, engine.realtime is not None
        self.exchange.offer(moment, cost, idle=idle)

    def moment(self, engine: Engine) -> Moment:
        """What the engine is at."""
        scenery = engine.scenery
        stage, records = scenery.stage, [robot.record for robot in engine.robots]
        self._robots += [Robot(r.name, r.model) for r in records[len(self._robots) :]]
        awaited = engine.behind(AWAITED_AFTER)
        settled = np.array([record.state in ENDED for record in records], bool)
        shown = self._eyes.look(engine, settled, self.exchange.selected)
        return Moment(
            time=engine.time,
            tick=engine.ticks,
            poses=stage.poses.astype(np.float32),
            colors=np.array([robot.color for robot in engine.robots], np.uint32),
            states=self._states(engine, settled, awaited),
            robots=list(self._robots) if len(self._robots) < len(records) else self._robots,
            things=stage.movable_poses.astype(np.float32),
            fans=shown.fans,
            cones=shown.cones,
            sights=shown.sights,
            marks=shown.marks,
            switches=shown.switches,
            paint=self._floor(engine),
            said=[(k, *record.said[-1]) for k, record in enumerate(records) if record.said],
            drawn=drawings(engine),
            status=self._status(engine, awaited),
            cards={
                robot: self._card(engine, robot, shown)
                for robot in self.exchange.selected
                if robot < len(records)
            },
        )

    def _states(self, engine: Engine, settled: Any, awaited: dict[str, float]) -> Any:
        stage = engine.scenery.stage
        states = SETTLED * settled + STALLED * stage.stalls + TOUCHING * stage.touching
        for name in awaited:
            states[engine.context.by_name[name].index] += AWAITED
        return states.astype(np.uint8)

    def _floor(self, engine: Engine) -> Any:
        """A copy of the paint; the last one while nothing is painted."""
        floor = engine.scenery.floor
        if floor.painted_area <= 0.0:
            return None
        worn = (floor.painted_area, floor.passes)  # every sweep changes one of them
        if worn != self._paint[0]:
            self._paint = worn, floor.owner.copy()
        return self._paint[1]

    def _status(self, engine: Engine, awaited: dict[str, float]) -> dict[str, Any]:
        floor = engine.scenery.floor
        late = sorted(awaited.items(), key=lambda item: -item[1])[:MOST_AWAITED]
        return {
            "paused": self._stands(engine) or engine.context.paused,
            "pace": engine.realtime,
            "seed": engine.settings.seed,
            "waiting": [[name, round(wait, 1)] for name, wait in late],
            "coverage": round(floor.coverage, 5) if floor.painted_area > 0.0 else None,
            "running": sum(robot.record.state == "running" for robot in engine.robots),
            "outcome": self._outcome,
        }

    def _card(self, engine: Engine, robot: int, shown: Shown) -> dict[str, Any]:
        """What is known of one robot."""
        scenery, record = engine.scenery, engine.robots[robot].record
        stage, driver = scenery.stage, engine.robots[robot].driver
        output = engine.fleet.outputs.get(robot)
        since = engine.crew.behind.get(robot)
        pose, odometry = stage.poses[robot], scenery.odometry.poses[robot]
        last, longest = self._waits.get(robot, (0.0, 0.0))
        kind, wish = stage.command_of(robot)
        return {
            "name": record.name,
            "model": record.model,
            "pose": pose.tolist(),
            "twist": stage.velocities[robot].tolist(),
            "odometry": odometry.tolist(),
            "error": odometry_error(engine, robot),
            "command": [kind, list(wish)],
            "stalled": bool(stage.stalls[robot]),
            "distance": float(stage.distances[robot]),
            "stalls": record.stalls,
            "contacts": int(stage.contact_counts[robot]),
            "controller": {
                "kind": driver.kind,
                "state": record.state,
                "exit_code": record.exit_code,
                "error": None if record.error is None else record.error[-2000:],
                "waited": None if since is None else monotonic() - since.since,
                "last_wait": last,
                "longest_wait": longest,
            },
            "drivable": may_drive(engine, robot) is None,
            "devices": list(record.devices),
            "properties": dict(record.properties),
            "said": [list(line) for line in record.said[-MOST_SAID:]],
            "output": [] if output is None else list(output.tail)[-MOST_TOLD:],
            "sensors": shown.sensors.get(robot, []),
        }


# -- what hands do, each by one function that `Repeat` calls as well


def put(engine: Engine, robot: int, pose: Sequence[float]) -> bool:
    """Lift a robot and put it down; False, and nothing done, where there is no room for it."""
    scenery = engine.scenery
    if not 0 <= robot < scenery.stage.count:
        return False
    goal = (pose[0], pose[1], math.remainder(pose[2], math.tau))
    if scenery.put({robot: goal}):
        return False
    scenery.refresh()
    note(engine, "put", engine.robots[robot].name, goal)
    return True


def put_thing(engine: Engine, thing: int, pose: Sequence[float]) -> bool:
    """The same for something that can be pushed."""
    scenery = engine.scenery
    goal = (pose[0], pose[1], math.remainder(pose[2], math.tau))
    if not scenery.stage.put_movable(thing, goal):
        return False
    scenery.refresh()
    note(engine, "put_thing", str(thing), goal)
    return True


def may_drive(engine: Engine, robot: int) -> str | None:
    """Why a robot cannot be driven by hand; None: it can."""
    if not 0 <= robot < engine.scenery.stage.count:
        return "there is no such robot"
    driver, stage = engine.robots[robot].driver, engine.scenery.stage
    if not driver.drives:
        return "it has no drive"
    if stage.settled[robot]:
        return "it has become a standing body, as its controller has ended"
    if driver.launched and driver.running:
        return "its controller drives it"
    if driver.driving:
        return "a client drives it"
    return None


def drive(engine: Engine, robot: int, twist: Sequence[float]) -> str | None:
    """Have a robot drive from the next tick on; why not, if it cannot."""
    refusal = may_drive(engine, robot)
    if refusal is not None:
        return refusal
    context, wish = engine.context, (twist[0], twist[1], twist[2])
    driven = engine.robots[robot]
    context.later(driven, lambda: context.drive(driven, wish), "hand")
    engine.drivers.clocks.has_asked(driven.driver)  # the hand is there: nobody waits
    note(engine, "drive", driven.name, wish)
    return None


def note(engine: Engine, what: str, who: str | None = None, numbers: Sequence[float] = ()) -> None:
    """Put down what a hand did; of the same to the same within one tick the last counts."""
    touch = Touch(engine.time, engine.ticks, who, what, tuple(map(float, numbers)))
    engine.touched[:] = [
        each
        for each in engine.touched
        if (each.tick, each.robot, each.what) != (touch.tick, touch.robot, touch.what)
    ] + [touch]


class Repeat:
    """Does again what hands did in another run of the same world and seed."""

    def __init__(self, touched: Iterable[Touch]) -> None:
        self.left = sorted(touched, key=lambda touch: touch.tick)

    def while_waiting(self, engine: Engine) -> None:
        """What was done at this tick is done now."""
        now = []
        while self.left and self.left[0].tick <= engine.ticks:
            now.append(self.left.pop(0))
        if not now:
            return
        robots = {robot.name: robot.index for robot in engine.robots}
        puts = {robots[t.robot]: t.numbers for t in now if t.what == "put" and t.robot in robots}
        if puts:  # all at once: one may have come to where another one was
            poses = {robot: (x, y, yaw) for robot, (x, y, yaw) in puts.items()}
            engine.scenery.put(poses)
            engine.scenery.refresh()
        for touch in now:
            if touch.what == "put_thing" and touch.robot is not None:
                put_thing(engine, int(touch.robot), touch.numbers)
            elif touch.what == "drive" and touch.robot in robots:
                drive(engine, robots[touch.robot], touch.numbers)
        engine.touched[:] = [t for t in engine.touched if t.tick != engine.ticks] + [
            replace(touch, time=engine.time) for touch in now
        ]


# -- small things that a moment has


def odometry_error(engine: Engine, robot: int) -> list[float]:
    """By how much what odometry says is wrong, in the world: metres, metres, radians."""
    estimate = engine.scenery.odometry.in_world(robot)
    x, y, yaw = engine.scenery.stage.poses[robot].tolist()
    return [estimate[0] - x, estimate[1] - y, math.remainder(estimate[2] - yaw, math.tau)]


def drawings(engine: Engine) -> list[dict[str, Any]]:
    """What programs have drawn, in their robots' frames."""
    return [
        {
            "robot": robot.index,
            "kind": shape.kind,
            "points": points.tolist(),
            "color": shape.color,
            "fill": shape.fill_color,
        }
        for robot in engine.robots
        for shape in robot.drawings
        if np.isfinite(points := np.array(shape.points, float).reshape(-1, 2)).all()
    ]


__all__ = ["MOST_FANS", "Repeat", "Watch"]
