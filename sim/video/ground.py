"""The still part of a frame: ground with a metric grid, doors, walls."""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import (
    GRID,
    GROUND,
    OUTSIDE,
    SOFT_INK,
    bgr,
    mix,
)
from sim.video.projection import SHIFT, Projection
from sim.video.snapshot import Backdrop

GRID_STEPS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Metres between grid lines, the first that leaves GRID_PIXELS between them."""
GRID_PIXELS = 24.0


def draw_ground(
    backdrop: Backdrop, projection: Projection, outside: int = OUTSIDE
) -> NDArray[np.uint8]:
    """The backdrop as (height, width, 3) BGR; `outside`: the colour around the world."""
    image = np.empty((projection.height, projection.width, 3), np.uint8)
    image[:] = bgr(outside)
    cv2.fillConvexPoly(image, projection.fixed(floor_of(backdrop)), bgr(GROUND), cv2.LINE_AA, SHIFT)
    _draw_grid(image, backdrop.size, projection)
    for outline, (_, color) in zip(
        outlines_of(backdrop.marks, projection), backdrop.marks, strict=True
    ):
        cv2.fillConvexPoly(image, outline, bgr(soften(color)), cv2.LINE_AA, SHIFT)
    for door in backdrop.doors:
        outline = projection.fixed(np.asarray(door, dtype=float))
        cv2.fillConvexPoly(image, outline, bgr(mix(GROUND, SOFT_INK, 0.12)), cv2.LINE_AA, SHIFT)
        cv2.polylines(image, [outline], True, bgr(SOFT_INK), 1, cv2.LINE_AA, SHIFT)
    for outline, (_, color) in zip(
        outlines_of(backdrop.solids, projection), backdrop.solids, strict=True
    ):
        cv2.fillConvexPoly(image, outline, bgr(soften(color)), cv2.LINE_AA, SHIFT)
    return image


def solid_pixels(backdrop: Backdrop, projection: Projection) -> NDArray[np.bool_]:
    """(height, width) True where a wall covers most of a pixel: paint stays below."""
    mask = np.zeros((projection.height, projection.width), np.uint8)
    for outline in outlines_of(backdrop.solids, projection):
        cv2.fillConvexPoly(mask, outline, 255, cv2.LINE_AA, SHIFT)
    mask[projection.field_height :] = 255
    return mask > 127


def outlines_of(
    things: Sequence[tuple[NDArray[np.float64], int]], projection: Projection
) -> list[NDArray[np.int32]]:
    """Each thing's corners (k, 2) in fixed-point pixels; a map may have thousands."""
    if not things:
        return []
    corners = [np.asarray(vertices, dtype=float) for vertices, _ in things]
    ends = np.cumsum([len(outline) for outline in corners])
    return np.split(projection.fixed(np.concatenate(corners)), ends[:-1])


def soften(color: int) -> int:
    """A world's colour as it is shown: a little less glaring, its hue kept."""
    return mix(color, 0x606468, 0.3)


def grid_lines(size: tuple[float, float], projection: Projection) -> list[NDArray[np.float64]]:
    """The lines of the metric grid, each (2, 2) in metres."""
    step = next((s for s in GRID_STEPS if s * projection.scale >= GRID_PIXELS), GRID_STEPS[-1])
    left, bottom = projection.low
    right, top = left + size[0], bottom + size[1]
    lines = [[[x, bottom], [x, top]] for x in multiples(step, left, right)]
    lines += [[[left, y], [right, y]] for y in multiples(step, bottom, top)]
    return [np.array(line, float) for line in lines]


def multiples(step: float, low: float, high: float) -> list[float]:
    """The multiples of `step` between two numbers, themselves excluded."""
    first = math.floor(low / step + 0.01) + 1
    return [k * step for k in range(first, math.ceil(high / step - 0.01))]


def floor_of(backdrop: Backdrop) -> NDArray[np.float64]:
    """The corners (4, 2) of the world in metres."""
    (left, bottom), (width, height) = backdrop.low, backdrop.size
    right, top = left + width, bottom + height
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]], float)


def _draw_grid(image: NDArray[np.uint8], size: tuple[float, float], projection: Projection) -> None:
    for line in grid_lines(size, projection):
        # Whole pixels, no smoothing: every grid line is equally fine.
        start, end = (projection.fixed(line) + (1 << SHIFT) // 2) >> SHIFT
        cv2.line(image, start.tolist(), end.tolist(), bgr(GRID), 1)
