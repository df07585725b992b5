"""Plane geometry for bodies: convex hulls, and polygons cut into convex pieces."""

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


def convex_pieces(polygon: Sequence[Point]) -> list[Polygon]:
    """A simple polygon as convex polygons that fill it: itself, or triangles (ear clipping).

    Empty for one without area; the hull for one whose edges cross.
    """
    corners = cleaned(polygon)
    if len(corners) < 3 or area(corners) <= 0.0:
        return []
    if is_convex(corners):
        return [corners]
    whole, pieces = area(corners), []
    rest = list(corners)
    while len(rest) > 3:
        ear = next((i for i in range(len(rest)) if _is_ear(rest, i)), None)
        if ear is None:
            return [hull(corners)]
        pieces.append([rest[ear - 1], rest[ear], rest[(ear + 1) % len(rest)]])
        del rest[ear]
    pieces.append(rest)
    pieces = [piece for piece in pieces if area(piece) > 1e-12 * whole]
    if abs(sum(map(area, pieces)) - whole) > 1e-9 * whole:
        return [hull(corners)]
    return pieces


def _is_ear(corners: Sequence[Point], i: int) -> bool:
    a, b, c = corners[i - 1], corners[i], corners[(i + 1) % len(corners)]
    if cross(a, b, c) <= 0.0:
        return False
    return not any(
        cross(a, b, p) >= 0.0 and cross(b, c, p) >= 0.0 and cross(c, a, p) >= 0.0
        for p in corners
        if p not in (a, b, c)
    )
