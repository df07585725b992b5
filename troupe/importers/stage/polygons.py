"""Plane geometry for bodies: areas, bounds, convex hulls."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

Point = tuple[float, float]
Polygon = list[Point]


def cross(o: Point, a: Point, b: Point) -> float:
    """Twice the signed area of the triangle o, a, b; positive if it turns left."""
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def area(polygon: Sequence[Point]) -> float:
    """The signed area; positive if the corners go counter-clockwise."""
    return 0.5 * sum(
        x1 * y2 - x2 * y1
        for (x1, y1), (x2, y2) in zip(polygon, [*polygon[1:], polygon[0]], strict=True)
    )


def bounds(points: Iterable[Point]) -> tuple[float, float, float, float]:
    """Least x and y, greatest x and y."""
    xs, ys = zip(*points, strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def hull(points: Iterable[Point]) -> Polygon:
    """The convex hull, counter-clockwise, without corners on a line (Andrew's monotone chain)."""
    ordered = sorted(set(points))
    if len(ordered) < 3:
        return ordered
    reach = math.dist(bounds(ordered)[:2], bounds(ordered)[2:])
    flat = 1e-12 * reach * reach  # rounding of a product of two lengths
    halves: list[Polygon] = []
    for row in (ordered, ordered[::-1]):
        half: Polygon = []
        for point in row:
            while len(half) > 1 and cross(half[-2], half[-1], point) <= flat:
                half.pop()
            half.append(point)
        halves.append(half[:-1])
    return halves[0] + halves[1]


def cleaned(polygon: Sequence[Point]) -> Polygon:
    """The polygon counter-clockwise, without corners that repeat or lie on a line."""
    corners = list(polygon) if area(polygon) >= 0 else list(polygon)[::-1]
    reach = max(math.dist(corners[0], corner) for corner in corners)
    changed = True
    while changed and len(corners) >= 3:
        changed = False
        for i, corner in enumerate(corners):
            before, after = corners[i - 1], corners[(i + 1) % len(corners)]
            if abs(cross(before, corner, after)) <= 1e-9 * reach * reach:
                del corners[i]
                changed = True
                break
    return corners


def is_convex(polygon: Sequence[Point]) -> bool:
    """Whether a cleaned polygon is its own hull."""
    return abs(area(hull(polygon)) - area(polygon)) <= 1e-9 * max(area(polygon), 1e-300)
