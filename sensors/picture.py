"""Draws edges, circles and polygons into a one-dimensional picture: the nearest thing per ray.

The picture of a sensor is a row of `depth`, which holds 1/range, and of `hits`. Several fans that
look from one place in one direction are drawn at once, one behind the other. It is in the sensor's
frame: x ahead, y to the left. 1/range is linear in a ray's direction along a straight
edge: with the edge a + s e and the ray t d, 1/t = (d x e) / (a x e), so that a ray costs two
multiplications and no division.
"""

import math

import numpy as np
import numpy.typing as npt

from sensors.compiled import compiled, inlined
from sensors.grid import Floats, Ints

Hits = npt.NDArray[np.int32]

ON = 1e-9  # metres: a sensor this near to an edge stands on it
EDGE_ON = 1e-12  # metres: a line this near to the sensor is seen end on and covers no ray
SLACK = 1e-12  # radians by which an edge's run is widened, so that no ray slips between two edges


Parts = tuple[Ints, Floats, Ints]
"""The fans that are drawn at once, of one field of view, one behind the other in the picture.

ends (f + 1,): where each begins in the picture's row. scales (f, 3): its rays per radian, the
bearing of its first ray to the right, and the rays by which a run is widened. live (f,): 0 for a
fan in which nothing nearer can come any more."""


def parts_of(fov: float, samples: tuple[int, ...]) -> tuple[Ints, Floats]:
    """`ends` and `scales` of fans of `fov` radians with so many samples each."""
    scales = np.empty((len(samples), 3))
    for part, count in enumerate(samples):
        per_radian = (count - 1) / fov if count > 1 else 1.0
        scales[part, 0] = per_radian
        scales[part, 1] = 0.5 * fov if count > 1 else 0.0  # a single ray looks ahead
        scales[part, 2] = SLACK * per_radian + 1e-15 * count
    return np.cumsum((0, *samples)), scales


ROUGH = 2e-5
"""Radians by which a rough bearing may be off: twice what its polynomial may be."""


@inlined
def rough_bearing(y: float, x: float) -> float:
    """atan2(y, x) but for ROUGH: Abramowitz and Stegun's polynomial, 4.4.49."""
    across, along = abs(y), abs(x)
    slope = min(across, along) / max(across, along)
    s = slope * slope
    angle = slope * (
        0.9998660 + s * (-0.3302995 + s * (0.1801410 + s * (-0.0851330 + s * 0.0208351)))
    )
    if across > along:
        angle = 0.5 * math.pi - angle
    if x < 0.0:
        angle = math.pi - angle
    return -angle if y < 0.0 else angle


@inlined
def _run(
    low: float, width: float, scale: Floats, samples: int, turn: int, off: float
) -> tuple[int, int, bool]:
    """The rays of a fan in a run of bearings, turned round; last < first where there are none.

    off: the radians by which `low` and `low + width` may be off. Besides whether the rays are not
    known for sure, because of that.
    """
    per_radian, slack = scale[0], scale[2]
    first = (low + turn * 2.0 * math.pi + scale[1]) * per_radian
    last = first + width * per_radian
    margin = off * per_radian + slack
    if last < -margin or first > samples - 1 + margin:
        return 0, -1, False
    begin, end = math.ceil(first - margin), math.floor(last + margin)
    sure = off == 0.0 or (
        begin == math.ceil(first + (margin - 2.0 * slack))
        and end == math.floor(last - (margin - 2.0 * slack))
    )
    return max(begin, 0), min(end, samples - 1), not sure


@inlined
def _cover_line(
    depth: Floats,
    hits: Hits,
    fan: Floats,
    parts: Parts,
    entity: int,
    area: float,
    ex: float,
    ey: float,
    bearing_a: float,
    bearing_b: float,
    off: float,
) -> bool:
    """Draw one edge by bearings that may be `off` radians wrong; whether they did not suffice."""
    ends, scales, live = parts
    if area > 0.0:
        low, width = bearing_a, bearing_b - bearing_a
    else:
        low, width = bearing_b, bearing_a - bearing_b
    if off > 0.0 and not (abs(width) > 4.0 * off):  # which way round is not sure
        return True
    if width < 0.0:
        width += 2.0 * math.pi
    if width > math.pi + 1.0:  # two ends in one direction, and rounding turned their order round
        return False
    across, along = ey / area, -ex / area
    for part in range(live.shape[0]):
        if live[part] == 0:
            continue
        offset = ends[part]
        for turn in range(-1, 2):  # the picture's ends meet at fov 360: an edge may lie at both
            begin, end, unsure = _run(low, width, scales[part], ends[part + 1] - offset, turn, off)
            if unsure:
                return True
            for i in range(offset + begin, offset + end + 1):
                w = across * fan[0, i] + along * fan[1, i]
                nearer = w > depth[i]
                depth[i] = w if nearer else depth[i]
                hits[i] = entity if nearer else hits[i]
    return False


@inlined
def cover_line(
    depth: Floats,
    hits: Hits,
    fan: Floats,
    parts: Parts,
    entity: int,
    area: float,
    ax: float,
    ay: float,
    ex: float,
    ey: float,
    bearing_a: float,
    bearing_b: float,
) -> None:
    """Draw the edge from a to a + e into the picture: `area` is a x e, the bearings are rough.

    Which rays it covers is told by rough bearings of its ends, where these tell it for sure: that
    costs a third of what exact ones do.
    """
    if _cover_line(depth, hits, fan, parts, entity, area, ex, ey, bearing_a, bearing_b, ROUGH):
        exact_a, exact_b = math.atan2(ay, ax), math.atan2(ay + ey, ax + ex)
        _cover_line(depth, hits, fan, parts, entity, area, ex, ey, exact_a, exact_b, 0.0)


@inlined
def _cover_circle(
    depth: Floats,
    hits: Hits,
    fan: Floats,
    parts: Parts,
    entity: int,
    x: float,
    y: float,
    radius: float,
    power: float,
    bearing: float,
    spread: float,
    off: float,
) -> bool:
    """Draw a circle by angles that may be `off` radians wrong; whether they did not suffice."""
    ends, scales, live = parts
    for part in range(live.shape[0]):
        if live[part] == 0:
            continue
        offset = ends[part]
        for turn in range(-1, 2):
            begin, end, unsure = _run(
                bearing - spread, 2.0 * spread, scales[part], ends[part + 1] - offset, turn, off
            )
            if unsure:
                return True
            for i in range(offset + begin, offset + end + 1):
                aside = abs(x * fan[1, i] - y * fan[0, i])
                half = math.sqrt(max((radius - aside) * (radius + aside), 0.0))
                w = (x * fan[0, i] + y * fan[1, i] + half) / power
                if w > depth[i]:
                    depth[i] = w
                    hits[i] = entity
    return False


@inlined
def cover_circle(
    depth: Floats,
    hits: Hits,
    fan: Floats,
    parts: Parts,
    entity: int,
    x: float,
    y: float,
    radius: float,
    hollow: bool,
) -> bool:
    """Draw a circle about (x, y) into the picture. True if the sensor lies in or on a solid one."""
    distance = math.hypot(x, y)
    if distance - radius <= ON:
        if hollow:
            _cover_around(depth, hits, fan, parts, entity, x, y, radius)
        return not hollow
    power = (distance - radius) * (distance + radius)
    bearing, spread = rough_bearing(y, x), rough_bearing(radius, math.sqrt(power))
    if _cover_circle(
        depth, hits, fan, parts, entity, x, y, radius, power, bearing, spread, 2.0 * ROUGH
    ):
        bearing, spread = math.atan2(y, x), math.asin(radius / distance)
        _cover_circle(depth, hits, fan, parts, entity, x, y, radius, power, bearing, spread, 0.0)
    return False


@compiled
def _cover_around(
    depth: Floats,
    hits: Hits,
    fan: Floats,
    parts: Parts,
    entity: int,
    x: float,
    y: float,
    radius: float,
) -> None:
    """Draw a circle about (x, y) that the sensor is within: every ray meets it from there."""
    ends, _, live = parts
    for part in range(live.shape[0]):
        if live[part] == 0:
            continue
        for i in range(ends[part], ends[part + 1]):
            aside = abs(x * fan[1, i] - y * fan[0, i])
            half = math.sqrt(max((radius - aside) * (radius + aside), 0.0))
            far = x * fan[0, i] + y * fan[1, i] + half
            if far > ON and 1.0 / far > depth[i]:
                depth[i] = 1.0 / far
                hits[i] = entity


@inlined
def stands_on(ax: float, ay: float, ex: float, ey: float, area: float) -> bool:
    """Whether the origin lies within ON of the edge from a to a + e; `area` is a x e."""
    square = ex * ex + ey * ey
    if area * area > ON * ON * square:
        return ax * ax + ay * ay <= ON * ON
    along = -(ax * ex + ay * ey)
    slack = ON * math.sqrt(square)
    return -slack <= along <= square + slack


@inlined
def outside_view(x: float, y: float, side_x: float, side_y: float, reach: float) -> bool:
    """Whether a circle lies outside of the view's left or right side (views up to 180 degrees)."""
    return side_x * y - side_y * x > reach or -side_x * y - side_y * x > reach


@inlined
def draw_polygon(
    depth: Floats,
    hits: Hits,
    fan: Floats,
    parts: Parts,
    entity: int,
    vertices: Floats,
    convex: bool,
    hollow: bool,
    outside: bool,
    ox: float,
    oy: float,
    cos: float,
    sin: float,
    scratch: Floats,
) -> bool:
    """Draw a polygon's edges into the picture. True if the sensor lies in it or on one.

    Of a hollow one all edges are drawn but those on which the sensor stands. outside: whether the
    sensor is known to be neither within it nor on an edge.
    """
    count = vertices.shape[0]
    far = outside
    for k in range(count):
        n = k + 1 if k + 1 < count else 0
        x, y = vertices[k, 0] - ox, vertices[k, 1] - oy
        dx, dy = vertices[n, 0] - vertices[k, 0], vertices[n, 1] - vertices[k, 1]
        ax, ay = cos * x + sin * y, cos * y - sin * x
        ex, ey = cos * dx + sin * dy, cos * dy - sin * dx
        area = ax * ey - ay * ex
        if not far and stands_on(ax, ay, ex, ey, area):
            if not hollow:
                return True
            area = 0.0
        if area < 0.0:
            outside = True
        scratch[k, 0], scratch[k, 1], scratch[k, 2], scratch[k, 3] = ax, ay, ex, ey
        scratch[k, 4], scratch[k, 5] = area, 9.0  # 9: bearing not known yet
    if convex and not outside:
        return True
    if not (convex or hollow or far):
        winding = 0
        for k in range(count):
            n = k + 1 if k + 1 < count else 0
            if scratch[k, 1] <= 0.0 < scratch[n, 1] and scratch[k, 4] > 0.0:
                winding += 1
            elif scratch[n, 1] <= 0.0 < scratch[k, 1] and scratch[k, 4] < 0.0:
                winding -= 1
        if winding != 0:
            return True
    for k in range(count):
        n = k + 1 if k + 1 < count else 0
        area, ex, ey = scratch[k, 4], scratch[k, 2], scratch[k, 3]
        if convex and area > 0.0:  # the far sides
            continue
        if area * area <= EDGE_ON * EDGE_ON * (ex * ex + ey * ey):
            continue
        ax, ay = scratch[k, 0], scratch[k, 1]
        if scratch[k, 5] == 9.0:
            scratch[k, 5] = rough_bearing(ay, ax)
        if scratch[n, 5] == 9.0:
            scratch[n, 5] = rough_bearing(scratch[n, 1], scratch[n, 0])
        a, b = scratch[k, 5], scratch[n, 5]
        cover_line(depth, hits, fan, parts, entity, area, ax, ay, ex, ey, a, b)
    return False
