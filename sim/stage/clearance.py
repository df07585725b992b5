"""How far every place of a world is from what stands there, at least: a coarse distance field."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.stage.compiled import compiled
from sim.stage.geometry import CIRCLE_SIDES, Floats, circle_polygon
from sim.stage.layout import Layout

FINEST = 0.25
"""m; finer cells would cost memory and tell a robot little."""
MOST_CELLS = 1_000_000
FARTHEST = 255


@dataclass(frozen=True)
class Clearance:
    """Lower bounds of the distance to the nearest outline of a solid.

    cells (rows, columns) uint8, row 0 at y = 0: chessboard distance in cells, which is never
    more than the true one. Off the raster nothing is known: the distance is 0 there.
    """

    cells: NDArray[np.uint8]
    cell: float


def clearance_of(layout: Layout) -> Clearance:
    """The distance field of a layout's solids over its size."""
    width, height = layout.size
    cell = max(FINEST, math.sqrt(width * height / MOST_CELLS))
    cells = np.full((math.ceil(height / cell), math.ceil(width / cell)), FARTHEST, dtype=np.uint8)
    for solid in layout.solids:
        outline = solid.vertices
        if solid.circle is not None:
            x, y, radius = solid.circle
            # Sides of a cell at most: such a polygon leaves the circle by a tenth of a cell.
            outline = circle_polygon(radius, max(CIRCLE_SIDES, math.ceil(7 * radius / cell)))
            outline += (x, y)
        _mark(cells, cell, outline)
    _spread(cells)
    return Clearance(cells, cell)


def _mark(cells: NDArray[np.uint8], cell: float, vertices: Floats) -> None:
    """Mark cells along an outline, by points half a cell apart, and those just off the raster."""
    for start, end in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        pieces = math.ceil(2.0 * math.dist(start, end) / cell) + 1
        points = start + np.linspace(0.0, 1.0, pieces + 1)[:, None] * (end - start)
        column, row = np.floor(points.T / cell).astype(np.int64)
        rows, columns = cells.shape
        near = (column >= -1) & (column <= columns) & (row >= -1) & (row <= rows)
        cells[np.clip(row[near], 0, rows - 1), np.clip(column[near], 0, columns - 1)] = 0


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
