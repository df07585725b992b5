"""How far apart two shapes are, or how deep they overlap: plane geometry of a judge's own.

An outline is a convex polygon's corners (p, 2) in the body's frame, counter-clockwise, or the
radius of a circle. Metres and radians. Nothing of the simulator's geometry is used.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Outline = Floats | float


def outline_of(body: Any) -> Outline:
    """The outline of a body or obstacle of a world file: box, circle or polygon."""
    if body.shape == "circle":
        return float(body.radius)
    if body.shape == "box":
        x, y = body.size[0] / 2, body.size[1] / 2
        return np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    return np.array(body.points, float)


def radius_of(outline: Outline) -> float:
    """How far an outline reaches from its origin."""
    return outline if isinstance(outline, float) else float(np.hypot(*outline.T).max())


def placed(corners: Floats, poses: Floats) -> Floats:
    """Corners (p, 2) of bodies at poses (k, 3), in the world: (k, p, 2)."""
    cos, sin = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
    x, y = corners[:, 0], corners[:, 1]
    return np.stack(
        [poses[:, 0, None] + cos * x - sin * y, poses[:, 1, None] + sin * x + cos * y], axis=2
    )


def separation(one: Outline, poses: Floats, other: Outline, other_poses: Floats) -> Floats:
    """(k,) how far apart the outlines are at poses (k, 3) each; negative: how deep they overlap."""
    if isinstance(one, float):
        if isinstance(other, float):
            gaps: Floats = np.hypot(*(poses[:, :2] - other_poses[:, :2]).T)
            return gaps - one - other
        return _to_point(placed(other, other_poses), poses[:, :2]) - one
    if isinstance(other, float):
        return _to_point(placed(one, poses), other_poses[:, :2]) - other
    return _polygons(placed(one, poses), placed(other, other_poses))


def within(outline: Outline, poses: Floats, arena: Floats) -> Floats:
    """(k,) how far bodies at poses (k, 3) are from the walls of a convex arena (m, 2) around them.

    The arena's corners are counter-clockwise. Negative: how deep a body is in a wall.
    """
    edges = np.roll(arena, -1, axis=0) - arena
    inward = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, None]
    offsets = np.sum(inward * arena, axis=1)
    if isinstance(outline, float):
        found: Floats = (poses[:, :2] @ inward.T - offsets).min(axis=1) - outline
        return found
    return np.asarray((placed(outline, poses) @ inward.T - offsets).min(axis=(1, 2)))


def inside(corners: Floats, points: Floats) -> NDArray[np.bool_]:
    """(k,) whether points (k, 2) lie in the convex polygon (p, 2), or on its edge."""
    edges = np.roll(corners, -1, axis=0) - corners
    toward = points[:, None] - corners
    across = edges[:, 0] * toward[..., 1] - edges[:, 1] * toward[..., 0]
    return np.asarray((across >= 0.0).all(axis=1))


def _to_point(corners: Floats, points: Floats) -> Floats:
    """(k,) from polygons (k, p, 2) to points (k, 2); negative within them."""
    edges = np.roll(corners, -1, axis=1) - corners
    toward = points[:, None] - corners
    lengths = np.hypot(edges[..., 0], edges[..., 1])
    depth = (edges[..., 1] * toward[..., 0] - edges[..., 0] * toward[..., 1]) / lengths
    along = np.clip((toward * edges).sum(axis=2) / lengths**2, 0.0, 1.0)
    off = toward - along[..., None] * edges
    outside = np.hypot(off[..., 0], off[..., 1]).min(axis=1)
    deepest = depth.max(axis=1)
    return np.asarray(np.where(deepest > 0.0, outside, deepest))


def _polygons(one: Floats, other: Floats) -> Floats:
    """(k,) between polygons (k, p, 2) and (k, q, 2): the axes that could part them decide."""
    found = np.maximum(_parted(one, other), _parted(other, one))
    (apart,) = np.nonzero(found > 0.0)
    if len(apart):
        found[apart] = np.minimum(
            _corners_to_edges(one[apart], other[apart]), _corners_to_edges(other[apart], one[apart])
        )
    return found


def _parted(one: Floats, other: Floats) -> Floats:
    """(k,) the widest gap that an edge of `one` leaves between the two; negative: none does."""
    edges = np.roll(one, -1, axis=1) - one
    outward = np.stack([edges[..., 1], -edges[..., 0]], axis=2)
    outward /= np.hypot(edges[..., 0], edges[..., 1])[..., None]
    offsets = (outward * one).sum(axis=2)
    reach = np.einsum("kpd,kqd->kpq", outward, other).min(axis=2)
    return np.asarray((reach - offsets).max(axis=1))


def _corners_to_edges(one: Floats, other: Floats) -> Floats:
    """(k,) the least distance from a corner of `one` to an edge of `other`."""
    start = other[:, None]
    edges = (np.roll(other, -1, axis=1) - other)[:, None]
    toward = one[:, :, None] - start
    along = np.clip((toward * edges).sum(axis=3) / (edges**2).sum(axis=3), 0.0, 1.0)
    off = toward - along[..., None] * edges
    return np.asarray(np.hypot(off[..., 0], off[..., 1]).min(axis=(1, 2)))
