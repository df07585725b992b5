"""What happened in a log, in the order of ticks: as far as a tick, and back again."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from sim.log.reader import LogReader

Happening = TypeVar("Happening")


class Track(Generic[Happening]):
    """What happened, each with the tick at whose end it first stood, and how far one has gone.

    `take(happening)` is called for each that a new moment has besides the last one's; `forget()`
    before all are told again, because one has gone back.
    """

    def __init__(
        self,
        happenings: Iterable[tuple[int, Happening]],
        take: Callable[[Happening], object],
        forget: Callable[[], object],
    ) -> None:
        ordered = sorted(happenings, key=lambda one: one[0])
        self.ticks = [tick for tick, _ in ordered]
        self.happenings = [one for _, one in ordered]
        self.take, self.forget = take, forget
        self.at = 0

    def go(self, tick: int) -> None:
        """Bring what has been told to the end of a tick."""
        until = bisect_right(self.ticks, tick)
        if until < self.at:
            self.forget()
            self.at = 0
        for one in self.happenings[self.at : until]:
            self.take(one)
        self.at = until


class Paint:
    """The painted floor at any tick."""

    def __init__(self, reader: LogReader) -> None:
        ticks, cells, owners = [], [], []
        self.shape = (0, 0)
        self.resolution = 0.0
        for _, one in reader.messages("/troupe/paint"):
            self.shape, self.resolution = (one["rows"], one["columns"]), one["resolution"]
            ticks.append(one["tick"])
            cells.append(one["cells"])
            owners.append(one["owners"].astype(np.int16))
        self._ticks = ticks
        self._ends = [0, *np.cumsum([len(one) for one in cells]).tolist()]
        self._cells = np.concatenate([np.zeros(0, np.uint32), *cells])
        self._owners = np.concatenate([np.zeros(0, np.int16), *owners])
        if self._cells.size and int(self._cells.max()) >= self.shape[0] * self.shape[1]:
            raise reader.damaged("paint lies outside of the floor")
        self.at = 0
        """How many times it has been painted."""
        self.owner: NDArray[np.int16] = np.zeros(self.shape, np.int16)
        """(rows, columns) 1 + the robot that painted each cell last, 0: bare."""

    def go(self, tick: int) -> None:
        """Bring the floor to the end of a tick."""
        until = bisect_right(self._ticks, tick)
        if until < self.at:
            self.owner[:] = 0
            self.at = 0
        part = slice(self._ends[self.at], self._ends[until])
        # of a cell that is painted twice the last one counts: numpy keeps the order
        self.owner.reshape(-1)[self._cells[part]] = self._owners[part]
        self.at = until
