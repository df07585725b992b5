"""Figures that controllers draw with Player's graphics2d interface."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import bgr
from sim.video.projection import SHIFT, Projection
from sim.video.snapshot import Drawing


def draw_drawings(
    image: NDArray[np.uint8], drawings: Sequence[Drawing], projection: Projection
) -> None:
    """Draws the figures in order; one without enough points for its kind shows nothing."""
    for drawing in drawings:
        points = projection.fixed(np.asarray(drawing.points, dtype=float).reshape(-1, 2))
        color = bgr(drawing.color)
        if drawing.kind == "points":
            for point in points:
                cv2.circle(image, point.tolist(), 2 << SHIFT, color, -1, cv2.LINE_AA, SHIFT)
        elif drawing.kind == "polyline":
            if len(points) >= 2:
                cv2.polylines(image, [points], False, color, 1, cv2.LINE_AA, SHIFT)
        elif drawing.kind == "multiline":
            lines = list(points[: len(points) // 2 * 2].reshape(-1, 2, 2))
            if lines:
                cv2.polylines(image, lines, False, color, 1, cv2.LINE_AA, SHIFT)
        elif drawing.kind == "polygon":
            if len(points) >= 3:
                if drawing.filled:
                    inside = drawing.color if drawing.fill_color is None else drawing.fill_color
                    cv2.fillPoly(image, [points], bgr(inside), cv2.LINE_AA, SHIFT)
                cv2.polylines(image, [points], True, color, 1, cv2.LINE_AA, SHIFT)
        else:
            raise ValueError(f"no such kind of drawing: {drawing.kind!r}")
