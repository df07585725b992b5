"""What lies within walls: solid pieces, sorted into a grid once.

A wall that is seen is a segment, without an inside. What is solid behind it is told by pieces:
polygons, each of an entity, that are never seen themselves. A piece may be hollow: then all is
solid but what lies within it, as round an arena. A piece lies in every cell in which something of
it is solid. The cell behind the last is all that is off the grid: there hollow ones are solid.
"""

import math

import numpy as np

from sensors.compiled import compiled, inlined
from sensors.grid import Floats, Ints, frame_over, touches
from sensors.picture import stands_on

Solids = tuple[Floats, Ints, Floats, Ints, Ints]
"""corners (V, 2); pieces (P, 4) entity, first corner, number of corners, hollow (1) or not; frame,
start, items of their grid."""

FINE = 2000
"""Cells are as small as for so many more pieces: most of an arena's are then free of its wall."""
OUTSIDE, WITHIN, ON_EDGE = 0, 1, 2


@inlined
def side_of(corners: Floats, begin: int, end: int, x: float, y: float) -> int:
    """Where (x, y) lies to the polygon corners[begin:end]: OUTSIDE, WITHIN or ON_EDGE.

    By the winding number, so that the polygon need not be convex. On an edge is within ON of it.
    """
    winding = 0
    ax, ay = corners[end - 1, 0] - x, corners[end - 1, 1] - y
    for k in range(begin, end):
        bx, by = corners[k, 0] - x, corners[k, 1] - y
        area = ax * by - ay * bx
        if stands_on(ax, ay, bx - ax, by - ay, area):
            return ON_EDGE
        if ay <= 0.0 < by and area > 0.0:
            winding += 1
        elif by <= 0.0 < ay and area < 0.0:
            winding -= 1
        ax, ay = bx, by
    return WITHIN if winding != 0 else OUTSIDE


@inlined
def stands_within(solids: Solids, own: int, x: float, y: float) -> int:
    """The entity in whose walls (x, y) lies, or on whose edge; -1 if in none but those of `own`."""
    corners, pieces, frame, start, items = solids
    columns, rows = int(frame[3]), int(frame[4])
    column, row = math.floor((x - frame[0]) / frame[2]), math.floor((y - frame[1]) / frame[2])
    cell = columns * rows
    if 0 <= column < columns and 0 <= row < rows:
        cell = row * columns + column
    for k in range(start[cell], start[cell + 1]):
        piece = items[k]
        if pieces[piece, 0] == own:
            continue
        begin, end = pieces[piece, 1], pieces[piece, 1] + pieces[piece, 2]
        side = side_of(corners, begin, end, x, y)
        if side == ON_EDGE or (side == WITHIN) != (pieces[piece, 3] == 1):
            return int(pieces[piece, 0])
    return -1


@compiled
def _cells_of(corners: Floats, pieces: Ints, frame: Floats, found: Ints) -> int:
    """Write into `found` (m, 2) the pairs of a cell and a piece that is solid somewhere in it.

    As many as there is room for. Returns how many there are.
    """
    x0, y0, size = frame[0], frame[1], frame[2]
    columns, rows = int(frame[3]), int(frame[4])
    edge = np.empty(4)
    count = 0
    for piece in range(pieces.shape[0]):
        begin, end = pieces[piece, 1], pieces[piece, 1] + pieces[piece, 2]
        hollow = pieces[piece, 3] == 1
        first_column, last_column, first_row, last_row = 0, columns - 1, 0, rows - 1
        if hollow:
            if count < found.shape[0]:
                found[count, 0], found[count, 1] = columns * rows, piece
            count += 1
        else:
            xs, ys = corners[begin:end, 0], corners[begin:end, 1]
            first_column = max(int((xs.min() - x0) / size) - 1, 0)
            last_column = min(int((xs.max() - x0) / size) + 1, columns - 1)
            first_row = max(int((ys.min() - y0) / size) - 1, 0)
            last_row = min(int((ys.max() - y0) / size) + 1, rows - 1)
        for row in range(first_row, last_row + 1):
            for column in range(first_column, last_column + 1):
                x, y = x0 + (column + 0.5) * size, y0 + (row + 0.5) * size
                solid = (side_of(corners, begin, end, x, y) != OUTSIDE) != hollow
                for k in range(begin, end):
                    n = k + 1 if k + 1 < end else begin
                    edge[0], edge[1] = corners[k, 0], corners[k, 1]
                    edge[2], edge[3] = corners[n, 0] - edge[0], corners[n, 1] - edge[1]
                    solid = solid or touches(x, y, 0.5 * size, edge)
                if solid:
                    if count < found.shape[0]:
                        found[count, 0], found[count, 1] = row * columns + column, piece
                    count += 1
    return count


def sort_solids(corners: Floats, pieces: Ints) -> Solids:
    """The pieces (P, 4) with their corners (V, 2) and their grid."""
    frame = frame_over(corners, FINE + len(pieces) if len(pieces) else 0)
    found = np.empty((0, 2), np.int64)
    while (count := _cells_of(corners, pieces, frame, found)) > len(found):
        found = np.empty((count, 2), np.int64)
    order = np.argsort(found[:, 0], kind="stable")
    cells = int(frame[3]) * int(frame[4]) + 1
    start = np.zeros(cells + 1, np.int64)
    np.cumsum(np.bincount(found[:, 0], minlength=cells), out=start[1:])
    return corners, pieces, frame, start, np.ascontiguousarray(found[order, 1])
