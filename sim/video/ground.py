"""The still part of a frame: ground with a metric grid, doors, walls."""

from __future__ import annotations

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
    width, height = backdrop.size
    floor = np.array([[0, 0], [width, 0], [width, height], [0, height]], dtype=float)
    cv2.fillConvexPoly(image, projection.fixed(floor), bgr(GROUND), cv2.LINE_AA, SHIFT)
    _draw_grid(image, backdrop.size, projection)
    for door in backdrop.doors:
        outline = projection.fixed(np.asarray(door, dtype=float))
        cv2.fillConvexPoly(image, outline, bgr(mix(GROUND, SOFT_INK, 0.12)), cv2.LINE_AA, SHIFT)
        cv2.polylines(image, [outline], True, bgr(SOFT_INK), 1, cv2.LINE_AA, SHIFT)
    for outline, (_, color) in zip(
        solid_outlines(backdrop, projection), backdrop.solids, strict=True
    ):
        cv2.fillConvexPoly(image, outline, bgr(soften(color)), cv2.LINE_AA, SHIFT)
    return image


def solid_pixels(backdrop: Backdrop, projection: Projection) -> NDArray[np.bool_]:
    """(height, width) True where a wall covers most of a pixel: paint stays below."""
    mask = np.zeros((projection.height, projection.width), np.uint8)
    for outline in solid_outlines(backdrop, projection):
        cv2.fillConvexPoly(mask, outline, 255, cv2.LINE_AA, SHIFT)
    mask[projection.field_height :] = 255
    return mask > 127


def solid_outlines(backdrop: Backdrop, projection: Projection) -> list[NDArray[np.int32]]:
    """Each solid's corners (k, 2) in fixed-point pixels; a map may have thousands."""
    if not backdrop.solids:
        return []
    corners = [np.asarray(vertices, dtype=float) for vertices, _ in backdrop.solids]
    ends = np.cumsum([len(outline) for outline in corners])
    return np.split(projection.fixed(np.concatenate(corners)), ends[:-1])


def soften(color: int) -> int:
    """A world's colour as it is shown: a little less glaring, its hue kept."""
    return mix(color, 0x606468, 0.3)


def grid_lines(size: tuple[float, float], projection: Projection) -> list[NDArray[np.float64]]:
    """The lines of the metric grid, each (2, 2) in metres."""
    step = next((s for s in GRID_STEPS if s * projection.scale >= GRID_PIXELS), GRID_STEPS[-1])
    width, height = size
    lines = [[[x, 0], [x, height]] for x in np.arange(step, width - step / 100, step)]
    lines += [[[0, y], [width, y]] for y in np.arange(step, height - step / 100, step)]
    return [np.array(line, float) for line in lines]


def _draw_grid(image: NDArray[np.uint8], size: tuple[float, float], projection: Projection) -> None:
    for line in grid_lines(size, projection):
        # Whole pixels, no smoothing: every grid line is equally fine.
        start, end = (projection.fixed(line) + (1 << SHIFT) // 2) >> SHIFT
        cv2.line(image, start.tolist(), end.tolist(), bgr(GRID), 1)
