"""The cone kernel: how far away the nearest point within a cone is, as a sonar measures it.

The nearest point of an edge within a cone is the foot of the perpendicular, one of the edge's
ends, or where one of the cone's sides crosses the edge; nothing nearer can hide it. A cone whose
tip lies within something solid measures 0.
"""

import math

import numpy as np

from sensors.compiled import compiled
from sensors.grid import HOLLOW, Floats, Ints, locate, most_spans, ring_spans
from sensors.picture import ON, SLACK, stands_on
from sensors.sight import Seen
from sensors.solids import OUTSIDE, side_of, stands_within


@compiled
def _within(x: float, y: float, fov: float, side_x: float, side_y: float) -> bool:
    """Whether (x, y) lies in the cone about the x axis whose left side is (side_x, side_y)."""
    slack = SLACK * math.hypot(x, y)
    right_of_left = side_x * y - side_y * x <= slack
    left_of_right = side_x * y + side_y * x >= -slack
    if fov <= math.pi:
        return right_of_left and left_of_right
    return right_of_left or left_of_right


@compiled
def _edge_distance(
    ax: float,
    ay: float,
    ex: float,
    ey: float,
    fov: float,
    side_x: float,
    side_y: float,
    hollow: bool,
) -> float:
    """How near the edge from a to a + e comes within the cone; infinity if it does not.

    Nor does one of something hollow on which the cone's tip lies.
    """
    area = ax * ey - ay * ex
    if stands_on(ax, ay, ex, ey, area):
        return math.inf if hollow else 0.0
    best = math.inf
    bx, by = ax + ex, ay + ey
    if _within(ax, ay, fov, side_x, side_y):
        best = math.hypot(ax, ay)
    if _within(bx, by, fov, side_x, side_y):
        best = min(best, math.hypot(bx, by))
    square = ex * ex + ey * ey
    along = -(ax * ex + ay * ey)
    if 0.0 < along < square:
        foot = area / square  # the foot of the perpendicular is (ey, -ex) times this
        if _within(ey * foot, -ex * foot, fov, side_x, side_y):
            best = min(best, abs(area) / math.sqrt(square))
    for turn in range(2):
        dx, dy = side_x, side_y if turn == 0 else -side_y
        across = dx * ey - dy * ex
        if across != 0.0:
            distance = area / across
            part = (ax * dy - ay * dx) / across
            if distance >= 0.0 and -SLACK <= part <= 1.0 + SLACK:
                best = min(best, distance)
    return best


@compiled
def _circle_distance(
    x: float, y: float, radius: float, fov: float, side_x: float, side_y: float, hollow: bool
) -> float:
    """How near a circle about (x, y) comes within the cone; infinity if it does not."""
    centre = math.hypot(x, y)
    if centre - radius <= ON:
        return _distance_around(x, y, radius, fov, side_x, side_y) if hollow else 0.0
    if _within(x, y, fov, side_x, side_y):
        return centre - radius
    best = math.inf
    power = (centre - radius) * (centre + radius)
    for turn in range(2):
        dx, dy = side_x, side_y if turn == 0 else -side_y
        toward, aside = x * dx + y * dy, abs(x * dy - y * dx)
        if aside > radius:
            continue
        if toward > 0.0:
            half = math.sqrt((radius - aside) * (radius + aside))
            best = min(best, power / (toward + half))
    return best


@compiled
def _distance_around(
    x: float, y: float, radius: float, fov: float, side_x: float, side_y: float
) -> float:
    """How near a circle about (x, y) comes within a cone whose tip it holds."""
    centre = math.hypot(x, y)
    if centre < radius - ON and (centre <= ON or _within(-x, -y, fov, side_x, side_y)):
        return radius - centre
    best = math.inf
    for turn in range(2):
        dx, dy = side_x, side_y if turn == 0 else -side_y
        aside = abs(x * dy - y * dx)
        far = x * dx + y * dy + math.sqrt(max((radius - aside) * (radius + aside), 0.0))
        if far > ON:
            best = min(best, far)
    return best


@compiled
def cast_cones(
    seen: Seen,
    origins: Floats,
    own: Ints,
    fov: float,
    max_range: float,
    ranges: Floats,
) -> None:
    """Write into `ranges` (n,) how far the nearest point in each cone is, at most `max_range`.

    Args:
        seen: `Scene.seen`.
        origins: (n, 3) x, y, heading of the cones' axes.
        own: (n,) the entity that each sensor does not see, or -1.
        fov: the cones' width in radians, sides included, at most 2 pi.
    """
    bodies, walls, solids = seen
    bounds, shapes, vertices, body_frame, body_start, body_items = bodies
    segments, owners, sheets, wall_frame, wall_start, wall_items = walls
    spans = np.empty((max(most_spans(body_frame), most_spans(wall_frame)), 2), np.int64)
    side_x, side_y = math.cos(0.5 * fov), math.sin(0.5 * fov)
    for j in range(origins.shape[0]):
        ox, oy = origins[j, 0], origins[j, 1]
        cos, sin = math.cos(origins[j, 2]), math.sin(origins[j, 2])
        if stands_within(solids, own[j], ox, oy) >= 0:
            ranges[j] = 0.0
            continue
        best = max_range

        column, row, first, last, inset = locate(wall_frame, ox, oy)
        for ring in range(first, last + 1):
            if ring > 0 and (ring - 1) * wall_frame[2] + inset > best:
                break
            for n in range(ring_spans(wall_frame, wall_start, column, row, ring, spans)):
                for k in range(spans[n, 0], spans[n, 1]):
                    wall = wall_items[k]
                    if owners[wall] == own[j]:
                        continue
                    x, y = segments[wall, 0] - ox, segments[wall, 1] - oy
                    dx, dy = segments[wall, 2], segments[wall, 3]
                    ax, ay = cos * x + sin * y, cos * y - sin * x
                    ex, ey = cos * dx + sin * dy, cos * dy - sin * dx
                    thin = sheets[wall]
                    best = min(best, _edge_distance(ax, ay, ex, ey, fov, side_x, side_y, thin))

        column, row, first, last, inset = locate(body_frame, ox, oy)
        for ring in range(first - 1, last + 1):
            if ring == first - 1:  # the cell behind the last: the bodies larger than a cell
                behind = int(body_frame[3]) * int(body_frame[4])
                spans[0, 0], spans[0, 1] = body_start[behind], body_start[behind + 1]
                count = 1
            else:
                if ring > 0 and (ring - 1) * body_frame[2] + inset - body_frame[5] > best:
                    break
                count = ring_spans(body_frame, body_start, column, row, ring, spans)
            for n in range(count):
                for k in range(spans[n, 0], spans[n, 1]):
                    s = body_items[k]
                    if shapes[s, 0] == own[j]:
                        continue
                    x, y, radius = bounds[s, 0] - ox, bounds[s, 1] - oy, bounds[s, 2]
                    if x * x + y * y > (best + radius + ON) * (best + radius + ON):
                        continue
                    hollow = shapes[s, 3] == HOLLOW
                    if shapes[s, 2] == 0:
                        ax, ay = cos * x + sin * y, cos * y - sin * x
                        best = min(
                            best, _circle_distance(ax, ay, radius, fov, side_x, side_y, hollow)
                        )
                        continue
                    begin, end = shapes[s, 1], shapes[s, 1] + shapes[s, 2]
                    reach = radius + ON
                    if (not hollow and x * x + y * y <= reach * reach) and (
                        side_of(vertices, begin, end, ox, oy) != OUTSIDE
                    ):
                        best = 0.0
                        break
                    for v in range(begin, end):
                        w = v + 1 if v + 1 < end else begin
                        x, y = vertices[v, 0] - ox, vertices[v, 1] - oy
                        dx, dy = vertices[w, 0] - vertices[v, 0], vertices[w, 1] - vertices[v, 1]
                        ax, ay = cos * x + sin * y, cos * y - sin * x
                        ex, ey = cos * dx + sin * dy, cos * dy - sin * dx
                        best = min(
                            best, _edge_distance(ax, ay, ex, ey, fov, side_x, side_y, hollow)
                        )
        ranges[j] = best
