"""Range readings as translucent fans in their robots' tints."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import bgr, mix, tint
from sim.video.projection import SHIFT, Projection, to_fixed
from sim.video.view import MOST_SCANS, Scan

FARTHEST_RANGE = 1e5
"""Metres: longer and infinite ranges are drawn to here."""
STRENGTH = 0.16
"""Share of the light that one fan takes away; of n fans each takes 1 / sqrt(n) of that, so
that they stay visible alone and the ground stays light where all overlap."""
SMOOTHING = 5
"""Sixteenths of a pixel by which a fan's outline may be off: rays along a wall become a line."""


@lru_cache(maxsize=64)
def _directions(fov: float, rays: int) -> NDArray[np.complex128]:
    """(rays,) unit vectors of the bearings as complex numbers, y pointing down."""
    directions: NDArray[np.complex128] = np.exp(-1j * np.linspace(-fov / 2, fov / 2, rays))
    return directions


def fan_outline(scan: Scan, projection: Projection) -> NDArray[np.int32]:
    """The fan's corners (k, 2), the sensor among them, in fixed-point pixels."""
    x, y, yaw = (float(value) for value in scan.pose)
    points = np.empty(len(scan.ranges) + 1, np.complex128)
    points[0] = 0
    turn = cmath.rect(projection.scale, -yaw)
    points[1:] = _directions(scan.fov, len(scan.ranges)) * np.fmin(scan.ranges, FARTHEST_RANGE)
    points *= turn
    points += complex(
        projection.left + x * projection.scale, projection.bottom - y * projection.scale
    )
    corners = to_fixed(points.view(np.float64).reshape(-1, 2))
    outline = cv2.approxPolyDP(corners, SMOOTHING, True)
    return np.asarray(outline, dtype=np.int32).reshape(-1, 2)


def draw_scans(
    image: NDArray[np.uint8],
    scratch: NDArray[np.uint8],
    scans: Sequence[Scan],
    projection: Projection,
) -> None:
    """Draws the first MOST_SCANS scans. `scratch` is an image of the same size to work in."""
    shown = [scan for scan in scans if len(scan.ranges)][:MOST_SCANS]
    strength = STRENGTH / math.sqrt(max(len(shown), 1))
    for scan in shown:
        outline = fan_outline(scan, projection)
        area = _area(outline, image.shape[1], image.shape[0])
        if area is None:
            continue
        color = tint(scan.robot)
        # Ink on paper: the fan takes away what its tint lacks to white.
        lacking = bgr(mix(0x000000, 0xFFFFFF - color, strength))
        scratch[area] = 0
        cv2.fillPoly(scratch, [outline], lacking, cv2.LINE_8, SHIFT)
        cv2.subtract(image[area], scratch[area], dst=image[area])
        edge = bgr(mix(color, 0xFFFFFF, 0.35))
        cv2.polylines(image, [outline], True, edge, 1, cv2.LINE_AA, SHIFT)


def _area(outline: NDArray[np.int32], width: int, height: int) -> tuple[slice, slice] | None:
    """Rows and columns that the outline spans, None where it lies outside of the image."""
    x, y, across, down = cv2.boundingRect(outline)
    left, right = max((x >> SHIFT) - 1, 0), min(((x + across) >> SHIFT) + 2, width)
    top, bottom = max((y >> SHIFT) - 1, 0), min(((y + down) >> SHIFT) + 2, height)
    if left >= right or top >= bottom:
        return None
    return slice(top, bottom), slice(left, right)
