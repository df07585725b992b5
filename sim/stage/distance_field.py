"""How far every place of a world is from what stands there, at least: a coarse distance field."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sim.stage.compiled import compiled, inlined
from sim.stage.geometry import CIRCLE_SIDES, Floats, circle_polygon

if TYPE_CHECKING:
    from sim.stage.layout import Layout

FINEST = 0.25
"""m; finer cells would cost memory and tell a robot little."""
MOST_CELLS = 1_000_000
FARTHEST = 255


@dataclass(frozen=True)
class DistanceField:
    """Lower bounds of the distance to the nearest outline of a solid.

    cells (rows, columns) uint8, row 0 lowest: chessboard distance in cells, which is never
    more than the true one. Off the raster nothing is known: the distance is 0 there.
    frame: metres of a cell, and x, y of the raster's lower left corner.
    """

    cells: NDArray[np.uint8]
    frame: tuple[float, float, float]


def distance_field(layout: Layout) -> DistanceField:
    """The distance field of a layout's solids over its size."""
    width, height = layout.size
    cell = max(FINEST, math.sqrt(width * height / MOST_CELLS), max(width, height) / MOST_CELLS)
    cells = np.full((math.ceil(height / cell), math.ceil(width / cell)), FARTHEST, dtype=np.uint8)
    for solid in layout.solids:
        if not solid.levels:
            continue
        outline = solid.vertices
        if solid.circle is not None:
            x, y, radius = solid.circle
            # Sides of a cell at most: such a polygon leaves the circle by a tenth of a cell.
            outline = circle_polygon(radius, max(CIRCLE_SIDES, math.ceil(7 * radius / cell)))
            outline += (x, y)
        _mark(cells, cell, outline - layout.low)
    _spread(cells)
    return DistanceField(cells, (cell, *layout.low))


def nearer(field: DistanceField, outlines: Iterable[Floats]) -> DistanceField:
    """The field where more stands, of which the upright boxes of the outlines (k, 2) are known."""
    cell, *low = field.frame
    cells = field.cells.copy()
    rows, columns = (np.arange(count) for count in cells.shape)
    for vertices in outlines:
        first = np.floor((vertices.min(axis=0) - low) / cell)
        last = np.floor((vertices.max(axis=0) - low) / cell)
        across = np.maximum(first[0] - columns, columns - last[0])
        up = np.maximum(first[1] - rows, rows - last[1])
        apart = np.maximum(across, up[:, None])
        np.minimum(cells, np.clip(apart, 0, FARTHEST).astype(np.uint8), out=cells)
    return DistanceField(cells, field.frame)


@inlined
def clear_of(cells: Any, frame: Any, x: float, y: float) -> float:
    """A lower bound of the distance in metres from a place to what stands."""
    cell = frame[0]
    row, column = math.floor((y - frame[2]) / cell), math.floor((x - frame[1]) / cell)
    if 0 <= row < cells.shape[0] and 0 <= column < cells.shape[1]:
        # Two cells less: the place and the outline may be anywhere in their cells.
        return float(max(0.0, (cells[row, column] - 2.0) * cell))
    return 0.0


def _mark(cells: NDArray[np.uint8], cell: float, vertices: Floats) -> None:
    """Mark cells along an outline, by points half a cell apart, and those just off the raster."""
    rows, columns = cells.shape
    low, high = np.full(2, -cell), np.array([columns + 1, rows + 1]) * cell
    for start, end in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        pieces = math.ceil(2.0 * math.dist(start, end) / cell) + 1
        first, last = _within(start, end, low, high)
        if first > last:
            continue
        # Only what is on the raster: a wall may be as long as it likes.
        steps = np.arange(max(0, int(first * pieces) - 1), min(pieces, int(last * pieces) + 2) + 1)
        points = start + (steps * (1.0 / pieces))[:, None] * (end - start)
        if steps[-1] == pieces:
            points[-1] = start + (end - start)
        column, row = np.floor(points.T / cell).astype(np.int64)
        near = (column >= -1) & (column <= columns) & (row >= -1) & (row <= rows)
        cells[np.clip(row[near], 0, rows - 1), np.clip(column[near], 0, columns - 1)] = 0


def _within(start: Floats, end: Floats, low: Floats, high: Floats) -> tuple[float, float]:
    """The part of a segment that is in an upright box, from 0 at its start to 1 at its end.

    The slab method: per axis the parts at which the box is entered and left. The first is more
    than the last where the segment misses the box.
    """
    first, last = 0.0, 1.0
    for here, there, least, most in zip(start, end, low, high, strict=True):
        if here == there:
            if not least <= here <= most:
                return 1.0, 0.0
            continue
        one, other = (least - here) / (there - here), (most - here) / (there - here)
        first, last = max(first, min(one, other)), min(last, max(one, other))
    return float(first), float(last)


@compiled
def _spread(cells: Any) -> None:
    """Chessboard distance transform in two passes (Rosenfeld and Pfaltz 1966)."""
    rows, columns = cells.shape
    for r in range(rows):
        for c in range(columns):
            best = int(cells[r, c])
            if c > 0:
                best = min(best, cells[r, c - 1] + 1)
            if r > 0:
                for k in range(max(0, c - 1), min(columns, c + 2)):
                    best = min(best, cells[r - 1, k] + 1)
            cells[r, c] = best
    for r in range(rows - 1, -1, -1):
        for c in range(columns - 1, -1, -1):
            best = int(cells[r, c])
            if c < columns - 1:
                best = min(best, cells[r, c + 1] + 1)
            if r < rows - 1:
                for k in range(max(0, c - 1), min(columns, c + 2)):
                    best = min(best, cells[r + 1, k] + 1)
            cells[r, c] = best
