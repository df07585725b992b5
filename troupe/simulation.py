"""The open run: a world that is stepped, asked and acted on from Python.

    with troupe.Simulation("wander", seed=3, controllers=False) as sim:
        while sim.time < 10.0:
            scan = sim.readings("laser")
            ahead = scan.ranges[:, 60:120].min(axis=1)
            sim.command(scan.robots, forward=0.4, turn=np.where(ahead < 1.5, 0.8, 0.0))
            sim.step()

Rules: a run by steps is the run of `troupe run`, tick by tick, and has its digest. Arrays that are
given out are copies. What is done between two steps (a command, a pose that is set, something
said) has its effect in the next one.
"""

from __future__ import annotations

import contextlib
import threading
import warnings
import weakref
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.engine import Engine, Settings
from sim.fleet.fleet import Fleet
from sim.fleet.functions import Controllers, FunctionError
from sim.fleet.idle import NoFleet
from sim.fleet.launching import kind_of
from sim.ports import try_ports
from sim.rehearsal import is_served, rehearse
from troupe.address import Address, parse_address
from troupe.driving import Driving, Robots
from troupe.given import checked_controllers, checked_patience, checked_seconds, checked_seed
from troupe.observed import Observed, Sensors
from troupe.opened import Kept, both, ended, nothing
from troupe.running import check_log
from troupe.setting import as_text
from troupe.warm import tell, warm_first
from troupe.world import World, loaded_world

if TYPE_CHECKING:
    from sim.result import Result
    from troupe.live.window import Window

Floats = NDArray[np.float64]


class RunError(RuntimeError):
    """A run that could not go on; `result` is what came out of it until then."""

    def __init__(self, message: str, result: Result) -> None:
        super().__init__(message)
        self.result = result


def to_nobody(line: str) -> None:
    """Lines for people that nobody has asked for."""


class Simulation(Observed):
    """One run of a world, tick by tick.

    Args:
        world: a world file, the name of one that comes with Troupe, a mapping, or a World.
        seed: all that is random follows from it; the world's unless given.
        controllers: True starts the world's controllers as processes, which then run in lockstep
            with `step`; False leaves all robots to Python; a mapping from names of controllers to
            functions has their robots driven by `function(robot)`, called once a tick in this
            process. In a mapping True starts a controller's processes, and robots of controllers
            that are not in it are left to Python.
        duration: simulated seconds at most; the world's unless given.
        set: changes to the world, such as `{"clock.interval": 0.05}`.
        listen: where Player clients can connect, as `"127.0.0.1:6665"` or (host, port).
        realtime: simulated seconds per wall-clock second, to which steps are held; as fast as
            possible unless given.
        free: nobody waits for Player clients from outside, and steps are held to real time.
        patience: wall-clock seconds that a process may keep the others waiting; 0: for ever.
        log: an MCAP file in which the run is kept, see docs/logs.md; the world file's unless given.
            It is whole when the simulation is closed. A run after `reset` has its own, whose name
            ends in -2, -3 and so on.
        log_sensors: the types of sensors whose readings it keeps as well, or `["all"]`.
        say: called with every line meant for people: what controllers print, what goes wrong. That
            kernels are compiled, which may take a minute, once, is else told on standard error.

    Raises:
        sim.worldfile.WorldError: the world has mistakes; all of them are in it.
        sim.log.errors.LogError: the log cannot be written. One that cannot be written to its end is
            a RuntimeWarning.
        ValueError: an argument cannot be.
    """

    def __init__(
        self,
        world: str | Path | Mapping[str, Any] | World,
        *,
        seed: int | None = None,
        controllers: Controllers = True,
        duration: float | None = None,
        set: Mapping[str, Any] | None = None,
        listen: Address | None = None,
        realtime: float | None = None,
        free: bool = False,
        patience: float = 60.0,
        log: str | Path | None = None,
        log_sensors: Sequence[str] | None = None,
        say: Callable[[str], None] = to_nobody,
    ) -> None:
        self._loaded = loaded_world(world, set or {})
        check_log(self._loaded, log, log_sensors)
        self._kept = Kept(log, log_sensors, as_text(set or {}))
        self._controllers = checked_controllers(controllers, self._loaded)
        self._settings = Settings(
            seed=checked_seed(self._loaded.world.seed if seed is None else seed),
            duration=checked_seconds(
                "duration", self._loaded.world.duration if duration is None else duration
            ),
            realtime=None if realtime is None else checked_seconds("realtime", realtime),
            free=free,
            listen=None if listen is None else parse_address("listen", listen),
            patience=checked_patience(patience),
        )
        self._say = say
        self._own = True
        self._lock: contextlib.AbstractContextManager[object] = contextlib.nullcontext()
        self._window: Window | None = None
        warm_first(tell if say is to_nobody else say)
        if is_served(self._loaded, self._settings.listen, self._controllers):
            rehearse(self._loaded, self._settings.seed)
        self._begin()

    @classmethod
    def watching(cls, engine: Engine) -> Self:
        """A simulation for hooks of a run that goes on by itself: it is asked, and not stepped."""
        made = cls.__new__(cls)
        made._loaded, made._settings, made._engine = engine.loaded, engine.settings, engine
        made._controllers, made._say = engine.controllers, engine.say
        made._sensors, made._wall_time = Sensors(), None
        made._driving = Driving(engine)
        made._end = weakref.finalize(made, nothing, engine, None)
        made._own = False
        made._lock, made._window = contextlib.nullcontext(), None
        return made

    # -- life ---------------------------------------------------------------------------------

    def _begin(self) -> None:
        """A new engine at tick 0, with the robots that are there from the start."""
        told = self._settings
        try_ports(self._loaded.world.player, told.listen, len(self._loaded.robots))
        recorder = self._kept.open(self._loaded, self._settings, self._say)
        say = self._say if recorder is None else both(self._say, recorder.line)
        fleet: Any = Fleet(show=say) if self._has_processes() else NoFleet()
        try:
            self._engine = Engine(
                self._loaded, self._settings, fleet, say, controllers=self._controllers
            )
        except BaseException:
            fleet.close()
            if recorder is not None:
                recorder.finish(None, None)
            raise
        self._recorder = recorder
        if recorder is not None:
            self._engine.sensing.logged = recorder.sensed.wanted
        self._driving = Driving(self._engine)
        self._end = weakref.finalize(self, ended, self._engine, recorder)
        self._sensors = Sensors()
        self._wall_time = None
        try:
            self._engine.begin()
        except BaseException:
            self._end()
            raise

    def _has_processes(self) -> bool:
        """Whether any robot of the world, or of its doors, gets a process."""
        told = self._controllers
        named = [robot.controller for robot in self._loaded.robots]
        named += [door.controller for door in self._loaded.layout.doors]
        known = self._loaded.world.controllers
        return any(
            kind_of(name, known) in ("program", "command")
            and (told if isinstance(told, bool) else told.get(name or "") is True)
            for name in {*named}
        )

    def reset(self, seed: int | None = None) -> None:
        """Start again in this same object, as a new run would, with another seed or the same."""
        if not self._own:
            raise RuntimeError("this run goes on by itself: a hook cannot reset it")
        if seed is not None:
            self._settings = replace(self._settings, seed=checked_seed(seed))
        with self._lock:
            self._stop()
            self._begin()

    def close(self) -> None:
        """End the run and its processes. What was recorded can still be asked for."""
        with self._lock:
            self._stop()
        if self._window is not None:
            self._window.close()

    def _stop(self) -> None:
        """End the run; its log is whole, its page shows how it ended."""
        if not self._end.alive:
            return
        if self._window is not None and not self._window.closed:
            self._window.leave(self.outcome or "interrupted")
        self._wall_time = perf_counter() - self._engine.began
        self._end()
        if self._recorder is not None and self._recorder.writer.error is not None:
            warnings.warn(self._recorder.writer.error, RuntimeWarning, stacklevel=3)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        state = self.outcome or ("going on" if self._end.alive else "closed")
        return f"<Simulation of {self.world}, seed {self.seed}: {self.time:g} s, {state}>"

    def step(self, n: int = 1) -> None:
        """Let `n` intervals of the clock go by, each when all processes have asked for data.

        It ends early where the run does. Raises RuntimeError for a step after the end, and
        RunError for a controller function that raises: the run is closed in order, and the error
        has its result.
        """
        if not self._own:
            raise RuntimeError("this run goes on by itself: a hook cannot step it")
        if n < 1:
            raise ValueError(f"step(n): n must be at least 1 (given: {n})")
        self._refuse_closed()
        engine = self._engine
        if engine.crew.interrupted:
            return  # `stop` may come at any moment
        if self.over:
            raise RuntimeError(
                f"the run is over at {self.time:g} s ({self.outcome}); reset() starts it anew"
            )
        for _ in range(n):
            engine.keep_pace()
            try:
                with self._lock:
                    if not engine.advance():
                        return
                    if self._recorder is not None:
                        self._recorder.each_tick(engine)
                    if self._window is not None:
                        self._window.each_tick(engine)
            except FunctionError as error:
                self.close()
                raise RunError(str(error), self.result()) from error.__cause__

    def _refuse_closed(self) -> None:
        if not self._end.alive:
            raise RuntimeError("this simulation has been closed; reset() starts it anew")

    def stop(self) -> None:
        """End the run as `interrupted`, from another thread, say: steps do nothing any more.

        One that waits for clients meanwhile ends when one of them says something, and within a
        second at the latest.
        """
        self._engine.crew.interrupted = True

    # -- what is done -------------------------------------------------------------------------

    def indices(self, robots: Robots | ArrayLike = None) -> NDArray[np.int64]:
        """Robots, given by index or name, as indices (k,); None: all of them.

        Raises ValueError for a robot that is not there.
        """
        return self._driving.indices(robots)

    def command(
        self,
        robots: Robots | ArrayLike = None,
        *,
        forward: ArrayLike = 0.0,
        side: ArrayLike = 0.0,
        turn: ArrayLike = 0.0,
    ) -> None:
        """Set the velocities that robots shall keep until told otherwise, from the next step on.

        Args:
            robots: indices or names (k,), or one; all of them unless given.
            forward, side: m/s ahead and to the left; a number for all, or (k,).
            turn: rad/s, counter-clockwise; a number for all, or (k,).

        Raises ValueError for a robot that is not there or that a controller drives, for shapes
        that do not fit, and for what is no finite number.
        """
        self._refuse_closed()
        with self._lock:
            self._driving.command(robots, forward, side, turn)

    def set_pose(self, robot: int | str, pose: ArrayLike) -> None:
        """Put a robot, at rest, to a pose (x, y, yaw) in metres and radians, at once.

        It may also be an obstacle, by its name, whether it can be pushed or not. Raises ValueError
        where it would lie outside or overlap something; what stands may overlap what stands.
        """
        self._refuse_closed()
        thing = self._engine.context.things.get(robot) if isinstance(robot, str) else None
        (index,) = self.indices(robot).tolist() if thing is None else (thing.number,)
        at = np.asarray(pose, np.float64)
        if at.shape != (3,) or not np.isfinite(at).all():
            raise ValueError(f"set_pose: a pose is three finite numbers x, y, yaw, not {pose!r}")
        goal = (float(at[0]), float(at[1]), float(at[2]))
        scenery = self._engine.scenery
        with self._lock:
            if thing is None:
                found = not scenery.put({index: goal})
            else:
                found = scenery.put_thing(index, goal)
            if not found:
                name = robot if thing is not None else self.names[index]
                raise ValueError(f"set_pose: there is no room for {name} at {goal}")
            self._engine.sensing.look_again()

    def spray(self, robot: int | str, on: bool = True, sprayer: int = 0) -> None:
        """Switch one of a robot's sprayers on or off, from the next step on.

        Raises ValueError where the robot has no such sprayer.
        """
        self._refuse_closed()
        (index,) = self.indices(robot).tolist()
        sprayers = self._engine.robots[index].sprayers
        if not 0 <= sprayer < len(sprayers):
            raise ValueError(f"spray: {self.names[index]} has no sprayer {sprayer}")
        sprayers[sprayer].on = bool(on)

    def say(self, robot: int | str, text: str) -> None:
        """Have a robot say something: it stands in the result, and in pictures for a while."""
        self._refuse_closed()
        (index,) = self.indices(robot).tolist()
        with self._lock:
            self._engine.robots[index].record.said.append((self.time, str(text)))
            self._engine.context.changes += 1

    # -- where it is looked at ----------------------------------------------------------------

    def show(
        self,
        address: str | tuple[str, int] = ("127.0.0.1", 0),
        *,
        browser: bool | None = None,
        read_only: bool = False,
    ) -> Window:
        """Show this run live in a page: at once, at every step, and between steps.

        Args:
            address: where it is served, as `"127.0.0.1:7000"` or (host, port); port 0: a free one.
            browser: whether a browser is opened; unless given, it is where no notebook shows it.
            read_only: whether whoever watches can only watch, and not move robots by hand.

        In a notebook the last line of a cell, `sim.show()`, shows the page there. What is given
        back has its `address`, and `close()`; it goes with this simulation. A second call gives the
        same page. Raises OSError where the address cannot be had.
        """
        from troupe.live.window import Window  # noqa: PLC0415 - loaded for those who watch

        if not self._end.alive or not self._own:
            raise RuntimeError("show: this run is closed, or goes on by itself")
        if self._window is None or self._window.closed:
            host, port = parse_address("show", address)
            self._lock = threading.RLock()
            self._window = Window(
                lambda: self._engine,
                self._lock,
                host,
                port,
                browser=browser,
                read_only=read_only,
                say=self._say,
            )
        return self._window
