"""Range readings as translucent fans in their robots' tints, and what blobfinders see."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import INK, bgr, mix, tint
from sim.video.projection import SHIFT, Projection, to_fixed
from sim.video.snapshot import Scan, Sighting

FARTHEST_RANGE = 1e5
"""Metres: longer and infinite ranges are drawn to here."""
STRENGTH = 0.16
"""Share of the light that one fan takes away; of n fans each takes 1 / sqrt(n) of that, so
that they stay visible alone and the ground stays light where all overlap."""
PALE, PALER = 0.35, 0.7
"""How much white there is in the edge of a filled fan, and in an edge that stands alone."""
SMOOTHING = 5
"""Sixteenths of a pixel by which a fan's outline may be off: rays along a wall become a line."""


RING, RING_WIDTH = 7.0, 3.0
"""Units outside of a body at which what its blobfinder sees is drawn, and how broad."""
SMOOTH = cv2.LINE_AA


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
    *,
    filled: bool = True,
) -> None:
    """Draws scans, or their edges. `scratch` is an image of the same size to work in."""
    strength = STRENGTH / math.sqrt(max(len(scans), 1))
    line = projection.units(1)
    for scan in scans:
        outline = fan_outline(scan, projection)
        if not filled:
            edge = bgr(mix(tint(scan.robot), 0xFFFFFF, PALER))
            cv2.polylines(image, [outline], True, edge, line, cv2.LINE_AA, SHIFT)
            continue
        area = _area(outline, image.shape[1], image.shape[0])
        if area is None:
            continue
        color = tint(scan.robot)
        # Ink on paper: the fan takes away what its tint lacks to white.
        lacking = bgr(mix(0x000000, 0xFFFFFF - color, strength))
        scratch[area] = 0
        cv2.fillPoly(scratch, [outline], lacking, cv2.LINE_8, SHIFT)
        cv2.subtract(image[area], scratch[area], dst=image[area])
        edge = bgr(mix(color, 0xFFFFFF, PALE))
        cv2.polylines(image, [outline], True, edge, line, cv2.LINE_AA, SHIFT)


def _area(outline: NDArray[np.int32], width: int, height: int) -> tuple[slice, slice] | None:
    """Rows and columns that the outline spans, None where it lies outside of the image."""
    x, y, across, down = cv2.boundingRect(outline)
    left, right = max((x >> SHIFT) - 1, 0), min(((x + across) >> SHIFT) + 2, width)
    top, bottom = max((y >> SHIFT) - 1, 0), min(((y + down) >> SHIFT) + 2, height)
    if left >= right or top >= bottom:
        return None
    return slice(top, bottom), slice(left, right)


def sighting_arcs(
    sighting: Sighting, radius: float, projection: Projection
) -> list[tuple[int, NDArray[np.float64]]]:
    """What a blobfinder sees as arcs around its robot: colour 0xRRGGBB, points (k, 2) in pixels.

    `radius` in pixels: that of the robot's body.
    """
    x, y, yaw = (float(value) for value in sighting.pose)
    centre = projection.edges(np.array([x, y]))
    reach = radius + RING * projection.unit
    arcs: list[tuple[int, NDArray[np.float64]]] = []
    for (right, left), color in zip(sighting.bearings, sighting.colors, strict=True):
        steps = max(2, math.ceil(abs(left - right) * reach / 6) + 1)
        angles = yaw + np.linspace(right, left, steps)
        arcs.append((int(color), centre + reach * np.stack([np.cos(angles), -np.sin(angles)], 1)))
    return arcs


def draw_sightings(
    image: NDArray[np.uint8],
    sightings: Sequence[Sighting],
    radii: Sequence[float],
    projection: Projection,
) -> None:
    """Draws what blobfinders see; `radii` of all robots' bodies in pixels."""
    width = projection.units(RING_WIDTH)
    for sighting in sightings:
        arcs = [
            (color, [to_fixed(points)])
            for color, points in sighting_arcs(sighting, radii[sighting.robot], projection)
        ]
        for _, line in arcs:
            cv2.polylines(image, line, False, bgr(INK), width + 2, SMOOTH, SHIFT)
        for color, line in arcs:
            cv2.polylines(image, line, False, bgr(color), width, SMOOTH, SHIFT)
