"""Polygons of a scene: their order, whether they are convex, and the circles around them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from sensors.grid import Floats

Outline = tuple[Floats, bool, tuple[float, float, float]]
"""Corners (k, 2) counter-clockwise, whether they are convex, and a circle about them."""


def outline_of(vertices: Floats) -> Outline:
    """A polygon's corners (k, 2) counter-clockwise, whether it is convex, and its bounding circle.

    Raises:
        ValueError: it has fewer than three vertices, is not finite or without an area.
    """
    corners, _ = polygon_of(vertices)
    edges = np.roll(corners, -1, axis=0) - corners
    after = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0]
    # All turns to the left, and once round in all: a star turns left too, but twice round.
    angles = np.arctan2(turns, np.sum(edges * after, axis=1))
    convex = bool((turns >= 0.0).all() and abs(angles.sum() - 2.0 * np.pi) < 1.0)
    centre = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    radius = float(np.hypot(*(corners - centre).T).max()) * (1.0 + 1e-12)
    return corners, convex, (float(centre[0]), float(centre[1]), radius)


def polygon_of(vertices: npt.ArrayLike) -> tuple[Floats, bool]:
    """The vertices (k, 2) of a polygon counter-clockwise, and whether they were clockwise.

    Raises:
        ValueError: fewer than three, not finite, or without an area.
    """
    corners = np.array(vertices, np.float64)
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3:
        raise ValueError(f"a polygon needs (k, 2) vertices with k >= 3, not {corners.shape}")
    own = corners - corners[:1]
    before = np.roll(own, 1, axis=0)
    area = float(np.sum(before[:, 0] * own[:, 1] - before[:, 1] * own[:, 0]))
    if not np.isfinite(corners).all() or area == 0.0:
        raise ValueError(f"a polygon needs finite vertices and an area: {corners.tolist()}")
    return (corners[::-1].copy() if area < 0.0 else corners), area < 0.0
