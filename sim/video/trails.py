"""The last stretch of every robot's way, as lines in its tint that fade with age."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import TINTS, bgr, mix
from sim.video.projection import SHIFT, Projection

LENGTH = 60
"""Frames that a trail lasts."""
SMOOTHING = 8
"""Sixteenths of a pixel by which a whole way may be off: straight stretches become a line."""
CROWD = 100
"""With more robots than this, trails last CROWD_LENGTH frames and are not smoothed."""
CROWD_LENGTH = 15


class Trails:
    """Where the robots were in the last frames."""

    def __init__(self, projection: Projection) -> None:
        self._projection = projection
        self._points = np.empty((0, LENGTH, 2), np.int32)  # a ring along the second axis
        self._entered = np.empty(0, np.int64)  # mark at which a robot's trail begins
        self._marks = 0

    def mark(self, poses: NDArray[np.float64]) -> None:
        """Adds the robots' places (n, 3) of a new frame; n may have grown."""
        count, known = len(poses), len(self._points)
        if count > known:
            grown = np.empty((max(count, 2 * known), LENGTH, 2), np.int32)
            grown[:known] = self._points
            self._points = grown
        if count > len(self._entered):
            new = np.full(count - len(self._entered), self._marks)
            self._entered = np.concatenate([self._entered, new])
        self._points[:count, self._marks % LENGTH] = self._projection.fixed(poses[:, :2])
        self._marks += 1

    def lines(self) -> Iterator[tuple[int, list[NDArray[np.int32]]]]:
        """The trails in batches of one colour (0xRRGGBB), the older half paler.

        Each line is (k, 2) in fixed-point pixels, from the past to now.
        """
        count = len(self._entered)
        length = min(CROWD_LENGTH if self.crowded else LENGTH, self._marks)
        if length < 2:
            return
        marks = np.arange(self._marks - length, self._marks)
        points = self._points[:count, marks % LENGTH]
        # Before it entered a robot has been nowhere: its trail starts where it came in.
        early = np.maximum(self._entered - marks[0], 0)
        for robot in np.flatnonzero(early):
            points[robot, : early[robot]] = points[robot, min(early[robot], length - 1)]
        moved = np.ptp(points, axis=1).max(axis=1) >= 1 << SHIFT
        middle = length // 2
        parts = ((points[:, : middle + 1], 0.55), (points[:, middle:], 0.15))
        for part, paleness in parts:
            for index, color in enumerate(TINTS[:count]):
                if lines := list(part[index :: len(TINTS)][moved[index :: len(TINTS)]]):
                    yield mix(mix(color, 0x000000, 0.15), 0xFFFFFF, paleness), lines

    @property
    def crowded(self) -> bool:
        """Whether there are so many that trails are short and plain."""
        return len(self._entered) > CROWD


class Ways:
    """In place of trails: the whole ways of all robots, each (k, 2) in m."""

    crowded = False

    def __init__(self, projection: Projection, ways: Sequence[NDArray[np.float64]]) -> None:
        self._lines = [
            cv2.approxPolyDP(projection.fixed(way), SMOOTHING, False).reshape(-1, 2)
            for way in ways
            if len(way) > 1
        ]
        self._robots = [robot for robot, way in enumerate(ways) if len(way) > 1]

    def mark(self, poses: NDArray[np.float64]) -> None:
        """They are known already."""

    def lines(self) -> Iterator[tuple[int, list[NDArray[np.int32]]]]:
        """The ways in batches of one colour (0xRRGGBB): fixed-point pixels (k, 2)."""
        for index, color in enumerate(TINTS):
            lines = [
                way
                for robot, way in zip(self._robots, self._lines, strict=True)
                if robot % len(TINTS) == index
            ]
            if lines:
                yield mix(color, 0x000000, 0.15), lines


def draw_trails(image: NDArray[np.uint8], trails: Trails | Ways, line: int = 1) -> None:
    """Draws the trails, `line` pixels wide."""
    smooth = cv2.LINE_8 if trails.crowded else cv2.LINE_AA
    for color, lines in trails.lines():
        cv2.polylines(image, lines, False, bgr(color), line, smooth, SHIFT)
