"""Whether one more body fits: what stands in a world already, and the space that is free."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sim.stage.boxes import Boxes
from sim.stage.geometry import (
    Floats,
    distance_to_edges,
    in_convex,
    pieces,
    placed,
    separation,
    signed_area,
)
from sim.stage.layout import Layout
from sim.stage.levels import EVERY_LEVEL

ROUNDING = 1e-7
"""m by which sums of coordinates and margins may miss: places that just fit do fit."""


class FreeSpace:
    """Convex outlines that stand in a layout, with their bounds in arrays for a quick look.

    Solids are there from the start, and movable obstacles and doors' cells unless told
    otherwise; robots are added with `occupy`. low, high (2,): the bounds of where robots may be.
    """

    def __init__(self, layout: Layout, *, doors: bool = True, movable: bool = True) -> None:
        self._outer = layout.arena
        self._arena = layout.arena if layout.region is None else layout.region
        self._slanted = layout.region is not None
        self.low: Floats = self._arena.min(axis=0)
        self.high: Floats = self._arena.max(axis=0)
        self._outlines: list[Floats] = []
        self._margins: list[float] = []
        self._levels: list[int] = []
        self._boxes = Boxes()
        for solid in layout.solids:
            self.occupy(solid.vertices, 0.0, solid.levels)
        for one in layout.movables if movable else ():
            self.add_body(one.body, one.pose, layout.levels.of(one.body))
        for door in layout.doors if doors else ():
            self.occupy(door.rectangle, 0.0)

    def occupy(self, vertices: Floats, margin: float, levels: int = EVERY_LEVEL) -> None:
        """Add a convex outline (k, 2) that others must stay `margin` metres away from.

        levels: the bits of the heights at which it stands; who shares none is not kept away.
        """
        if not levels:
            return
        self._boxes.add(vertices.min(axis=0) - margin, vertices.max(axis=0) + margin)
        self._outlines.append(vertices)
        self._margins.append(margin)
        self._levels.append(levels)

    def add_body(self, body: Any, pose: ArrayLike, levels: int) -> None:
        """Add the parts of a body of the schema that stands at a pose (x, y, yaw)."""
        for vertices, _ in pieces(body):
            self.occupy(placed(vertices, pose), 0.0, levels)

    def hit_by(self, body: Any, pose: ArrayLike, tolerance: float, levels: int) -> int | None:
        """The number of an outline that a body would overlap by more than `tolerance` metres."""
        for vertices, _ in pieces(body):
            other = next(self.overlapped(placed(vertices, pose), tolerance, levels), None)
            if other is not None:
                return other
        return None

    def mark(self) -> int:
        """How many outlines there are: to go back to."""
        return len(self._outlines)

    def back_to(self, mark: int) -> None:
        """Forget the outlines added since."""
        del self._outlines[mark:]
        del self._margins[mark:]
        del self._levels[mark:]
        self._boxes.back_to(mark)

    def holds(self, points: Floats) -> bool:
        """Whether all points (n, 2) are where robots may be."""
        return bool(in_convex(points, self._outer).all())

    def too_small_for(self, count: int, shape: Floats, margin: float) -> bool:
        """Whether so many bodies with this outline are more than the region's area can hold.

        Bodies that keep a margin may each be grown by half of it without overlapping; grown so
        they are within the region's bounds less half a margin all around.
        """
        edges = np.roll(shape, -1, axis=0) - shape
        each = signed_area(shape) + float(np.hypot(*edges.T).sum()) * margin / 2
        width, height = np.maximum(self.high - self.low - margin, 0.0)
        return bool(count * each > min(width * height, signed_area(self._arena)))

    def fits(self, vertices: Floats, margin: float, levels: int = EVERY_LEVEL) -> bool:
        """Whether a body with this outline is in the region and far enough from everything.

        Far enough: `margin`, or the other's margin if that is more; the region's edges too.
        """
        low, high = vertices.min(axis=0) - margin, vertices.max(axis=0) + margin
        if low[0] < self.low[0] - ROUNDING or low[1] < self.low[1] - ROUNDING:
            return False
        if high[0] > self.high[0] + ROUNDING or high[1] > self.high[1] + ROUNDING:
            return False
        if self._slanted:
            if not in_convex(vertices, self._arena).all():
                return False
            # The corner of a convex body is what comes nearest to a convex region's edge.
            if margin > 0 and distance_to_edges(vertices, self._arena).min() < margin - ROUNDING:
                return False
        for index in self._near(low, high, levels):
            least = max(margin, self._margins[index])
            gap = separation(vertices, self._outlines[index])
            if gap < least - ROUNDING or gap <= 0.0:
                return False
        return True

    def chord(self, y: float) -> tuple[float, float]:
        """Least and greatest x of the region on the line of height y; an empty range if none."""
        start, end = self._arena, np.roll(self._arena, -1, axis=0)
        crossing = (np.minimum(start[:, 1], end[:, 1]) <= y) & (
            np.maximum(start[:, 1], end[:, 1]) >= y
        )
        if not crossing.any():
            return np.inf, -np.inf
        start, end = start[crossing], end[crossing]
        rise = end[:, 1] - start[:, 1]
        part = np.divide(y - start[:, 1], rise, out=np.zeros(len(rise)), where=rise != 0.0)
        x = np.concatenate([start[:, 0] + part * (end[:, 0] - start[:, 0]), end[rise == 0.0, 0]])
        return float(x.min()), float(x.max())

    def overlapped(
        self, vertices: Floats, tolerance: float, levels: int = EVERY_LEVEL
    ) -> Iterator[int]:
        """Numbers of the outlines that overlap this one by more than `tolerance` metres."""
        for index in self._near(vertices.min(axis=0), vertices.max(axis=0), levels):
            if separation(vertices, self._outlines[index]) < -tolerance:
                yield index

    def _near(self, low: Floats, high: Floats, levels: int) -> list[int]:
        return [index for index in self._boxes.near(low, high) if self._levels[index] & levels]
