"""Where the region's walls are in the robot's own frame, from the laser's points on red.

The robot knows the region's shape beforehand, but not where in it it stands, nor which way round:
its own axes may be turned by 180 degrees. Points that lie on the walls tell: in a convex region a
point is on the boundary exactly where its least distance from the edges' lines is zero.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from ..geometry import Floats, Region

ON_WALL = 0.05
"""A point this near to the boundary is on it (m): the laser's noise, 5 times 0.01 m."""

OUTSIDE = 0.01
"""Nothing is seen through a wall: no more than this share of the points may be outside."""

APART = 0.2
"""Two points on a wall, this far apart along it and as far from other walls (m), show that it is
there: the last point of a wall in view may as well be in a corner."""

_PROBES = 16  # points tried as contacts of an edge, in pairs, besides those farthest out
_JUDGES = 48  # points that judge a candidate
_PARALLEL = 0.1  # the sine of the angle up to which walls count as parallel


@dataclass(frozen=True)
class Fit:
    """The region in the own frame, the share of points on its walls, their rms distance."""

    region: Region
    share: float
    rms: float


def locate(points: Floats, shape: Region) -> Fit | None:
    """The region in the own frame, from wall points (n, 2) of that frame; None if not certain yet.

    `shape` is the known polygon in any frame with parallel axes. The robot stands at the
    origin. Certain means that nine in ten points fit, that hardly any is outside, that two walls
    that are not parallel were hit at two places each, and that the other orientation does not fit
    nearly as well.
    """
    if len(points) < _PROBES:
        return None
    fits = [fit for turned in (shape, shape.turned()) if (fit := _best(points, turned)) is not None]
    fits.sort(key=lambda fit: (-fit.share, fit.rms))
    if not fits or fits[0].share < 0.9:
        return None
    if (
        len(fits) > 1
        and fits[1].share > fits[0].share - 0.03
        and fits[1].rms < fits[0].rms + 0.01
        and not _same(fits[0].region, fits[1].region)
    ):
        return None
    return fits[0]


def _same(one: Region, other: Region) -> bool:
    gaps = np.hypot(*(one.corners[:, None, :] - other.corners[None, :, :]).transpose(2, 0, 1))
    return bool((gaps.min(axis=1) < 0.1).all())


def _best(points: Floats, shape: Region) -> Fit | None:
    normals, offsets = shape.normals, shape.offsets
    probes = points[np.linspace(0, len(points) - 1, _PROBES).astype(int)]
    judges = points[np.linspace(0, len(points) - 1, min(_JUDGES, len(points))).astype(int)]
    # Of an edge that was hit at all the points farthest out are on it.
    reach = np.vstack([(points @ normals.T).min(axis=0), probes @ normals.T])  # (probes, edges)
    candidates = []
    for a in range(len(offsets)):
        for b in range(a + 1, len(offsets)):
            pair = normals[[a, b]]
            if abs(_cross(*pair)) < _PARALLEL:
                continue
            first = np.repeat(reach[:, a] - offsets[a], len(reach))
            second = np.tile(reach[:, b] - offsets[b], len(reach))
            candidates.append(np.stack([first, second]).T @ np.linalg.inv(pair).T)
    if not candidates:
        return None
    shifts = np.concatenate(candidates)
    limits = offsets[None, :] + shifts @ normals.T  # (candidates, edges)
    limits_ok = (limits < 0.0).all(axis=1)  # the robot is inside
    if not limits_ok.any():
        return None
    shifts, limits = shifts[limits_ok], limits[limits_ok]
    depths = (judges @ normals.T)[None, :, :] - limits[:, None, :]
    least = depths.min(axis=2)
    counts = (np.abs(least) < ON_WALL).sum(axis=1) - len(judges) * (least < -ON_WALL).sum(axis=1)
    shift = _refined(points, shape, shifts[int(np.argmax(counts))])
    if shift is None:
        return None
    region = shape.moved(shift)
    if not _is_fixed(points, region):
        return None
    depth = region.depth(points)
    distance = np.abs(depth)
    near = distance < ON_WALL
    if not near.any() or (depth < -ON_WALL).mean() > OUTSIDE:
        return None
    return Fit(region, float(near.mean()), float(np.sqrt(np.mean(distance[near] ** 2))))


def _refined(points: Floats, shape: Region, shift: Floats) -> Floats | None:
    """The shift that fits best near a given one; None where the walls hit leave it open."""
    normals, offsets = shape.normals, shape.offsets
    for _ in range(3):
        depths = (points - shift) @ normals.T - offsets
        edge = np.argmin(depths, axis=1)
        depth = depths[np.arange(len(points)), edge]
        near = np.abs(depth) < ON_WALL
        hit = normals[edge[near]]
        weights = hit.T @ hit
        if near.sum() < 4 or np.linalg.eigvalsh(weights)[0] < 2.0:
            return None
        shift = shift + np.linalg.solve(weights, hit.T @ depth[near])
    return shift


def _is_fixed(points: Floats, region: Region) -> bool:
    """Whether two walls that are not parallel were hit, each beyond doubt: at two places, APART."""
    depths = points @ region.normals.T - region.offsets
    near = np.abs(depths) < APART
    hit = []
    for edge, normal in enumerate(region.normals):
        on_it = (np.abs(depths[:, edge]) < ON_WALL) & (near.sum(axis=1) == 1)
        along = points[on_it] @ np.array([-normal[1], normal[0]])
        if along.size and np.ptp(along) > APART:
            hit.append(normal)
    return any(abs(_cross(a, b)) >= _PARALLEL for a, b in itertools.combinations(hit, 2))


def _cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def drift(points: Floats, region: Region, about: tuple[float, float]) -> tuple[Floats, float]:
    """How far odometry is off: a shift (2,) in m and a turn about a point in radians.

    What has to be added to the pose so that wall points (n, 2), placed by it, lie on the region's
    boundary. Zero where fewer than 20 points or no two walls were hit.
    """
    normals, offsets = region.normals, region.offsets
    depths = points @ normals.T - offsets
    edge = np.argmin(depths, axis=1)
    depth = depths[np.arange(len(points)), edge]
    near = np.abs(depth) < 2.0 * ON_WALL
    hit = normals[edge[near]]
    arms = points[near] - about
    rows = np.column_stack([hit, hit[:, 1] * arms[:, 0] - hit[:, 0] * arms[:, 1]])
    weights = rows.T @ rows
    if near.sum() < 20 or np.linalg.eigvalsh(weights[:2, :2])[0] < 2.0:
        return np.zeros(2), 0.0
    dx, dy, turn = np.linalg.solve(weights, -rows.T @ depth[near])
    return np.array([dx, dy]), float(turn)
