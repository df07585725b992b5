"""Bodies with their headings, in batches: a thousand cost little more than ten.

A body has the colour that the world or its algorithm gave it; its rim and its arrow have the
robot's identity colour. A robot that has settled is paler.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.ground import soften
from sim.video.palette import GROUND, INK, TINTS, bgr, contrast_ink, mix, tint
from sim.video.projection import SHIFT, Projection, to_fixed
from sim.video.snapshot import Shape

SMALLEST_RADIUS = 2.5
"""Pixels: smaller bodies are drawn larger, or they would vanish in a big world."""
DETAILED_RADIUS = 5.0
"""Pixels: smaller bodies are spots of colour, without a rim and a heading."""
RIM = 3.2
"""Units of the rim; a small body has a third of its radius."""
FADED = 0.6
"""How much of the ground there is in the colours of who has settled."""


class Kind:
    """All bodies of one outline. Points are complex numbers: turning is multiplying."""

    def __init__(self, vertices: NDArray[np.float64], unit: float, heading: bool) -> None:
        """`vertices` (k, 2) in pixels, x ahead, y to the left; `heading`: with rim and arrow."""
        inside = _inner_radius(vertices)
        self.detailed = bool(np.hypot(*vertices.T).max() >= DETAILED_RADIUS)
        self.rimmed = self.detailed and heading and inside > 0
        parts = [vertices]
        if self.rimmed:
            rim = min(max(RIM * unit, 1.0), inside / 3)
            inner = vertices * (1 - rim / inside)
            parts += [inner, heading_wedge(inner)]
        corners = np.concatenate(parts)
        self.corners = corners[:, 0] - 1j * corners[:, 1]  # a frame's y axis points down
        self.count = len(vertices)
        """Corners of the outline; as many of its inside and three of the arrow follow, if any."""
        self.members = np.empty(0, np.intp)


@dataclass(frozen=True)
class Placed:
    """The bodies of one kind at their poses: corners (n, k) as complex numbers, in pixel edges."""

    kind: Kind
    corners: NDArray[np.complex128]


class Bodies:
    """The outlines of all bodies; poses and colours come with each frame."""

    def __init__(self, projection: Projection) -> None:
        self._projection = projection
        self._kinds: dict[bytes, Kind] = {}
        self.radii: list[float] = []
        """Pixels from each body's origin to its farthest corner, as drawn."""

    def __len__(self) -> int:
        return len(self.radii)

    def add(self, shape: Shape, *, heading: bool = True) -> int:
        """Adds a body, with rim and arrow or without; returns its index."""
        vertices = outline_of(shape, self._projection.scale) * self._projection.scale
        radius = float(np.hypot(vertices[:, 0], vertices[:, 1]).max())
        if radius < SMALLEST_RADIUS:
            vertices = vertices * (SMALLEST_RADIUS / max(radius, 1e-9))
            radius = SMALLEST_RADIUS
        key = vertices.tobytes()
        if key not in self._kinds:
            self._kinds[key] = Kind(vertices, self._projection.unit, heading)
        kind = self._kinds[key]
        kind.members = np.append(kind.members, len(self.radii))
        self.radii.append(radius)
        return len(self.radii) - 1

    def place(self, poses: NDArray[np.float64]) -> list[Placed]:
        """The bodies at poses (n, 3), kind by kind."""
        edges = self._projection.edges(poses[:, :2])
        centres = edges[:, 0] + 1j * edges[:, 1]
        turns = np.exp(-1j * poses[:, 2])
        return [
            Placed(kind, centres[kind.members, None] + turns[kind.members, None] * kind.corners)
            for kind in self._kinds.values()
        ]

    def boxes(self, placed: Sequence[Placed]) -> NDArray[np.float64]:
        """(n, 4) the left, top, right and bottom of each body in pixels."""
        boxes = np.empty((len(self.radii), 4))
        for each in placed:
            outline = each.corners[:, : each.kind.count]
            boxes[each.kind.members] = np.stack(
                [
                    outline.real.min(axis=1),
                    outline.imag.min(axis=1),
                    outline.real.max(axis=1),
                    outline.imag.max(axis=1),
                ],
                axis=1,
            )
        return boxes


@dataclass(frozen=True)
class Coat:
    """The colours of one body, 0xRRGGBB."""

    fill: int
    edge: int
    rim: int
    halo: int
    """Around the arrow, so that it stands out from the body."""


@lru_cache(maxsize=1024)
def coat_of(color: int, robot: int | None, settled: bool = False) -> Coat:
    """The colours of a robot's body, or (`robot` None) of a thing's."""
    fill = soften(color)
    rim = fill if robot is None else tint(robot)
    edge = mix(rim, INK, 0.6)
    if settled:
        fill, edge, rim = (
            mix(fill, GROUND, FADED),
            mix(edge, GROUND, FADED),
            mix(rim, GROUND, 0.45),
        )
    return Coat(fill, edge, rim, halo=contrast_ink(rim))


def draw_bodies(
    image: NDArray[np.uint8],
    placed: Sequence[Placed],
    colors: NDArray[np.int64],
    settled: NDArray[np.bool_] | None = None,
    *,
    robots: bool = True,
    line: int = 1,
) -> None:
    """Draws bodies in colors (n,) 0xRRGGBB; `settled` (n,); `line`: the edges' pixels."""
    for each in placed:
        kind, members = each.kind, each.kind.members
        corners = to_fixed(each.corners.view(np.float64).reshape(*each.corners.shape, 2))
        pale = np.zeros(len(members), bool) if settled is None else settled[members]
        rimmed = robots and kind.rimmed
        alike: dict[tuple[int, bool, int | None], list[int]] = {}
        for place, key in enumerate(
            zip(
                colors[members].tolist(),
                pale.tolist(),
                (members % len(TINTS)).tolist() if rimmed else [None] * len(members),
                strict=True,
            )
        ):
            alike.setdefault(key, []).append(place)
        for (color, faded, robot), them in alike.items():
            _draw_alike(image, corners[them], coat_of(color, robot, faded), kind, line)


def _draw_alike(
    image: NDArray[np.uint8], corners: NDArray[np.int32], coat: Coat, kind: Kind, line: int
) -> None:
    """Draws bodies of one kind and coat; corners (n, k, 2) fixed-point pixels."""
    count = kind.count
    outlines = list(corners[:, :count])
    first = coat.rim if kind.rimmed else coat.fill
    cv2.fillPoly(image, outlines, bgr(first), cv2.LINE_AA, SHIFT)
    if not kind.detailed:
        return
    cv2.polylines(image, outlines, True, bgr(coat.edge), line, cv2.LINE_AA, SHIFT)
    if kind.rimmed:
        cv2.fillPoly(image, list(corners[:, count : 2 * count]), bgr(coat.fill), cv2.LINE_AA, SHIFT)
        arrows = list(corners[:, 2 * count :])
        cv2.polylines(image, arrows, True, bgr(coat.halo), 2 * line + 1, cv2.LINE_AA, SHIFT)
        cv2.fillPoly(image, arrows, bgr(coat.rim), cv2.LINE_AA, SHIFT)


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
    back = -0.2 * front
    return np.array([[0.9 * front, 0.0], [back, 0.6 * side], [back, -0.6 * side]])


def reach_ahead(vertices: NDArray[np.float64]) -> float:
    """Distance from the origin along the x axis to the outline; 0 where the axis misses it."""
    reach = 0.0
    for (x0, y0), (x1, y1) in zip(vertices, np.roll(vertices, -1, axis=0), strict=True):
        if (y0 <= 0) != (y1 <= 0):
            reach = max(reach, x0 - y0 * (x1 - x0) / (y1 - y0))
    return float(reach)


def _inner_radius(vertices: NDArray[np.float64]) -> float:
    """Distance from the origin to the nearest edge of an outline about it; else 0 or less."""
    ahead = np.roll(vertices, -1, axis=0)
    along = ahead - vertices
    cross = vertices[:, 0] * along[:, 1] - vertices[:, 1] * along[:, 0]
    lengths = np.hypot(along[:, 0], along[:, 1])
    distances = cross[lengths > 0] / lengths[lengths > 0]
    return float(max(distances.min(), (-distances).min()))


def colors_of(colors: NDArray[np.integer] | Sequence[int], count: int) -> NDArray[np.int64]:
    """Colours as an array (count,); raises ValueError for another number of them."""
    array = np.asarray(colors, dtype=np.int64)
    if array.shape != (count,):
        raise ValueError(f"{count} bodies need {count} colors, not an array of {array.shape}")
    return array
