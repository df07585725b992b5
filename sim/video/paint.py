"""The paint layer of a frame: only cells that changed since the last frame are drawn anew."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sim.video.palette import TINTS, bgr
from sim.video.projection import Projection

STRENGTH = 0.5
"""Share of the tint in painted ground; the grid shines through the rest."""

Index = NDArray[np.intp]


def _painted() -> NDArray[np.uint8]:
    """(tints + 1, 3, 256) what becomes of a channel's value; the last tint is no paint."""
    value = np.arange(256, dtype=np.float64)
    channels = [[value * (1 - STRENGTH) + c * STRENGTH for c in bgr(color)] for color in TINTS]
    table: NDArray[np.uint8] = np.rint(np.array([*channels, [value] * 3])).astype(np.uint8)
    return table


_PAINTED = _painted()


class PaintLayer:
    """Keeps the ground with the paint on it, a pixel image that every frame starts from.

    A cell colours the pixels whose centres lie in it. Where cells are smaller than pixels,
    only those cells are looked at in which a pixel's centre lies.
    """

    def __init__(
        self, ground: NDArray[np.uint8], walls: NDArray[np.bool_], projection: Projection
    ) -> None:
        """`ground` (height, width, 3) BGR; `walls` (height, width) True where paint is hidden."""
        self.image = ground.copy()
        """(height, width, 3) BGR: the ground as it stands now."""
        self.mask = np.zeros(ground.shape[:2], np.uint8)
        """(height, width) 255 where there is paint."""
        self.any = False
        """Whether there has been any paint."""
        self._ground = ground
        self._walls = walls
        self._projection = projection
        self._floor: tuple[tuple[int, ...], float] | None = None

    def update(self, cells: NDArray[np.int16], resolution: float) -> None:
        """Brings the image up to `cells` (rows, cols), row 0 lowest, `resolution` in metres."""
        if self._floor != (cells.shape, resolution):
            self._survey(cells.shape, resolution)
        seen = cells[self._rows][:, self._columns] if self._sampled else cells
        changed = np.flatnonzero(seen != self._shown)
        if changed.size:
            rows, columns = np.divmod(changed, seen.shape[1])
            owners = seen[rows, columns]
            self._shown[rows, columns] = owners
            self._color(rows, columns, owners)

    def _survey(self, shape: tuple[int, ...], resolution: float) -> None:
        """Finds which pixels belong to which cell."""
        self._floor = (shape, resolution)
        p = self._projection
        x = (np.arange(p.width) + 0.5 - p.left) / p.scale - p.low[0]
        y = (p.bottom - np.arange(p.height) - 0.5) / p.scale - p.low[1]
        columns, rows = _cells_under(x, resolution, shape[1]), _cells_under(y, resolution, shape[0])
        self._sampled = resolution * p.scale < 1.0
        if self._sampled:
            # From here on the pixels' own cells stand for all cells.
            self._columns, self._rows = columns[columns >= 0], rows[rows >= 0]
            columns[columns >= 0] = np.arange(len(self._columns))
            rows[rows >= 0] = np.arange(len(self._rows))
            shape = (len(self._rows), len(self._columns))
        self._column_runs = _runs(columns, shape[1])
        self._row_runs = _runs(rows, shape[0])
        self._shown = np.zeros(shape, np.int16)
        self.image[:] = self._ground
        self.mask[:] = 0

    def _color(self, rows: Index, columns: Index, owners: NDArray[np.int16]) -> None:
        """Colours the pixels of the cells (rows, columns)."""
        first_row, last_row = (edge[rows] for edge in self._row_runs)
        first_column, last_column = (edge[columns] for edge in self._column_runs)
        down = np.arange((last_row - first_row).max() + 1)
        across = np.arange((last_column - first_column).max() + 1)
        # Cells differ by a pixel in size: the smaller ones colour their last pixel twice.
        v = np.minimum(first_row[:, None] + down, last_row[:, None])
        u = np.minimum(first_column[:, None] + across, last_column[:, None])
        pixels = (v * self._projection.width)[:, :, None] + u[:, None, :]
        ground = self._ground.reshape(-1, 3)[pixels]
        tints = np.where(owners > 0, (owners - 1) % len(TINTS), len(TINTS))
        bare = self._walls.ravel()[pixels]
        tint = np.where(bare, len(TINTS), tints[:, None, None])
        self.mask.ravel()[pixels] = np.where(tint < len(TINTS), np.uint8(255), np.uint8(0))
        self.any = True
        channels = np.arange(3)
        self.image.reshape(-1, 3)[pixels] = _PAINTED[tint[..., None], channels, ground]


def rectangles_of(
    cells: NDArray[np.int16],
) -> Iterator[tuple[int, list[tuple[int, int, int, int]]]]:
    """What each painter painted, as few rectangles: its number in `cells`, and (row, column, rows,
    columns) of each."""
    for owner in np.unique(cells[cells > 0]).tolist():
        marks = np.diff(np.pad(cells == owner, ((0, 0), (1, 1))).astype(np.int8), axis=1)
        (starts, lefts), (_, rights) = np.nonzero(marks == 1), np.nonzero(marks == -1)
        growing: dict[tuple[int, int], tuple[int, int]] = {}  # the run's ends: first, last row
        found: list[tuple[int, int, int, int]] = []

        def done(run: tuple[int, int], rows: tuple[int, int]) -> None:
            found.append((rows[0], run[0], rows[1] - rows[0] + 1, run[1] - run[0]))  # noqa: B023

        for row, left, right in zip(starts.tolist(), lefts.tolist(), rights.tolist(), strict=True):
            run = left, right
            before = growing.get(run)
            if before is not None and before[1] == row - 1:
                growing[run] = before[0], row
                continue
            if before is not None:
                done(run, before)
            growing[run] = row, row
        for run, rows in growing.items():
            done(run, rows)
        yield owner, found


def _cells_under(positions: NDArray[np.floating], resolution: float, cells: int) -> Index:
    """The cell of every pixel along one axis, -1 outside of the floor."""
    index = np.floor(positions / resolution).astype(np.intp)
    return np.where((index >= 0) & (index < cells), index, -1)


def _runs(cell_of: Index, cells: int) -> tuple[Index, Index]:
    """First and last pixel of every cell along one axis.

    A cell that is cut off by the frame's edge, so that it has no pixel, gets its neighbour's.
    """
    pixels = np.flatnonzero(cell_of >= 0)
    first = np.full(cells, len(cell_of) - 1, np.intp)
    last = np.zeros(cells, np.intp)
    np.minimum.at(first, cell_of[pixels], pixels)
    np.maximum.at(last, cell_of[pixels], pixels)
    return np.minimum(first, last), last
