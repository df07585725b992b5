"""Perception that controllers share: robots and walls found in laser scans and blobs.

All positions are in the sensor's frame (x ahead, y to the left; metres), bearings in radians
counter-clockwise from straight ahead.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray


class Seen(Protocol):
    """What is needed of a blob (`player.Blob`): colour 0xRRGGBB, columns, range in metres."""

    @property
    def color(self) -> int: ...
    @property
    def left(self) -> int: ...
    @property
    def right(self) -> int: ...
    @property
    def range(self) -> float: ...


class Sighting(NamedTuple):
    """A run of one colour in the field of view: bearings of its two ends, and its mean range."""

    color: int
    right: float
    left: float
    range: float

    @property
    def bearing(self) -> float:
        """The bearing of the middle."""
        return 0.5 * (self.left + self.right)


class Segment(NamedTuple):
    """Consecutive laser points of one surface or one body."""

    first: int
    last: int
    points: NDArray[np.float64]  # (last - first + 1, 2)

    @property
    def centre(self) -> tuple[float, float]:
        """The mean of the points (on the near side of what was hit)."""
        x, y = self.points.mean(axis=0)
        return float(x), float(y)


def column_bearing(column: float, width: int, fov: float) -> float:
    """The bearing of an image column: column 0 looks to the left end of the field of view."""
    return fov / 2 - column * fov / (width - 1)


def sightings(blobs: Iterable[Seen], color: int, width: int, fov: float) -> list[Sighting]:
    """The blobs of one colour as bearings; `width` is the image's, `fov` in radians."""
    return [
        Sighting(
            color,
            column_bearing(blob.right, width, fov),
            column_bearing(blob.left, width, fov),
            blob.range,
        )
        for blob in blobs
        if blob.color == color
    ]


def segments(
    points: NDArray[np.float64],
    ranges: NDArray[np.float64],
    max_range: float,
    jump: float = 0.5,
) -> list[Segment]:
    """A scan cut into surfaces, where the range jumps by more than `jump` m, or nothing is hit.

    `points` (n, 2) and `ranges` (n,) come from one `LaserProxy`; readings at `max_range` hit
    nothing and belong to no segment.
    """
    hit = ranges < max_range
    found: list[Segment] = []
    first: int | None = None
    for i in range(len(ranges)):
        if first is not None and (not hit[i] or abs(ranges[i] - ranges[i - 1]) > jump):
            found.append(Segment(first, i - 1, points[first:i]))
            first = None
        if hit[i] and first is None:
            first = i
    if first is not None:
        found.append(Segment(first, len(ranges) - 1, points[first:]))
    return found


def free_ahead(
    ranges: NDArray[np.float64], bearings: NDArray[np.float64], half_width: float
) -> float:
    """How far a body of that half width could go straight on before it meets a laser point (m)."""
    sines, cosines = np.sin(bearings), np.cos(bearings)
    in_way = (cosines > 0.0) & (np.abs(ranges * sines) <= half_width)
    near = ranges[in_way] * cosines[in_way]
    return float(near.min()) if near.size else math.inf
