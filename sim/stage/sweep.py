"""Which cells of the floor a sprayer's rectangle comes over while its robot moves and turns.

In the robot's frame the rectangle stands, and a cell's centre moves. A way is cut so finely that
this motion is a straight line but for a thousandth of a cell, and a line and a rectangle meet or
do not: however small the corner, no centre is missed, at any speed, and a straight way is one cut.
"""

from __future__ import annotations

import math
from typing import Any

from sim.stage.compiled import compiled

EDGE = 1e-9
"""Metres: a cell whose centre lies on a sprayer's edge, but for rounding, is painted."""
BEND = 1e-3
"""Share of a cell by which a centre may leave the straight line within a cut."""
MOST_TURN = 0.25
"""rad in a cut, so that the cells that it can come to are near the rectangle."""
MOST_CUTS = 1 << 12
"""Of an even piece of a way: some hundred turns in it."""


@compiled
def sweep(
    owner: Any,
    visited: Any,
    counts: Any,
    resolution: float,
    robots: Any,
    before: Any,
    ways: Any,
    sizes: Any,
    offsets: Any,
) -> tuple[int, int]:
    """Paint under sprayers (k,) on the ways (k, m, 3) of their robots.

    owner, visited, counts (rows, columns): the floor's cells, of which those that count are
    painted. before (k, 3): the pose after the tick before, not a number if the sprayer was off.
    sizes, offsets (k, 2): the rectangles in the robots' frames. Returns newly painted cells, and
    visits: how often a cell came under a sprayer under which it was not before.
    """
    painted, visits = 0, 0
    for k in range(len(robots)):
        mark, way = robots[k] + 1, ways[k]
        box = (
            offsets[k, 0],
            offsets[k, 1],
            sizes[k, 0] / 2.0 + EDGE,
            sizes[k, 1] / 2.0 + EDGE,
        )
        fresh, came = _stamp(owner, visited, counts, resolution, mark, way[0], before[k], box)
        painted += fresh
        visits += came
        reach = math.hypot(abs(box[0]) + box[2], abs(box[1]) + box[3])
        last = len(way) - 1
        stride = max(1, last) if _even(way, reach, BEND * resolution) else 1
        for i in range(0, last, stride):
            start, end = way[i], way[i + stride]
            cuts = _cuts(start, end, reach, box, BEND * resolution)
            for cut in range(cuts):
                fresh, came = _cut(
                    owner, visited, counts, resolution, mark,
                    _between(start, end, cut / cuts), _between(start, end, (cut + 1) / cuts),
                    reach, box,
                )  # fmt: skip
                painted += fresh
                visits += came
    return painted, visits


@compiled
def _between(start: Any, end: Any, part: float) -> tuple[float, float, float]:
    """The pose at a part of the way from one to another, exactly `start` at 0 and `end` at 1."""
    rest = 1.0 - part
    return (
        rest * start[0] + part * end[0],
        rest * start[1] + part * end[1],
        rest * start[2] + part * end[2],
    )


@compiled
def _length(start: Any, end: Any, reach: float) -> float:
    """Metres that no point within `reach` of the robot's origin exceeds on an even way."""
    return float(math.hypot(end[0] - start[0], end[1] - start[1]) + abs(end[2] - start[2]) * reach)


@compiled
def _even(way: Any, reach: float, tolerance: float) -> bool:
    """Whether all poses of a way lie on the even motion from its first to its last."""
    total = 0.0
    for i in range(1, len(way)):
        total += _length(way[i - 1], way[i], reach)
    gone = 0.0
    for i in range(1, len(way) - 1):
        gone += _length(way[i - 1], way[i], reach)
        if total > 0.0:
            expected = _between(way[0], way[-1], gone / total)
            if _length(expected, way[i], reach) > tolerance:
                return False
    return True


@compiled
def _cuts(start: Any, end: Any, reach: float, box: Any, tolerance: float) -> int:
    """Into how many cuts an even way must go; 0 where nothing moves.

    Within a cut of length d and turn t a point at r from the origin leaves the straight line, in
    the robot's frame, by (t t r + 2 t d) / 8 at most. For speed alone a cut is no longer than half
    of the rectangle.
    """
    way = math.hypot(end[0] - start[0], end[1] - start[1])
    turn = abs(end[2] - start[2])
    if way == 0.0 and turn == 0.0:
        return 0
    bent = math.sqrt((turn * turn * reach + 2.0 * turn * way) / (8.0 * tolerance))
    long = (way + turn * reach) / max(box[2], box[3])
    cuts: int = math.ceil(min(float(MOST_CUTS), max(1.0, bent, long, turn / MOST_TURN)))
    return cuts


@compiled
def _span(y: float, pose: Any, box: Any, margin: float) -> tuple[float, float]:
    """From where to where, along x, the height `y` lies in the rectangle, widened by a margin.

    pose: cos, sin, x, y of the robot. The margin is added to every side. A span that is empty
    ends before it begins.
    """
    cos, sin, x0, y0 = pose
    far = math.hypot(abs(box[0]) + box[2] + margin, abs(box[1]) + box[3] + margin)
    low, high = -far, far
    dy = y - y0
    for axis in range(2):
        # Along the robot's axis a point is at slope * dx + base.
        slope, base = (cos, sin * dy) if axis == 0 else (-sin, cos * dy)
        near, end = box[axis] - box[2 + axis] - margin, box[axis] + box[2 + axis] + margin
        if abs(slope) < 1e-12:
            if base < near or base > end:
                return 1.0, 0.0
            continue
        a, b = (near - base) / slope, (end - base) / slope
        low, high = max(low, min(a, b)), min(high, max(a, b))
    return x0 + low, x0 + high


@compiled
def _heights(pose: Any, box: Any) -> tuple[float, float]:
    """Where the rectangle begins and ends along y; pose: cos, sin, x, y of the robot."""
    cos, sin, _, y = pose
    middle, up = y + sin * box[0] + cos * box[1], abs(sin) * box[2] + abs(cos) * box[3]
    return middle - up, middle + up


@compiled
def _inside(pose: Any, box: Any, x: float, y: float) -> tuple[float, float, bool]:
    """A point in the rectangle's frame, and whether it lies in it; pose: cos, sin, x, y."""
    cos, sin, x0, y0 = pose
    along = cos * (x - x0) + sin * (y - y0) - box[0]
    across = cos * (y - y0) - sin * (x - x0) - box[1]
    return along, across, abs(along) <= box[2] and abs(across) <= box[3]


@compiled
def _stamp(
    owner: Any,
    visited: Any,
    counts: Any,
    resolution: float,
    mark: int,
    pose: Any,
    last: Any,
    box: Any,
) -> tuple[int, int]:
    """Paint what lies under a sprayer; what did not lie under it at the pose `last` is a visit.

    A sprayer that stands still keeps what is under it: the last painter owns a cell.
    """
    now = math.cos(pose[2]), math.sin(pose[2]), pose[0], pose[1]
    then = math.cos(last[2]), math.sin(last[2]), last[0], last[1]
    was_off = math.isnan(last[0])
    moved = was_off or pose[0] != last[0] or pose[1] != last[1] or pose[2] != last[2]
    rows, columns = owner.shape
    bottom, top = _heights(now, box)
    first_row = max(0, math.floor(bottom / resolution))
    last_row = min(rows - 1, math.floor(top / resolution))
    painted, visits = 0, 0
    for row in range(first_row, last_row + 1):
        y = (row + 0.5) * resolution
        low, high = _span(y, now, box, 0.0)
        if low > high:
            continue
        first = max(0, math.ceil(low / resolution - 0.5))
        final = min(columns - 1, math.floor(high / resolution - 0.5))
        for column in range(first, final + 1):
            if not counts[row, column]:
                continue
            if owner[row, column] == 0:
                painted += 1
            owner[row, column] = mark
            if moved:
                x = (column + 0.5) * resolution
                if was_off or not _inside(then, box, x, y)[2]:
                    visits += 1
                    if visited[row, column] < 65535:
                        visited[row, column] += 1
    return painted, visits


@compiled
def _cut(
    owner: Any,
    visited: Any,
    counts: Any,
    resolution: float,
    mark: int,
    start: Any,
    end: Any,
    reach: float,
    box: Any,
) -> tuple[int, int]:
    """Paint what a sprayer comes over from one pose to a near one.

    Only cells around the rectangle at `start` are looked at: what is inside has been painted.
    """
    now = math.cos(start[2]), math.sin(start[2]), start[0], start[1]
    then = math.cos(end[2]), math.sin(end[2]), end[0], end[1]
    way = math.hypot(end[0] - start[0], end[1] - start[1])
    turn = min(MOST_TURN, abs(end[2] - start[2]))
    margin = (way + turn * reach) / (1.0 - MOST_TURN) + EDGE
    rows, columns = owner.shape
    bottom, top = _heights(now, box)
    bottom2, top2 = _heights(then, box)
    bow = turn * margin  # of a corner, beyond where it begins and ends
    first_row = max(0, math.floor((min(bottom, bottom2) - bow) / resolution))
    last_row = min(rows - 1, math.floor((max(top, top2) + bow) / resolution))
    painted, visits = 0, 0
    for row in range(first_row, last_row + 1):
        y = (row + 0.5) * resolution
        low, high = _span(y, now, box, margin)
        if low > high:
            continue
        inner, outer = _span(y, now, box, 0.0)
        first = max(0, math.ceil(low / resolution - 0.5))
        final = min(columns - 1, math.floor(high / resolution - 0.5))
        # A cell more on either side: whether those are inside is asked of themselves.
        skip, skipped = final + 1, final
        if inner <= outer:
            skip = math.ceil(inner / resolution - 0.5) + 1
            skipped = math.floor(outer / resolution - 0.5) - 1
        column = first - 1
        while column < final:
            column += 1
            if skip <= column <= skipped:
                column = skipped
                continue
            if not counts[row, column]:
                continue
            x = (column + 0.5) * resolution
            ax, ay, was_inside = _inside(now, box, x, y)
            if was_inside:
                continue
            bx, by, is_inside = _inside(then, box, x, y)
            if not is_inside and not _meets(ax, ay, bx, by, box[2], box[3]):
                continue
            if owner[row, column] == 0:
                painted += 1
            owner[row, column] = mark
            visits += 1
            if visited[row, column] < 65535:
                visited[row, column] += 1
    return painted, visits


@compiled
def _meets(ax: float, ay: float, bx: float, by: float, half_x: float, half_y: float) -> bool:
    """Whether the line from a to b meets the rectangle about the origin: nothing parts them."""
    if min(ax, bx) > half_x or max(ax, bx) < -half_x:
        return False
    if min(ay, by) > half_y or max(ay, by) < -half_y:
        return False
    dx, dy = bx - ax, by - ay
    return abs(ax * dy - ay * dx) <= half_x * abs(dy) + half_y * abs(dx)
