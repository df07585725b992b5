"""Runs of small worlds in a thread of the test's own process, which plays their clients."""

from __future__ import annotations

import re
import socket
import textwrap
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

from sim.build import load
from sim.engine import Engine, Settings
from sim.fleet.fleet import Fleet
from sim.result import Result
from tests.patience import PATIENCE

World = Callable[..., Path]
"""What the fixture `world` gives: it writes a world file."""

LONG = 100_000.0
"""Simulated seconds: until the test has seen enough."""


class NoProcesses:
    """In place of the fork server, where a world has no controller that is to be started."""

    def __init__(self) -> None:
        self.pids: dict[int, int] = {}
        self.lost = False

    def attach(self, watch: Any, unwatch: Any) -> None:
        """There are no news."""

    def take_ended(self) -> dict[int, int]:
        return {}

    def close(self) -> None:
        """There is nothing to end."""


class Serving:
    """A run that is going on. While it waits for a client, its state may be looked at."""

    def __init__(
        self,
        path: Path,
        *,
        duration: float = LONG,
        seed: int = 1,
        processes: bool = False,
        patience: float = 60.0,
        realtime: float | None = None,
        free: bool = False,
        now: Callable[[], float] | None = None,
        listen: tuple[str, int] | None = ("127.0.0.1", 0),
        each_tick: Callable[[Engine], None] | None = None,
    ) -> None:
        self.lines: list[str] = []
        self.told = threading.Condition()
        settings = Settings(
            seed, duration, realtime=realtime, free=free, listen=listen, patience=patience
        )
        fleet: Any = Fleet(show=self.say) if processes else NoProcesses()
        self.engine = Engine(load(path), settings, fleet, self.say)
        if now is not None:
            self.engine.pace.now = now
        self.outcome: Result | BaseException | None = None
        self.each_tick = each_tick
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self) -> None:
        try:
            self.outcome = self.engine.run(self.each_tick)
        except BaseException as error:
            self.outcome = error
        with self.told:
            self.told.notify_all()

    def say(self, line: str) -> None:
        with self.told:
            self.lines.append(line)
            self.told.notify_all()

    def line(self, pattern: str, within: float = PATIENCE) -> re.Match[str]:
        """The first line that matches, now or as soon as it is said."""

        def found() -> re.Match[str] | None:
            return next((m for line in self.lines if (m := re.search(pattern, line))), None)

        with self.told:
            ended = lambda: self.outcome is not None  # noqa: E731
            assert self.told.wait_for(lambda: found() or ended(), within), (pattern, self.lines)
            match = found()
        assert match is not None, (pattern, self.lines, self.outcome)
        return match

    def port(self, robot: str) -> int:
        """The port at which a robot is served."""
        return int(self.line(rf"^{robot} is served at .*:(\d+)$")[1])

    @property
    def shared_port(self) -> int:
        return int(self.line(r"robots are served at .*:(\d+), by index")[1])

    def pose(self, robot: int = 0) -> tuple[float, float, float]:
        """Where a robot really is."""
        x, y, yaw = map(float, self.engine.scenery.stage.poses[robot])
        return x, y, yaw

    def result(self, within: float = PATIENCE) -> Result:
        """The result, when the run has come to its end."""
        self.thread.join(within)
        assert not self.thread.is_alive(), self.lines
        if isinstance(self.outcome, BaseException):
            raise self.outcome
        assert self.outcome is not None
        return self.outcome

    def stop(self) -> Result:
        """End the run from outside; its result so far."""
        self.engine.crew.interrupted = True
        self.wake()
        return self.result()

    def wake(self) -> None:
        """Have the run look up from its wait."""
        for listener in list(self.engine.server._listeners):
            try:
                socket.create_connection(listener.getsockname()[:2], timeout=PATIENCE).close()
            except OSError:
                continue
            return

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.thread.is_alive():
            self.stop()


def write_world(folder: Path, world: str) -> Path:
    """A world file of that text."""
    path = folder / "world.yaml"
    path.write_text(textwrap.dedent(world))
    return path
