"""The observe step: a laser scan and blobs become walls, and robots at places.

The laser gives geometry, the blobfinder colours: red is wall, green a robot. Once the robot knows
where the walls are, a point that lies clearly inside the region is on a robot; the blobs confirm.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..constants import BODY
from ..geometry import Floats, Pose, to_own_frame
from .squares import Square, any_of, fit_square, may_be_one

RED, GREEN = 0xFF0000, 0x00FF00

CLEAR_OF_WALL = 0.06
"""A point farther inside the region than this (m) is not on a wall; bodies keep farther off."""


class Patch(Protocol):
    """What is used of a blob: its colour 0xRRGGBB and its columns in the image."""

    @property
    def color(self) -> int: ...
    @property
    def left(self) -> int: ...
    @property
    def right(self) -> int: ...


@dataclass(frozen=True)
class Scan:
    """One reading of laser and blobfinder, placed in the own frame.

    `ranges`, `bearings` (n,) from the right, m and rad, in the robot's frame; `points` (n, 2) and
    `directions` (n, 2) in the own frame; `hit` (n,) whether something was hit; `red`, `green`
    (n,) whether the blobs show the colour there (at the border of two colours, both).
    """

    pose: Pose
    ranges: Floats
    bearings: Floats
    points: Floats
    directions: Floats
    hit: NDArray[np.bool_]
    red: NDArray[np.bool_]
    green: NDArray[np.bool_]

    @cached_property
    def maxima(self) -> Floats:
        """The largest range of every run of 1, 2, 4, ... rays, a row each, (rows, n).

        Row k holds at i the largest of the 2**k ranges from ray i on; what has no such run is 0.
        """
        rows = [self.ranges]
        while 2 ** len(rows) <= len(self.ranges):
            half = 2 ** (len(rows) - 1)
            rows.append(np.maximum(rows[-1][:-half], rows[-1][half:]))
        table = np.zeros((len(rows), len(self.ranges)))
        for k, row in enumerate(rows):
            table[k, : len(row)] = row
        return table


def take_scan(
    pose: Pose,
    ranges: Floats,
    bearings: Floats,
    max_range: float,
    blobs: Iterable[Patch],
    image_width: int,
) -> Scan:
    """Place a laser scan in the own frame and colour its rays by the blobs' columns.

    Both sensors look ahead from the robot's centre with one field of view; column 0 of the image
    is at the left end.
    """
    rays = np.stack([np.cos(bearings), np.sin(bearings)], axis=1)
    directions = to_own_frame(Pose(0.0, 0.0, pose.yaw), rays)
    points = directions * ranges[:, None] + (pose.x, pose.y)
    red, green = np.zeros(len(ranges), bool), np.zeros(len(ranges), bool)
    fov = float(bearings[-1] - bearings[0])
    columns = (bearings[-1] - bearings) * (image_width - 1) / fov
    for blob in blobs:
        inside = (columns > blob.left - 1) & (columns < blob.right + 1)
        if blob.color == RED:
            red |= inside
        elif blob.color == GREEN:
            green |= inside
    hit = ranges < max_range
    return Scan(pose, ranges, bearings, points, directions, hit, red, green)


def red_points(scan: Scan) -> Floats:
    """The scan's points on walls (n, 2), by colour alone."""
    return scan.points[scan.hit & scan.red & ~scan.green]


def wall_points(scan: Scan, depth: Floats) -> Floats:
    """The scan's points on walls (n, 2); `depth` (rays,) says how far inside the region each is."""
    return scan.points[scan.hit & scan.red & (depth < 2.0 * CLEAR_OF_WALL)]


def see_robots(scan: Scan, depth: Floats) -> list[Square]:
    """The robots in a scan, as squares in the own frame; `depth` as for `wall_points`."""
    standing = scan.hit & scan.green & (depth > CLEAR_OF_WALL)
    rays = np.flatnonzero(standing)
    if rays.size == 0:
        return []
    gaps = np.hypot(*np.diff(scan.points[rays], axis=0).T)
    cuts = np.flatnonzero((np.diff(rays) > 1) | (gaps > math.sqrt(2.0) * BODY)) + 1
    seen: list[Square] = []
    for run in np.split(rays, cuts):
        for square in _squares_in(scan, run):
            _add(seen, square)
    return seen


def _add(seen: list[Square], square: Square) -> None:
    """Add a square, unless it may be a piece of one seen already, left and right of what hides its
    middle: of the two the exact one is kept."""
    for i, other in enumerate(seen):
        if may_be_one(square, other):
            seen[i] = min(square, other, key=lambda s: (not s.certain, s.error))
            return
    seen.append(square)


def _squares_in(scan: Scan, run: NDArray[np.intp]) -> list[Square]:
    """One run of rays on robots as one square, or as several where one does not fit."""
    square = _fit(scan, run)
    if square is not None or len(run) == 1:
        return [] if square is None else [square]
    jumps = np.abs(np.diff(scan.ranges[run]))
    order = np.argsort(-jumps, kind="stable")
    found: list[list[Square]] = []
    for cut in order[:6]:
        if found and jumps[cut] < 0.5 * jumps[order[0]]:
            break
        parts = [_fit(scan, run[: cut + 1]), _fit(scan, run[cut + 1 :])]
        squares = [part for part in parts if part is not None]
        if len(squares) == 2:
            found.append(squares)
    if found:  # where it may be cut at several places, the squares are as vague as that
        both = [any_of([pair[side] for pair in found]) for side in (0, 1)]
        return [square for square in both if square is not None]
    if jumps[order[0]] < 0.1:
        return []  # one surface that is no robot's
    cut = order[0]
    return _squares_in(scan, run[: cut + 1]) + _squares_in(scan, run[cut + 1 :])


def _fit(scan: Scan, run: NDArray[np.intp]) -> Square | None:
    first, last = int(run[0]), int(run[-1])
    right = _passing(scan, first - 1, float(scan.ranges[first]))
    left = _passing(scan, last + 1, float(scan.ranges[last]))
    return fit_square(scan.points[run], (scan.pose.x, scan.pose.y), (right, left))


def _passing(scan: Scan, ray: int, beside: float) -> Floats | None:
    """The direction of a ray if it went on clearly beyond what its neighbour hit."""
    if not 0 <= ray < len(scan.ranges) or scan.ranges[ray] < beside + BODY + 0.05:
        return None
    direction: Floats = scan.directions[ray]
    return direction
