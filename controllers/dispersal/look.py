"""What a robot's lasers and cameras tell of the eight cells around it.

The robot stands at its cell's centre and looks along "up": its x axis. With bodies of width b in
cells of width c the nearest thing along "up" is a wall of the next cell at c/2, a robot in it at
c - b/2, or, if the next cell is free, something at 3c/2 or more. Along a diagonal it is a wall's
corner at c/sqrt(2), a robot's at sqrt(2) (c - b/2), or at least the far corner of the free cell,
at 3c/sqrt(2). A threshold halfway between a robot and the free case tells them apart, with room
for errors of some tenths of a metre.

A diagonal is seen past the two cells beside it; if one of them is a wall, its corner hides the
diagonal, which then counts as occupied. No rule asks for the diagonal in that case.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from controllers.motion import wrap
from controllers.perception import Seen, sightings

Floats = NDArray[np.float64]

BEAM = math.radians(4.0)
"""Half the width of the bundle of rays that decides about a cell."""


class Image(Protocol):
    """What is needed of a `BlobfinderProxy`."""

    @property
    def blobs(self) -> Iterable[Seen]: ...
    @property
    def width(self) -> int: ...


def occupied(bearings: Floats, ranges: Floats, cell: float, body: float) -> int:
    """Bits 0-7 of what a rule sees: the cells up, right, down, left, then the diagonals between.

    `bearings` (n,) in the robot's frame, counter-clockwise from up, and `ranges` (n,) of all
    lasers together; `cell` and `body` are widths in metres.
    """
    straight = 0.5 * (cell - body / 2 + 1.5 * cell)
    diagonal = 0.5 * math.sqrt(2.0) * (cell - body / 2 + 1.5 * cell)
    seen = 0
    for k in range(8):
        towards = direction_bearing(k)
        aside = np.abs(np.remainder(bearings - towards + math.pi, math.tau) - math.pi)
        nearest = float(np.median(ranges[aside <= BEAM]))
        if nearest < (straight if k < 4 else diagonal):
            seen |= 1 << k
    return seen


def direction_bearing(k: int) -> float:
    """The bearing of cell k: 0-3 up, right, down, left; 4-7 up-right, right-down, and so on."""
    return -math.pi / 2 * k if k < 4 else -math.pi / 2 * (k - 4) - math.pi / 4


def active(cameras: Iterable[tuple[Image, float, float]], color: int, occupied: int) -> int:
    """Bits 8-15 of what a rule sees: in which of the occupied cells a robot of that colour stands.

    Each camera is (image, field of view, mounting angle), radians. Robots of one colour side by
    side are one blob, whose range is a mean: so the lasers say which cells are occupied, and the
    camera only whether that colour is what stands in a cell's direction.
    """
    seen = 0
    for image, fov, mounted in cameras:
        column = fov / (image.width - 1)
        for sighting in sightings(image.blobs, color, image.width, fov):
            half = 0.5 * (sighting.left - sighting.right) + column
            for k in range(8):
                off = abs(wrap(sighting.bearing + mounted - direction_bearing(k)))
                if occupied >> k & 1 and off <= half:
                    seen |= 1 << (8 + k)
    return seen
