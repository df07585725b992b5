"""Bodies with their headings, drawn in batches: a thousand cost little more than ten."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.ground import soften
from sim.video.palette import INK, bgr, contrast_ink, mix
from sim.video.projection import SHIFT, Projection, to_fixed
from sim.video.view import Shape

SMALLEST_RADIUS = 2.5
"""Pixels: smaller bodies are drawn larger, or they would vanish in a big world."""
DETAILED_RADIUS = 4.0
"""Pixels: smaller bodies are spots of colour, without an edge line and a heading."""


class _Kind:
    """All bodies of one outline. Points are complex numbers: turning is multiplying."""

    def __init__(self, vertices: NDArray[np.float64], detailed: bool, heading: bool) -> None:
        """`vertices` (k, 2) in pixels, x ahead, y to the left; `detailed`: with an edge line."""
        self.detailed, self.wedged = detailed, detailed and heading
        corners = np.concatenate([vertices, heading_wedge(vertices)]) if self.wedged else vertices
        self.corners = corners[:, 0] - 1j * corners[:, 1]  # a frame's y axis points down
        self.count = len(vertices)
        self.members = np.empty(0, np.intp)


class Bodies:
    """The outlines of all bodies; poses and colours come with each frame."""

    def __init__(self, projection: Projection) -> None:
        self._projection = projection
        self._kinds: dict[bytes, _Kind] = {}
        self.radii: list[float] = []
        """Pixels from each body's origin to its farthest corner, as drawn."""

    def __len__(self) -> int:
        return len(self.radii)

    def add(self, shape: Shape, *, heading: bool = True) -> int:
        """Adds a body, with a wedge that shows its heading or without; returns its index."""
        vertices = outline_of(shape, self._projection.scale) * self._projection.scale
        radius = float(np.hypot(vertices[:, 0], vertices[:, 1]).max())
        if radius < SMALLEST_RADIUS:
            vertices = vertices * (SMALLEST_RADIUS / max(radius, 1e-9))
            radius = SMALLEST_RADIUS
        key = vertices.tobytes()
        if key not in self._kinds:
            self._kinds[key] = _Kind(vertices, radius >= DETAILED_RADIUS, heading)
        kind = self._kinds[key]
        kind.members = np.append(kind.members, len(self.radii))
        self.radii.append(radius)
        return len(self.radii) - 1

    def draw(
        self, image: NDArray[np.uint8], poses: NDArray[np.float64], colors: NDArray[np.int64]
    ) -> None:
        """Draws every body at poses (n, 3) in colors (n,) 0xRRGGBB."""
        edges = self._projection.edges(poses[:, :2])
        centres = edges[:, 0] + 1j * edges[:, 1]
        turns = np.exp(-1j * poses[:, 2])
        for kind in self._kinds.values():
            placed = centres[kind.members, None] + turns[kind.members, None] * kind.corners
            corners = to_fixed(placed.view(np.float64).reshape(*placed.shape, 2))
            their_colors = colors[kind.members]
            for color in sorted(set(their_colors.tolist())):
                _draw_alike(image, corners[their_colors == color], color, kind)


def _draw_alike(
    image: NDArray[np.uint8], corners: NDArray[np.int32], color: int, kind: _Kind
) -> None:
    """Draws bodies of one kind and colour; corners (n, k, 2) fixed-point pixels."""
    shown = soften(color)
    outlines = list(corners[:, : kind.count])
    cv2.fillPoly(image, outlines, bgr(shown), cv2.LINE_AA, SHIFT)
    if not kind.detailed:
        return
    cv2.polylines(image, outlines, True, bgr(mix(shown, INK, 0.6)), 1, cv2.LINE_AA, SHIFT)
    if kind.wedged:
        wedges = list(corners[:, kind.count :])
        cv2.fillPoly(image, wedges, bgr(contrast_ink(shown)), cv2.LINE_AA, SHIFT)


def outline_of(shape: Shape, scale: float) -> NDArray[np.float64]:
    """Vertices (k, 2) in metres; a circle becomes a polygon that looks round at `scale`."""
    if isinstance(shape, np.ndarray) and shape.ndim == 2:
        return np.asarray(shape, dtype=float)
    radius = float(shape)
    # A polygon of k corners stays within 0.1 pixel of the circle for k = pi sqrt(r / 0.2).
    corners = int(np.clip(np.ceil(np.pi * np.sqrt(radius * scale / 0.2)), 8, 96))
    angles = np.arange(corners) * (2 * np.pi / corners)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1) * radius


def heading_wedge(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
    """A triangle (3, 2) inside a convex outline whose tip points ahead."""
    front = reach_ahead(vertices)
    side = 0.5 * min(np.ptp(vertices[:, 1]), 1.4 * front)
    return np.array(
        [[0.86 * front, 0.0], [0.22 * front, 0.56 * side], [0.22 * front, -0.56 * side]]
    )


def reach_ahead(vertices: NDArray[np.float64]) -> float:
    """Distance from the origin along the x axis to the outline; 0 where the axis misses it."""
    reach = 0.0
    for (x0, y0), (x1, y1) in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        if (y0 <= 0) != (y1 <= 0):
            reach = max(reach, x0 - y0 * (x1 - x0) / (y1 - y0))
    return float(reach)


def colors_of(colors: NDArray[np.integer] | Sequence[int], count: int) -> NDArray[np.int64]:
    """Colours as an array (count,); raises ValueError for another number of them."""
    array = np.asarray(colors, dtype=np.int64)
    if array.shape != (count,):
        raise ValueError(f"{count} bodies need {count} colors, not an array of {array.shape}")
    return array
