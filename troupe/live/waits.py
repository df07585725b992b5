"""How long the world waited for robots' controllers, tick by tick, of those that are looked at."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Container
from time import monotonic

KEPT = 100
"""Ticks."""


class Waits:
    """Waits of robots in wall-clock seconds: from when data went out to when it was asked for."""

    def __init__(self) -> None:
        self._since = monotonic()
        self._open: set[int] = set()
        self.kept: dict[int, deque[float]] = {}
        """The waits of the last ticks, by robot."""
        self._longest: dict[int, float] = {}

    def begin(self, selected: Collection[int]) -> None:
        """A tick is over: from now on the world waits for the next requests."""
        self._since = monotonic()
        self._open = set(selected)
        for robot in self.kept.keys() - self._open:
            del self.kept[robot], self._longest[robot]

    def look(self, behind: Container[int]) -> None:
        """Whoever is no longer behind has asked."""
        if not self._open:
            return
        wait = monotonic() - self._since
        for robot in [robot for robot in self._open if robot not in behind]:
            self._open.discard(robot)
            self.kept.setdefault(robot, deque(maxlen=KEPT)).append(wait)
            self._longest[robot] = max(wait, self._longest.get(robot, 0.0))

    def of(self, robot: int) -> tuple[list[float], float]:
        """The waits of a robot's last ticks, and the longest since it is looked at."""
        return list(self.kept.get(robot, ())), self._longest.get(robot, 0.0)
