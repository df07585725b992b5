"""Uniform grids over what can be seen: the bodies' is built each tick, the walls' once.

A grid is described by `frame`, six floats: x0, y0, cell size, columns, rows, margin. `start` holds
for each cell (row by row) where its items begin in `items`, so that cell c holds
items[start[c]:start[c + 1]]. Bodies lie in the cell of their centre alone and reach at most
`margin` beyond it; larger ones lie in one more cell behind the last, which everybody looks at.
Walls lie in every cell that they touch, and their margin is 0.
"""

import math

import numpy as np
import numpy.typing as npt

from sensors.compiled import compiled, inlined

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]
Bodies = tuple[Floats, Ints, Floats, Floats, Ints, Ints]
"""bounds (S, 3), shapes (S, 4), vertices (V, 2) as in `place_bodies`; frame, start, items."""
Walls = tuple[Floats, Ints, Flags, Floats, Ints, Ints]
"""walls (M, 4) ax, ay, ex, ey from a to a + e; their entities (M,); whether they are sheets without
an inside (M,); frame, start, items."""

HOLLOW = 2
"""In place of convex (1) or not (0): a shape without an inside, which is seen from within too."""


@compiled
def place_bodies(
    poses: Floats,
    hidden: Flags,
    shapes: Ints,
    bounds_local: Floats,
    vertices_local: Floats,
    bounds: Floats,
    vertices: Floats,
    start: Ints,
    items: Ints,
    cells: Ints,
    frame: Floats,
) -> int:
    """Move every shape to its entity's pose and sort the shapes into a grid.

    Args:
        poses: (E, 3) x, y, heading of the entities.
        hidden: (E,) entities that nobody sees.
        shapes: (S, 4) entity, first vertex, number of vertices (0: a circle), convex (1), not (0),
            or HOLLOW.
        bounds_local, bounds: (S, 3) centre and radius of each shape's bounding circle, in the
            entity's frame and (written) in the world's.
        vertices_local, vertices: (V, 2) likewise.
        start, items, cells, frame: the grid, written; `cells` (S,) is scratch.

    Returns:
        -1, or the first entity whose pose is not finite: then nothing else is valid.
    """
    count = 0
    mean = 0.0
    low_x = low_y = math.inf
    high_x = high_y = -math.inf
    for s in range(shapes.shape[0]):
        entity = shapes[s, 0]
        x, y, heading = poses[entity, 0], poses[entity, 1], poses[entity, 2]
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(heading)):
            return int(entity)
        cos, sin = math.cos(heading), math.sin(heading)
        cx = x + cos * bounds_local[s, 0] - sin * bounds_local[s, 1]
        cy = y + sin * bounds_local[s, 0] + cos * bounds_local[s, 1]
        bounds[s, 0], bounds[s, 1], bounds[s, 2] = cx, cy, bounds_local[s, 2]
        for v in range(shapes[s, 1], shapes[s, 1] + shapes[s, 2]):
            px, py = vertices_local[v, 0], vertices_local[v, 1]
            vertices[v, 0] = x + cos * px - sin * py
            vertices[v, 1] = y + sin * px + cos * py
        if not hidden[entity]:
            count += 1
            mean += bounds[s, 2]
            low_x, high_x = min(low_x, cx), max(high_x, cx)
            low_y, high_y = min(low_y, cy), max(high_y, cy)
    start[:] = 0
    frame[:] = 0.0
    frame[2] = 1.0
    if count == 0:
        return -1
    # About one body a cell, but no cell smaller than a usual body.
    width, height = high_x - low_x, high_y - low_y
    size = max(math.sqrt(width * height / count), 2.0 * mean / count, 1e-6)
    capacity = start.shape[0] - 2
    while (math.floor(width / size) + 1.0) * (math.floor(height / size) + 1.0) > capacity:
        size *= 1.5
    columns, rows = int(width / size) + 1, int(height / size) + 1
    margin = 0.0
    for s in range(shapes.shape[0]):
        if hidden[shapes[s, 0]]:
            cells[s] = -1
            continue
        if bounds[s, 2] > size:
            cells[s] = columns * rows
        else:
            margin = max(margin, bounds[s, 2])
            column = min(int((bounds[s, 0] - low_x) / size), columns - 1)
            row = min(int((bounds[s, 1] - low_y) / size), rows - 1)
            cells[s] = row * columns + column
        start[cells[s] + 1] += 1
    for c in range(columns * rows + 1):
        start[c + 1] += start[c]
    for s in range(shapes.shape[0] - 1, -1, -1):  # backwards: keeps the shapes' order in a cell
        if cells[s] >= 0:
            start[cells[s] + 1] -= 1
            items[start[cells[s] + 1]] = s
    # Now start[c + 1] is where cell c begins: shift it back by one.
    for c in range(columns * rows + 1):
        start[c] = start[c + 1]
    start[columns * rows + 1] = count
    frame[0], frame[1], frame[2], frame[3], frame[4] = low_x, low_y, size, columns, rows
    frame[5] = margin
    return -1


@inlined
def touches(x: float, y: float, half: float, wall: Floats) -> bool:
    """Whether a wall (ax, ay, ex, ey) touches the square about (x, y), rounding included."""
    ax, ay, ex, ey = wall[0] - x, wall[1] - y, wall[2], wall[3]
    reach = half * (1.0 + 1e-9) + 1e-9
    if min(ax, ax + ex) > reach or max(ax, ax + ex) < -reach:
        return False
    if min(ay, ay + ey) > reach or max(ay, ay + ey) < -reach:
        return False
    return bool(abs(ax * ey - ay * ex) <= reach * (abs(ex) + abs(ey)))


@compiled
def sort_walls(walls: Floats, frame: Floats, start: Ints, items: Ints) -> int:
    """Put the walls (M, 4: ax, ay, ex, ey) into every cell that they touch.

    With `items` of length 0 only counts: returns the number of items and leaves `start`
    (cells + 1) with the running total; a second call with that many items writes them.
    """
    x0, y0, size = frame[0], frame[1], frame[2]
    columns, rows = int(frame[3]), int(frame[4])
    start[:] = 0
    total = 0
    for filling in range(2 if items.shape[0] > 0 else 1):
        for w in range(walls.shape[0]):
            ax, ay = walls[w, 0], walls[w, 1]
            bx, by = ax + walls[w, 2], ay + walls[w, 3]
            first_column = max(int((min(ax, bx) - x0) / size) - 1, 0)
            last_column = min(int((max(ax, bx) - x0) / size) + 1, columns - 1)
            first_row = max(int((min(ay, by) - y0) / size) - 1, 0)
            last_row = min(int((max(ay, by) - y0) / size) + 1, rows - 1)
            for row in range(first_row, last_row + 1):
                for column in range(first_column, last_column + 1):
                    x, y = x0 + (column + 0.5) * size, y0 + (row + 0.5) * size
                    if not touches(x, y, 0.5 * size, walls[w]):
                        continue
                    cell = row * columns + column
                    if filling == 1:
                        items[start[cell]] = w
                        start[cell] += 1
                    else:
                        start[cell + 1] += 1
                        total += 1
        if filling == 0:
            for cell in range(columns * rows):
                start[cell + 1] += start[cell]
        else:
            for cell in range(columns * rows, 0, -1):
                start[cell] = start[cell - 1]
            start[0] = 0
    return total


@inlined
def locate(frame: Floats, x: float, y: float) -> tuple[int, int, int, int, float]:
    """Where a point lies in a grid.

    Returns:
        Its column and row, which may lie outside; the first and last ring of cells about them that
        have a cell in the grid (last < first in an empty grid); and `inset`: whatever is in no
        cell of the rings 0 to k, is at least k * cell + inset - margin away.
    """
    size, columns, rows = frame[2], int(frame[3]), int(frame[4])
    column, row = math.floor((x - frame[0]) / size), math.floor((y - frame[1]) / size)
    inset_x, inset_y = x - frame[0] - column * size, y - frame[1] - row * size
    inset = min(inset_x, size - inset_x, inset_y, size - inset_y) - 1e-9 * size
    first = max(0, -column, column - columns + 1, -row, row - rows + 1)
    last = max(abs(column), abs(columns - 1 - column), abs(row), abs(rows - 1 - row))
    return column, row, first, last if columns > 0 else -1, inset


@inlined
def most_spans(frame: Floats) -> int:
    """The spans that a ring has at the most: see `ring_spans`."""
    return 2 * int(frame[4]) + 2


@inlined
def ring_spans(frame: Floats, start: Ints, column: int, row: int, ring: int, spans: Ints) -> int:
    """Write which items lie in the cells of a ring about (column, row); return how many spans.

    spans (k, 2): from the first of some items to behind their last. Cells of a row that lie side by
    side make one span, as their items do; those without items make none.
    """
    columns, rows = int(frame[3]), int(frame[4])
    left, right = column - ring, column + ring
    count = 0
    for r in range(max(row - ring, 0), min(row + ring, rows - 1) + 1):
        whole = r in (row - ring, row + ring)
        for side in range(1 if whole else 2):
            first = left if side == 0 else right
            last = right if whole else first
            first, last = max(first, 0), min(last, columns - 1)
            if first <= last:
                begin, end = start[r * columns + first], start[r * columns + last + 1]
                if begin < end:
                    spans[count, 0], spans[count, 1] = begin, end
                    count += 1
    return count


def frame_over(points: Floats, count: int) -> Floats:
    """The frame of a grid over points (k, 2) that `count` things are made of; empty for none."""
    frame = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    if count > 0:
        low = points.min(axis=0) - 1e-6
        width, height = points.max(axis=0) + 1e-6 - low
        # About two things a cell; long ones lie in many cells, so not finer than 2**16 cells.
        cells = min(max(count // 2, 16), 1 << 16)
        size = max(math.sqrt(width * height / cells), max(width, height) / cells)
        frame[:5] = low[0], low[1], size, int(width / size) + 1, int(height / size) + 1
    return frame


def wall_grid(walls: Floats) -> tuple[Floats, Ints, Ints]:
    """The walls' (M, 4: ax, ay, ex, ey) grid: (frame, start, items)."""
    frame = frame_over(np.concatenate([walls[:, :2], walls[:, :2] + walls[:, 2:]]), len(walls))
    if len(walls) == 0:
        return frame, np.zeros(2, np.int64), np.zeros(0, np.int64)
    start = np.zeros(int(frame[3]) * int(frame[4]) + 1, np.int64)
    items = np.zeros(sort_walls(walls, frame, start, np.zeros(0, np.int64)), np.int64)
    sort_walls(walls, frame, start, items)
    return frame, start, items
