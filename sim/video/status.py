"""The status line: simulated time, speed-up, coverage, number of robots, title and scale bar."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import INK, OUTSIDE, SOFT_INK, STRIP, bgr, mix
from sim.video.text import draw_text, printable, text_width
from sim.video.view import FrameView

GAP = 18
"""Pixels between two entries."""
MARGIN = 10
"""Pixels at both ends."""
BASELINE = 17
NARROW = 240
"""Pixels of width below which there is no scale bar."""
BAR_PIXELS = 46.0
"""The scale bar is the first of BAR_METRES at least this long."""
BAR_METRES = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)


class StatusLine:
    """Knows which part of the line never changes and how much room is left for the rest."""

    def __init__(self, strip: NDArray[np.uint8], title: str, scale: float) -> None:
        """Draws the still part into `strip` (rows, width, 3); `scale` in pixels per metre."""
        strip[:] = bgr(STRIP)
        strip[0] = bgr(mix(OUTSIDE, INK, 0.15))
        wide = strip.shape[1] >= NARROW
        self._end = _draw_bar(strip, scale) if wide else strip.shape[1]
        text = printable(title)
        if text and MARGIN + _longest_line() + text_width(text) + GAP <= self._end:
            self._end -= GAP + text_width(text)
            draw_text(strip, text, (self._end, BASELINE), SOFT_INK)

    def draw(self, strip: NDArray[np.uint8], view: FrameView, robots: int) -> None:
        """Writes the entries of a view onto a copy of the still part, as many as there is room."""
        x = MARGIN
        for number, (text, longest) in enumerate(status_entries(view, robots)):
            width = max(text_width(longest), text_width(text))
            if number and x + width + GAP > self._end:
                break
            draw_text(strip, text, (x, BASELINE), SOFT_INK if number else INK)
            x += width + GAP


def status_entries(view: FrameView, robots: int) -> list[tuple[str, str]]:
    """The entries from left to right, each with a text as long as it usually becomes."""
    entries = [(f"{view.time:.1f} s", "0000.0 s")]
    if view.coverage is not None:
        entries.append((f"painted {100 * view.coverage:.1f} %", "painted 100.0 %"))
    if view.speed is not None:
        digits = 0 if view.speed >= 10 else 1
        entries.append((f"{view.speed:.{digits}f} x real time", "0000 x real time"))
    entries.append((f"{robots} robot{'' if robots == 1 else 's'}", "0000 robots"))
    return entries


def _longest_line() -> int:
    """Pixels that the changing entries take where all are there."""
    view = FrameView(time=0, poses=np.empty((0, 3)), colors=(), speed=1000, coverage=1)
    return sum(text_width(longest) + GAP for _, longest in status_entries(view, 0))


def _draw_bar(strip: NDArray[np.uint8], scale: float) -> int:
    """Draws the scale bar at the right end; returns the column where it starts."""
    metres = next((m for m in BAR_METRES if m * scale >= BAR_PIXELS), BAR_METRES[-1])
    bar, label = round(metres * scale), f"{metres:g} m"
    right = strip.shape[1] - MARGIN
    left = right - bar
    y = strip.shape[0] - 8
    cv2.line(strip, (left, y), (right, y), bgr(SOFT_INK), 1)
    for x in (left, right):
        cv2.line(strip, (x, y - 3), (x, y), bgr(SOFT_INK), 1)
    start = left + (bar - text_width(label)) // 2
    draw_text(strip[1 : y - 3], label, (start, y - 5), SOFT_INK)
    return int(min(left, start))
