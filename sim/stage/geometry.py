"""Plane geometry of convex shapes: outlines of bodies, containment, distances between them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

CIRCLE_SIDES = 48
"""Sides of the polygon that stands for a circle in pictures, placement and coverage; sensors and
physics know the circle itself. It has the circle's area; its outline is nowhere further from the
circle than 0.2 % of the radius (1 - cos(pi / 48))."""


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


def outline(body: Any) -> Floats:
    """Outline (k, 2) of a body of the world file's schema, in its own frame, counter-clockwise."""
    if body.shape == "box":
        return box(*body.size)
    if body.shape == "circle":
        return circle_polygon(body.radius)
    return counter_clockwise(body.points)


def least_width(vertices: Floats) -> float:
    """The width of a convex polygon (k, 2) across the direction in which it is narrowest."""
    edges = np.roll(vertices, -1, axis=0) - vertices
    normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, None]
    return float(np.ptp(vertices @ normals.T, axis=0).min())


def reach(body: Any) -> float:
    """Radius in metres of the smallest circle about a body's origin that holds the body."""
    if body.shape == "circle":
        return float(body.radius)
    return float(np.hypot(*outline(body).T).max())


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


def wrapped(angles: ArrayLike) -> Floats:
    """Angles in radians brought into (-pi, pi]."""
    flat = np.asarray(angles, dtype=np.float64)
    turned: Floats = math.pi - np.mod(math.pi - flat, 2 * math.pi)
    return turned
