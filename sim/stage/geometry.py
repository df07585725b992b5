"""Plane geometry of convex shapes: outlines of bodies, containment, distances between them."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pymunk.autogeometry import convex_decomposition, to_convex_hull

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

CIRCLE_SIDES = 48
"""Sides of the polygon that stands for a circle in pictures, placement and coverage; sensors and
physics know the circle itself. It has the circle's area; its outline is nowhere further from the
circle than 0.2 % of the radius (1 - cos(pi / 48))."""


HALF_SIDE = math.cos(math.pi / CIRCLE_SIDES)
"""The inner radius of that polygon over its outer one."""


def rotated(points: ArrayLike, heading: float) -> Floats:
    """Points (k, 2) turned by `heading` radians counter-clockwise about the origin."""
    cosine, sine = math.cos(heading), math.sin(heading)
    flat = np.asarray(points, dtype=np.float64)
    x, y = flat[:, 0], flat[:, 1]
    turned = np.empty_like(flat)
    turned[:, 0] = x * cosine - y * sine
    turned[:, 1] = x * sine + y * cosine
    return turned


def placed(points: ArrayLike, pose: ArrayLike) -> Floats:
    """Points (k, 2) of a body's frame in the world, for a body at pose (x, y, yaw)."""
    x, y, yaw = np.asarray(pose, dtype=np.float64)
    turned = rotated(points, float(yaw))
    turned += (x, y)
    return turned


def carried(start: ArrayLike, pose: ArrayLike) -> tuple[float, float, float]:
    """The pose at which a frame must be placed for what is at `start` in it to be at `pose`."""
    (x, y, yaw), (to_x, to_y, to_yaw) = np.asarray(start, float), np.asarray(pose, float)
    turn = float(to_yaw - yaw)
    cosine, sine = math.cos(turn), math.sin(turn)
    return float(to_x - x * cosine + y * sine), float(to_y - x * sine - y * cosine), turn


def signed_area(vertices: ArrayLike) -> float:
    """Area of a simple polygon (k, 2); positive when its vertices run counter-clockwise."""
    flat = np.asarray(vertices, dtype=np.float64)
    after = np.roll(flat, -1, axis=0)
    return float(np.sum(flat[:, 0] * after[:, 1] - after[:, 0] * flat[:, 1]) / 2)


def is_convex(vertices: ArrayLike) -> bool:
    """Whether vertices (k, 2), k >= 3, run once around a convex polygon of non-zero area.

    Vertices in the middle of a straight edge are allowed, repeated vertices are not.
    """
    flat = np.asarray(vertices, dtype=np.float64)
    if len(flat) < 3:
        return False
    edges = np.roll(flat, -1, axis=0) - flat
    lengths = np.hypot(edges[:, 0], edges[:, 1])
    if np.any(lengths == 0.0):
        return False
    after = np.roll(edges, -1, axis=0)
    turns = np.arctan2(
        edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0], np.sum(edges * after, axis=1)
    )
    # A turn below 1e-9 rad is what rounding makes of a straight edge in doubles.
    once = abs(abs(float(np.sum(turns))) - 2 * math.pi) < 1e-6
    same_side = bool(np.all(turns > -1e-9) or np.all(turns < 1e-9))
    return once and same_side and abs(signed_area(flat)) > 0.0


def counter_clockwise(vertices: ArrayLike) -> Floats:
    """The polygon (k, 2) with its vertices in counter-clockwise order."""
    flat = np.array(vertices, dtype=np.float64)
    return flat if signed_area(flat) >= 0 else flat[::-1].copy()


def box(width: float, depth: float) -> Floats:
    """A box (4, 2) about the origin, `width` along x and `depth` along y, counter-clockwise."""
    x, y = width / 2, depth / 2
    return np.array([[-x, -y], [x, -y], [x, y], [-x, y]])


def rectangle(left: float, bottom: float, right: float, top: float) -> Floats:
    """An upright rectangle (4, 2), counter-clockwise from its lower left corner."""
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]])


def circle_polygon(radius: float, sides: int = CIRCLE_SIDES) -> Floats:
    """A regular polygon (sides, 2) about the origin with the area of a circle."""
    angles = 2 * math.pi * (np.arange(sides) + 0.5) / sides
    corner = radius * math.sqrt(2 * math.pi / sides / math.sin(2 * math.pi / sides))
    return corner * np.stack([np.cos(angles), np.sin(angles)], axis=1)


class Piece(NamedTuple):
    """A part of a body in the body's frame: corners (k, 2), counter-clockwise.

    circle: x, y and radius in metres of what is round; its corners are then those of a polygon of
    the same area.
    """

    vertices: Floats
    circle: tuple[float, float, float] | None = None


@lru_cache(maxsize=4096)
def faces(body: Any) -> tuple[Piece, ...]:
    """The parts of a body of the world file's schema as they are written; some may be concave."""
    if body.shape != "compound":
        circle = (0.0, 0.0, body.radius) if body.shape == "circle" else None
        return (Piece(_outline(body), circle),)
    found = []
    for part in body.parts:
        x, y, degrees = part.pose
        vertices = placed(_outline(part), (x, y, math.radians(degrees)))
        found.append(Piece(vertices, (x, y, part.radius) if part.shape == "circle" else None))
    return tuple(found)


@lru_cache(maxsize=4096)
def pieces(body: Any) -> tuple[Piece, ...]:
    """The convex parts that a body is made of."""
    found: list[Piece] = []
    for face in faces(body):
        if body.shape != "compound" or face.circle is not None or is_convex(face.vertices):
            found.append(face)
        else:
            found += [Piece(vertices) for vertices in convex_pieces(face.vertices)]
    return tuple(found)


def convex_pieces(vertices: Floats) -> list[Floats]:
    """A simple polygon (k, 2), counter-clockwise, cut into convex ones (Chipmunk's algorithm).

    Raises ValueError where they would not have its area: its edges cross.
    """
    ring = [*map(tuple, vertices.tolist()), tuple(vertices[0].tolist())]
    cut = [np.array(piece)[:-1] for piece in convex_decomposition(ring, 0.0)]
    whole, found = signed_area(vertices), [piece for piece in cut if signed_area(piece) > 0.0]
    if abs(sum(map(signed_area, found)) - whole) > 1e-6 * whole:
        raise ValueError("the polygon's edges cross")
    return found


def outline(body: Any) -> Floats:
    """Outline (k, 2) of a body of the world file's schema, in its own frame, counter-clockwise.

    Of a compound body the convex hull.
    """
    return faces(body)[0].vertices if body.shape != "compound" else hull_of(body)


@lru_cache(maxsize=4096)
def hull_of(body: Any) -> Floats:
    """The convex hull (k, 2) of a body's parts."""
    corners: list[Floats] = []
    for face in faces(body):
        if face.circle is None:
            corners.append(face.vertices)
        else:  # a polygon around the circle, so that nothing is left out
            x, y, radius = face.circle
            around = circle_polygon(1.0)
            corners.append(around * (radius / np.hypot(*around[0]) / HALF_SIDE) + (x, y))
    hull = to_convex_hull([(x, y) for x, y in np.concatenate(corners).tolist()], 0.0)
    return counter_clockwise(np.array(hull)[:-1])


def _outline(shape: Any) -> Floats:
    """Outline (k, 2) of a box, circle or polygon of the schema, about its own origin."""
    if shape.shape == "box":
        return box(*shape.size)
    if shape.shape == "circle":
        return circle_polygon(shape.radius)
    return counter_clockwise(shape.points)


def least_width(vertices: Floats) -> float:
    """The width of a convex polygon (k, 2) across the direction in which it is narrowest."""
    edges = np.roll(vertices, -1, axis=0) - vertices
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, None]
    return float(np.ptp(vertices @ normals.T, axis=0).min())


def reach(body: Any) -> float:
    """Radius in metres of the smallest circle about a body's origin that holds the body."""
    return max(
        float(np.hypot(*vertices.T).max())
        if circle is None
        else math.hypot(*circle[:2]) + circle[2]
        for vertices, circle in faces(body)
    )


def girth(body: Any) -> float:
    """Half of a body's width in metres where it is narrowest; of several parts the thinnest's."""
    return min(
        least_width(vertices) / 2.0 if circle is None else circle[2]
        for vertices, circle in pieces(body)
    )


def size_of(body: Any) -> tuple[float, float, float]:
    """Length, width and height in metres of a body of the world file's schema."""
    least, most = extent(body)
    length, width = most - least
    return (float(length), float(width), body.height)


def extent(body: Any, pose: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[Floats, Floats]:
    """The lower left and the upper right corner, (2,) each, of the upright box around a body."""
    if body.shape == "circle":
        middle = np.array(pose[:2])
        return middle - body.radius, middle + body.radius
    corners = placed(outline(body), pose)
    return corners.min(axis=0), corners.max(axis=0)


def in_convex(points: ArrayLike, vertices: Floats) -> Bools:
    """For points (n, 2), whether each lies in the convex polygon or on its edge; (n,) bool.

    Points nearer to an edge than 1e-9 m count as on it: rounding of a cell's centre must not
    decide.
    """
    flat = np.asarray(points, dtype=np.float64)
    inside = np.ones(len(flat), dtype=np.bool_)
    for start, end in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        dx, dy = end - start
        across = dx * (flat[:, 1] - start[1]) - dy * (flat[:, 0] - start[0])
        inside &= across >= -1e-9 * math.hypot(dx, dy)
    return inside


def distance_to_edges(points: ArrayLike, vertices: Floats) -> Floats:
    """Distance (n,) in metres from points (n, 2) to the outline of a polygon (k, 2)."""
    flat = np.asarray(points, dtype=np.float64)
    edges = np.roll(vertices, -1, axis=0) - vertices  # (k, 2)
    away = flat[:, None, :] - vertices[None, :, :]  # (n, k, 2)
    along = np.sum(away * edges, axis=2) / np.maximum(np.sum(edges * edges, axis=1), 1e-300)
    foot = away - np.clip(along, 0.0, 1.0)[:, :, None] * edges
    nearest: Floats = np.sqrt(np.sum(foot * foot, axis=2)).min(axis=1)
    return nearest


def separation(first: Floats, second: Floats) -> float:
    """Distance between two convex counter-clockwise polygons; negative where they overlap.

    Overlapping: minus the smallest shift that parts them (separating axis theorem over the
    edges' normals). Apart: the distance between the nearest points, which for polygons is
    always that of a corner to an edge.
    """
    deepest = -math.inf
    for one, other in ((first, second), (second, first)):
        edges = np.roll(one, -1, axis=0) - one
        lengths = np.maximum(np.hypot(edges[:, 0], edges[:, 1]), 1e-300)
        normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / lengths[:, None]
        gaps = (normals @ other.T).min(axis=1) - np.sum(normals * one, axis=1)
        deepest = max(deepest, float(gaps.max()))
    if deepest <= 0.0:
        return deepest
    return float(
        min(distance_to_edges(first, second).min(), distance_to_edges(second, first).min())
    )


def depth(body: Any, pose: ArrayLike, other: Any, other_pose: ArrayLike) -> float:
    """How deep two bodies of the schema overlap at their poses (x, y, yaw), in metres."""
    there = [placed(vertices, other_pose) for vertices, _ in pieces(other)]
    return max(
        -separation(placed(vertices, pose), piece)
        for vertices, _ in pieces(body)
        for piece in there
    )


def wrapped(angles: ArrayLike) -> Floats:
    """Angles in radians brought into (-pi, pi]."""
    flat = np.asarray(angles, dtype=np.float64)
    turned: Floats = math.pi - np.mod(math.pi - flat, 2 * math.pi)
    return turned
