"""Walls on a raster (from an image or text map) as merged rectangles and merged outlines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


MOST_OUTLINES = 250_000
"""Segments of the outlines of a map's walls. A floorplan has some thousands; a photograph has one
for every grain."""
_CELLS_AT_ONCE = 1_000_000


class TooRagged(ValueError):
    """Walls that are too many small pieces for a world: more than `MOST_OUTLINES` segments."""


@dataclass(frozen=True)
class Raster:
    """Walls as cells: `walls` (rows, columns) bool with row 0 at the top, `cell` in metres.

    low: x, y of its lower left corner in the world.
    """

    walls: Bools
    cell: float
    low: tuple[float, float] = (0.0, 0.0)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height in metres."""
        rows, columns = self.walls.shape
        return columns * self.cell, rows * self.cell

    def centre(self, column: int, row: int) -> tuple[float, float]:
        """World position of a cell's centre; column and row count from the top left, from 0."""
        rows = self.walls.shape[0]
        x, y = self.low
        return x + (column + 0.5) * self.cell, y + (rows - row - 0.5) * self.cell

    def at(self, x: float, y: float) -> tuple[int, int]:
        """Column and row of the cell that holds a world position (it may lie off the raster)."""
        rows = self.walls.shape[0]
        column, row = (x - self.low[0]) / self.cell, (y - self.low[1]) / self.cell
        return int(np.floor(column)), rows - 1 - int(np.floor(row))

    def is_wall(self, points: ArrayLike) -> Bools:
        """For world points (n, 2), whether each lies in a wall's cell; (n,) bool."""
        flat = np.asarray(points, dtype=np.float64)
        rows, columns = self.walls.shape
        column = np.floor((flat[:, 0] - self.low[0]) / self.cell).astype(np.int64)
        row = rows - 1 - np.floor((flat[:, 1] - self.low[1]) / self.cell).astype(np.int64)
        on = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        found = np.zeros(len(flat), dtype=np.bool_)
        found[on] = self.walls[row[on], column[on]]
        return found


def _runs(marks: NDArray[np.int8], most: int | None = None) -> NDArray[np.int64]:
    """Runs of equal non-zero marks along each row of (rows, columns): (k, 3) row, start, end.

    Raises TooRagged where there are more than `most`.
    """
    rows, columns = marks.shape
    found: list[NDArray[np.int64]] = []
    count = 0
    band = max(1, _CELLS_AT_ONCE // (columns + 2))
    for first in range(0, rows, band):
        part = marks[first : first + band]
        padded = np.zeros((len(part), columns + 2), dtype=np.int8)
        padded[:, 1:-1] = part
        changes = padded[:, 1:] != padded[:, :-1]
        row, column = np.nonzero(changes & (padded[:, 1:] != 0))
        end_row, end_column = np.nonzero(changes & (padded[:, :-1] != 0))
        assert np.array_equal(row, end_row)
        count += len(row)
        if most is not None and count > most:
            raise TooRagged
        found.append(np.stack([row + first, column, end_column], axis=1))
    return np.concatenate([np.zeros((0, 3), np.int64), *found])


def merged_rectangles(walls: Bools) -> NDArray[np.int64]:
    """Cover the walls exactly by few rectangles that do not overlap.

    Greedy: the runs of each row, and equal runs of rows below one another become one rectangle.
    Returns (k, 4) left column, top row, right column, bottom row; right and bottom excluded.
    """
    done: list[tuple[int, int, int, int]] = []
    growing: dict[tuple[int, int], int] = {}  # (start, end) -> row of its top
    rows = len(walls)
    fresh = np.ones(rows, np.bool_)  # rows that are not as the one above them
    fresh[1:] = (walls[1:] != walls[:-1]).any(axis=1)
    for row in [*np.flatnonzero(fresh).tolist(), rows]:
        runs = _runs(walls[row : row + 1].astype(np.int8))[:, 1:].tolist() if row < rows else []
        here = {(start, end) for start, end in runs}
        for span in [span for span in growing if span not in here]:
            done.append((span[0], growing.pop(span), span[1], row))
        for span in here:
            growing.setdefault(span, row)
    return np.array(sorted(done, key=lambda r: (r[1], r[0])), dtype=np.int64).reshape(-1, 4)


def rectangles_in_world(raster: Raster) -> list[tuple[float, float, float, float]]:
    """The walls' merged rectangles as (left, bottom, right, top) in metres."""
    rows, cell, (x, y) = raster.walls.shape[0], raster.cell, raster.low
    return [
        (x + left * cell, y + (rows - bottom) * cell, x + right * cell, y + (rows - top) * cell)
        for left, top, right, bottom in merged_rectangles(raster.walls).tolist()
    ]


def merged_outlines(raster: Raster) -> Floats:
    """Edges between wall and free cells, merged to long segments: (m, 4) x1, y1, x2, y2.

    What lies off the raster is free, so that a wall at its edge is closed. A segment ends where
    wall and free side swap, hence at every corner. Raises TooRagged.
    """
    walls, cell = raster.walls, raster.cell
    rows, columns = walls.shape
    padded = np.zeros((rows + 2, columns + 2), dtype=np.int8)
    padded[1:-1, 1:-1] = walls
    level = _runs(
        padded[1:, 1:-1] - padded[:-1, 1:-1], MOST_OUTLINES
    )  # edge row r lies above cell row r
    across_columns = (padded[1:-1, 1:] - padded[1:-1, :-1]).T.copy()
    upright = _runs(across_columns, MOST_OUTLINES - len(level))  # edge column c, left of c
    height = rows * cell
    across = np.stack(
        [
            level[:, 1] * cell,
            height - level[:, 0] * cell,
            level[:, 2] * cell,
            height - level[:, 0] * cell,
        ],
        axis=1,
    )
    along = np.stack(
        [
            upright[:, 0] * cell,
            height - upright[:, 1] * cell,
            upright[:, 0] * cell,
            height - upright[:, 2] * cell,
        ],
        axis=1,
    )
    found = np.concatenate([across, along]).astype(np.float64)
    found += np.array([*raster.low, *raster.low])
    return found
