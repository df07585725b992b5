"""A world that is served in a thread of one's own process, to a controller that is under test.

    with Lockstep(world) as run:             # robots of `external` controllers wait for clients
        with PlayerClient("127.0.0.1", run.port("rover")) as client:
            ...                              # while it waits, the run may be looked at
        print(run.pose("rover"), run.evidence.poses.shape)

The world moves on when all that drive have asked for data, however slow the machine is: what comes
of it depends on the world, the seed and what the controllers do.
"""

from __future__ import annotations

import contextlib
import re
import socket
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from troupe.simulation import Simulation
from troupe.testing.evidence import Evidence, Watch
from troupe.testing.patience import PATIENCE

if TYPE_CHECKING:
    from player import Robot
    from sim.result import Result
    from troupe.world import World

LONG = 100_000.0
"""Simulated seconds: until who tests has seen enough."""


class Lockstep:
    """A run that is going on, served to clients. While it waits for one, it may be looked at.

    Args:
        world: a world file, the name of one that comes with Troupe, a mapping, or a World.
        seed: all that is random follows from it.
        duration: simulated seconds at most; for as long as clients drive unless given.
        set: changes to the world, such as `{"clock.interval": 0.05}`.
        controllers: as for `troupe.Simulation`.
        listen: (host, port) where clients can connect, port 0 for any that is free; None: as the
            world has it.
        realtime: simulated seconds per wall-clock second; as fast as clients go unless given.
        free: the world waits for no client and goes on in real time: no lockstep then.
        patience: wall-clock seconds that a client may keep the others waiting.
        each_tick: called with the simulation after every tick, in the run's thread.

    Raises what `troupe.Simulation` raises, and OSError for an address that cannot be had.
    """

    def __init__(
        self,
        world: str | Path | Mapping[str, Any] | World,
        *,
        seed: int = 1,
        duration: float = LONG,
        set: Mapping[str, Any] | None = None,
        controllers: bool | Mapping[str, Callable[[Robot], None] | bool] = True,
        listen: tuple[str, int] | None = ("127.0.0.1", 0),
        realtime: float | None = None,
        free: bool = False,
        patience: float = 60.0,
        each_tick: Callable[[Simulation], object] = lambda simulation: None,
    ) -> None:
        self.lines: list[str] = []
        """What was meant for people so far."""
        self._told = threading.Condition()
        self._watch = Watch()
        self._each_tick = each_tick
        self._ended: Result | BaseException | None = None
        self.simulation = Simulation(
            world,
            seed=seed,
            controllers=controllers,
            duration=duration,
            set=set,
            listen=listen,
            realtime=realtime,
            free=free,
            patience=patience,
            say=self._say,
        )
        self._prepare()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _prepare(self) -> None:
        """Called before the first tick."""

    def _run(self) -> None:
        simulation = self.simulation
        try:
            while not simulation.over:
                before = simulation.ticks
                simulation.step()
                if simulation.ticks > before:
                    self._watch(simulation)
                    self._each_tick(simulation)
            simulation.close()
            self._ended = simulation.result()
        except BaseException as error:
            self._ended = error
            simulation.close()
        with self._told:
            self._told.notify_all()

    def _say(self, line: str) -> None:
        with self._told:
            self.lines.append(line)
            self._told.notify_all()

    def line(self, pattern: str, within: float = PATIENCE) -> re.Match[str]:
        """The first line for people that matches, now or as soon as it is said.

        Raises AssertionError where the run ends without it, or after so many wall-clock seconds.
        """

        def found() -> re.Match[str] | None:
            return next((m for line in self.lines if (m := re.search(pattern, line))), None)

        with self._told:
            self._told.wait_for(lambda: found() or self._ended is not None, within)
            match = found()
        if match is None:
            raise AssertionError(f"no line has matched {pattern!r}: {self.lines} {self._ended!r}")
        return match

    def port(self, robot: str) -> int:
        """The port at which a robot is served."""
        return int(self.line(rf"^{re.escape(robot)} is served at .*:(\d+)$")[1])

    @property
    def shared_port(self) -> int:
        """The port at which all robots are served, by index (`player: {layout: shared}`)."""
        return int(self.line(r"robots are served at .*:(\d+), by index")[1])

    def environment(self, robot: str) -> dict[str, str]:
        """What tells a program its robot: PLAYER_HOST and PLAYER_PORT, as `PlayerClient` reads."""
        return {"PLAYER_HOST": "127.0.0.1", "PLAYER_PORT": str(self.port(robot))}

    def pose(self, robot: int | str = 0) -> tuple[float, float, float]:
        """Where a robot really is: x, y in m, yaw in rad."""
        (index,) = self.simulation.indices(robot).tolist()
        x, y, yaw = self.simulation.poses[index].tolist()
        return x, y, yaw

    @property
    def evidence(self) -> Evidence:
        """What a judge looks at, of the ticks so far."""
        return self._watch.evidence

    @property
    def running(self) -> bool:
        """Whether the run is going on."""
        return self._thread.is_alive()

    def result(self, within: float = PATIENCE) -> Result:
        """The result, when the run has come to its end; what it raised is raised again."""
        self._thread.join(within)
        if self._thread.is_alive():
            raise AssertionError(f"the run has not ended: {self.lines}")
        if isinstance(self._ended, BaseException):
            raise self._ended
        assert self._ended is not None
        return self._ended

    def stop(self) -> Result:
        """End the run; its result so far, of the outcome `interrupted`."""
        self.simulation.stop()
        self.wake()
        return self.result()

    def wake(self) -> None:
        """Have the run look up from its wait, by a client that comes and goes."""
        for line in list(self.lines):
            place = re.search(r"served at (\S+):(\d+)", line)
            if place is not None:
                with contextlib.suppress(OSError):
                    host = place[1].strip("[]")
                    socket.create_connection((host, int(place[2])), timeout=PATIENCE).close()
                return

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.running:
            self.stop()
