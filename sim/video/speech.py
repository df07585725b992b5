"""What robots say, in balloons that stand for a while and go away again."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.video.palette import INK, mix, tint
from sim.video.text import Box, balloon_box, draw_balloon, printable
from sim.video.view import FrameView

MOST = 24
"""Balloons in one frame; the latest are shown."""


class Speech:
    """Remembers since when each robot has been saying what it says."""

    def __init__(self, duration: float) -> None:
        """A text shows for `duration` simulated seconds, or until the next one."""
        self._duration = duration
        self._said: list[str] = []
        self._since: list[float] = []
        self._latest = -np.inf  # when anybody last said anything new

    def draw(
        self,
        image: NDArray[np.uint8],
        view: FrameView,
        centres: NDArray[np.float64],
        radii: list[float],
    ) -> None:
        """Draws the balloons of a view over robots at `centres` (n, 2) with `radii`, pixels."""
        taken: list[Box] = []
        for robot in self._speakers(view):
            x, y = centres[robot]
            if 0 <= x < image.shape[1] and 0 <= y < image.shape[0]:
                tip = (float(x), float(y) - 0.75 * radii[robot])
                edge = mix(tint(robot), INK, 0.35)
                text = printable(self._said[robot])
                box = balloon_box(text, tip, (image.shape[1], image.shape[0]), taken)
                taken.append(box)
                draw_balloon(image, text, tip, box, edge)

    def _speakers(self, view: FrameView) -> list[int]:
        """The robots whose balloons stand at a view's time, those that spoke last at the end."""
        if list(view.said) != self._said:
            for robot, text in enumerate(view.said):
                if robot == len(self._said):
                    self._said.append("")
                    self._since.append(view.time)
                if text != self._said[robot]:
                    self._said[robot], self._since[robot] = text, view.time
                    self._latest = view.time
        if view.time - self._latest >= self._duration:
            return []
        speakers = [
            robot
            for robot, text in enumerate(self._said)
            if text.strip() and view.time - self._since[robot] < self._duration
        ]
        speakers.sort(key=lambda robot: (self._since[robot], robot))
        return speakers[-MOST:]
