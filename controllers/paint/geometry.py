"""Plane geometry for Paint: poses, convex regions, their chords and depths."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


ROUNDING = 1e-9
"""A height that misses the region by less (m) is on its border: it was added up from others."""


class Pose(NamedTuple):
    """Position in metres and heading in radians, in the robot's own start frame."""

    x: float
    y: float
    yaw: float


class Region:
    """A convex polygon: `corners` (k, 2) in metres, counter-clockwise, and its edges.

    `normals` (k, 2) are unit inward normals and `offsets` (k,) theirs: inside is where
    normals @ p >= offsets.

    Raises:
        ValueError: the corners are fewer than three, or do not go round a convex polygon.
    """

    def __init__(self, corners: Floats) -> None:
        if len(corners) < 3:
            raise ValueError(f"a region needs at least 3 corners, not {len(corners)}")
        edges = np.roll(corners, -1, axis=0) - corners
        after = np.roll(edges, -1, axis=0)
        turns = edges[:, 0] * after[:, 1] - edges[:, 1] * after[:, 0]
        if (turns < 0.0).all():
            corners = corners[::-1]
            edges = np.roll(corners, -1, axis=0) - corners
        elif not (turns > 0.0).all():
            raise ValueError(f"the corners must go round a convex polygon: {corners.tolist()}")
        headings = np.unwrap(np.arctan2(edges[:, 1], edges[:, 0]))
        if headings[-1] - headings[0] > math.tau:
            raise ValueError(f"the corners go round more than once: {corners.tolist()}")
        self.corners: Floats = np.ascontiguousarray(corners)
        lengths = np.hypot(edges[:, 0], edges[:, 1])
        self.normals: Floats = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / lengths[:, None]
        self.offsets: Floats = np.sum(self.normals * self.corners, axis=1)
        self.left, self.bottom = (float(v) for v in self.corners.min(axis=0))
        self.right, self.top = (float(v) for v in self.corners.max(axis=0))
        points = [(float(x), float(y)) for x, y in self.corners]
        self._sides = list(zip(points, points[1:] + points[:1], strict=True))
        self._lines = [
            (float(n[0]), float(n[1]), float(c))
            for n, c in zip(self.normals, self.offsets, strict=True)
        ]

    def moved(self, shift: Floats) -> Region:
        """The same region, shifted by (2,)."""
        return Region(self.corners + shift)

    def turned(self) -> Region:
        """The same region turned by 180 degrees about the origin."""
        return Region(-self.corners)

    def depth(self, points: Floats) -> Floats:
        """How far inside of the nearest edge's line points (n, 2) lie, (n,); negative outside."""
        inside = points @ self.normals.T - self.offsets
        depths: Floats = inside[:, 0].copy()
        for edge in range(1, len(self.offsets)):  # numpy is slow along an axis that is short
            np.minimum(depths, inside[:, edge], out=depths)
        return depths

    def depth_at(self, x: float, y: float) -> float:
        """How far inside of the nearest edge's line one point lies; negative outside."""
        return min(a * x + b * y - c for a, b, c in self._lines)

    def chord(self, y: float) -> tuple[float, float] | None:
        """The x interval of the region at a height, None above and below it."""
        low, high = math.inf, -math.inf
        if self.bottom - ROUNDING < y < self.top + ROUNDING:
            y = min(max(y, self.bottom), self.top)
        for (x0, y0), (x1, y1) in self._sides:
            if min(y0, y1) <= y <= max(y0, y1):
                for x in (x0, x1) if y0 == y1 else (x0 + (y - y0) * (x1 - x0) / (y1 - y0),):
                    low, high = min(low, x), max(high, x)
        return (low, high) if low <= high else None

    def standing_room(self, y: float, half: float) -> tuple[float, float] | None:
        """Where on the height y a square of half-width `half`, not turned, lies in the region.

        Because the region is convex, that is where its upper and its lower edge do.
        """
        below, above = self.chord(y - half), self.chord(y + half)
        if below is None or above is None:
            return None
        left, right = max(below[0], above[0]) + half, min(below[1], above[1]) - half
        return (left, right) if left <= right else None


def rectangle(width: float, height: float) -> Region:
    """The rectangle with its lower left corner at the origin."""
    return Region(np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]))


def to_own_frame(pose: Pose, points: Floats) -> Floats:
    """Points (n, 2) of the robot's frame (x ahead, y left) in the frame of its pose."""
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    turn = np.array([[cos, sin], [-sin, cos]])
    placed: Floats = points @ turn + (pose.x, pose.y)
    return placed
