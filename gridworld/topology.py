"""Floods over a grid: distances, parts that are not reached, holes."""

from collections.abc import Sequence
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from gridworld.compiled import compiled

FAR = -1
"""Distance of a cell that cannot be reached, and of a wall."""


def _flood(
    open_cells: NDArray[np.bool_],
    starts: NDArray[np.int32],
    offsets: NDArray[np.int32],
    distance: NDArray[np.int32],
    queue: NDArray[np.int32],
) -> int:
    """Breadth-first search over a flat, framed grid. Returns the number of cells reached.

    `open_cells` is false on the frame; `distance` is FAR everywhere and is filled in; `queue` has
    room for every cell and holds those reached, in order.
    """
    tail = 0
    for start in starts:
        if open_cells[start] and distance[start] == FAR:
            distance[start] = 0
            queue[tail] = start
            tail += 1
    head = 0
    while head < tail:
        cell = queue[head]
        head += 1
        for offset in offsets:
            neighbour = cell + offset
            if open_cells[neighbour] and distance[neighbour] == FAR:
                distance[neighbour] = distance[cell] + 1
                queue[tail] = neighbour
                tail += 1
    return tail


_i4 = numba.types.Array(numba.int32, 1, "C")
_flood_compiled: Any = compiled(
    numba.int64(numba.types.Array(numba.boolean, 1, "C"), _i4, _i4, _i4, _i4), _flood
)


def framed(cells: NDArray[np.bool_], frame: int = 1) -> NDArray[np.bool_]:
    """`cells` with `frame` rows and columns of False around it."""
    rows, columns = cells.shape
    grid = np.zeros((rows + 2 * frame, columns + 2 * frame), np.bool_)
    grid[frame : rows + frame, frame : columns + frame] = cells
    return grid


def offsets_around(width: int) -> NDArray[np.int32]:
    """Flat offsets in a grid of `width` columns: up, right, down, left, then the diagonals
    up-right, right-down, down-left, left-up."""
    around = [-width, 1, width, -1, -width + 1, width + 1, width - 1, -width - 1]
    return np.array(around, np.int32)


def distances(free: NDArray[np.bool_], doors: Sequence[tuple[int, int]]) -> NDArray[np.int32]:
    """Steps from the nearest of `doors` (column, row) to every cell, as (rows, columns).

    FAR where there is no way, and in walls.
    """
    grid = framed(free)
    width = grid.shape[1]
    starts = np.array([(row + 1) * width + column + 1 for column, row in doors], np.int32)
    distance = np.full(grid.size, FAR, np.int32)
    queue = np.empty(grid.size, np.int32)
    _flood_compiled(grid.ravel(), starts, offsets_around(width)[:4], distance, queue)
    return np.ascontiguousarray(distance.reshape(grid.shape)[1:-1, 1:-1])


def first_unreached(
    free: NDArray[np.bool_], start: tuple[int, int] | None = None
) -> tuple[tuple[int, int] | None, int]:
    """The first free cell, in reading order, that cannot be reached from `start`, or None.

    `start` is the first free cell unless given. Also returns the number of cells reached.
    """
    if start is None:
        row, column = divmod(int(np.argmax(free)), free.shape[1])
        start = (column, row)
    unreached = free & (distances(free, [start]) == FAR)
    reached = int(np.count_nonzero(free) - np.count_nonzero(unreached))
    if not unreached.any():
        return None, reached
    row, column = divmod(int(np.argmax(unreached)), free.shape[1])
    return (column, row), reached


def first_hole(free: NDArray[np.bool_]) -> tuple[tuple[int, int] | None, int]:
    """The first wall cell, in reading order, of a hole of a region, and the hole's size.

    (None, 0) if there is no hole: every wall is connected to the outside by sides or corners.
    """
    walls = framed(~framed(free))
    width = walls.shape[1]
    offsets = offsets_around(width)
    distance = np.full(walls.size, FAR, np.int32)
    queue = np.empty(walls.size, np.int32)
    flat = walls.ravel()
    _flood_compiled(flat, np.array([width + 1], np.int32), offsets, distance, queue)
    inside = flat & (distance == FAR)
    if not inside.any():
        return None, 0
    first = int(np.argmax(inside))
    size = _flood_compiled(flat, np.array([first], np.int32), offsets, distance, queue)
    row, column = divmod(first, width)
    return (column - 2, row - 2), int(size)
