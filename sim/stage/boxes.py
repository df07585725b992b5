"""Upright boxes by number, found by where they lie, however many there are."""

from __future__ import annotations

import math

import numpy as np

from sim.stage.geometry import Floats

FEW = 128
"""Boxes up to which all are looked at: that is quicker than to look for them."""
MOST_CELLS = 64
"""Cells in which a box may lie; a larger one is looked at always."""


class Boxes:
    """Boxes x0, y0, x1, y1, sorted into square cells once there are more than a few."""

    def __init__(self) -> None:
        self._bounds: Floats = np.zeros((64, 4))  # with room for more
        self._count = 0
        self._cells: dict[tuple[int, int], list[int]] = {}
        self._large: list[int] = []
        self._size = 0.0  # of a cell in metres; 0: none are sorted
        self._sorted_for = FEW  # boxes up to which the size is right

    def __len__(self) -> int:
        return self._count

    def add(self, low: Floats, high: Floats) -> None:
        """Add a box from low (2,) to high (2,)."""
        if self._count == len(self._bounds):
            self._bounds = np.concatenate([self._bounds, np.zeros_like(self._bounds)])
        self._bounds[self._count, :2], self._bounds[self._count, 2:] = low, high
        self._count += 1
        if self._count > self._sorted_for:
            self._sort()
        elif self._size:
            self._put(self._count - 1)

    def back_to(self, count: int) -> None:
        """Forget all but the first `count`."""
        self._count = count
        self._cells.clear()
        self._size, self._sorted_for = 0.0, max(FEW, count)
        if count > FEW:
            self._sort()

    def near(self, low: Floats, high: Floats) -> list[int]:
        """The numbers, ascending, of those that reach into the box from low (2,) to high (2,)."""
        bounds = self._bounds[: self._count]
        if self._size:
            found = set(self._large)
            for cell in self._cells_of(*low.tolist(), *high.tolist()):
                found.update(self._cells.get(cell, ()))
            numbers = np.array(sorted(found), np.int64)
            bounds = bounds[numbers]
        inside = np.nonzero(
            (bounds[:, 0] <= high[0])
            & (bounds[:, 1] <= high[1])
            & (bounds[:, 2] >= low[0])
            & (bounds[:, 3] >= low[1])
        )[0]
        reaching: list[int] = (numbers[inside] if self._size else inside).tolist()
        return reaching

    def _sort(self) -> None:
        """Sort all into cells anew, about one box in each."""
        bounds = self._bounds[: self._count]
        width, height = bounds[:, 2:].max(axis=0) - bounds[:, :2].min(axis=0)
        usual = float(np.median(bounds[:, 2:] - bounds[:, :2]))
        size = max(math.sqrt(width * height / self._count), usual, 1e-9)
        self._size, self._sorted_for = size, 4 * self._count
        self._cells.clear()
        self._large.clear()
        for number in range(self._count):
            self._put(number)

    def _put(self, number: int) -> None:
        x0, y0, x1, y1 = self._bounds[number].tolist()
        across, up = (x1 - x0) / self._size + 2.0, (y1 - y0) / self._size + 2.0
        if across * up > MOST_CELLS:
            self._large.append(number)
            return
        for cell in self._cells_of(x0, y0, x1, y1):
            self._cells.setdefault(cell, []).append(number)

    def _cells_of(self, x0: float, y0: float, x1: float, y1: float) -> list[tuple[int, int]]:
        size = self._size
        columns = range(math.floor(x0 / size), math.floor(x1 / size) + 1)
        rows = range(math.floor(y0 / size), math.floor(y1 / size) + 1)
        return [(column, row) for column in columns for row in rows]
