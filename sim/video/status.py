"""The status line: simulated time, coverage, the film's speed, robots, title and scale bar."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import INK, OUTSIDE, SOFT_INK, STRIP, bgr, mix
from sim.video.snapshot import Snapshot
from sim.video.text import Lettering, printable

GAP = 18
"""Units between two entries."""
MARGIN = 10
"""Units at both ends."""
BASELINE = 17
NARROW = 240
"""Pixels of width below which there is no scale bar."""
BAR = 46.0
"""The scale bar is the first of BAR_METRES at least so many units long."""
BAR_METRES = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)


@dataclass(frozen=True)
class Bar:
    """A scale bar: its ends and its height in the strip in pixels, and what it says where."""

    left: int
    right: int
    y: int
    label: str
    start: int


class StatusLine:
    """Knows which part of the line never changes and how much room is left for the rest."""

    def __init__(
        self,
        size: tuple[int, int],
        title: str,
        scale: float | None,
        lettering: Lettering,
        film_speed: float | None = None,
    ) -> None:
        """`size`: columns and rows; `scale` in pixels per metre, None: no bar."""
        self._lettering = lettering
        self._film_speed = film_speed
        self._rows = size[1]
        self.baseline = round(BASELINE * lettering.unit)
        self.margin, self.gap = round(MARGIN * lettering.unit), round(GAP * lettering.unit)
        self.bar = None if scale is None or size[0] < NARROW else self._bar(size, scale)
        self._end = size[0] if self.bar is None else min(self.bar.left, self.bar.start)
        self.title: tuple[str, int] | None = None
        """The title and the column where it begins; None where there is no room for it."""
        text = printable(title)
        width = lettering.width(text)
        end = self._end - (self.margin if self.bar is None else self.gap)
        if text and self.margin + self._longest() + width <= end:
            self._end = end - width
            self.title = text, self._end

    def entries(self, snapshot: Snapshot, robots: int) -> list[tuple[str, int, int]]:
        """The changing entries: text, column, ink. As many as there is room for."""
        placed: list[tuple[str, int, int]] = []
        x = self.margin
        for number, (text, longest) in enumerate(
            status_entries(snapshot, robots, self._film_speed)
        ):
            width = max(self._lettering.width(longest), self._lettering.width(text))
            if number and x + width + self.gap > self._end:
                break
            placed.append((text, x, SOFT_INK if number else INK))
            x += width + self.gap
        return placed

    def draw_still(self, strip: NDArray[np.uint8]) -> None:
        """Draws what never changes into `strip` (rows, width, 3)."""
        strip[:] = bgr(STRIP)
        strip[0] = bgr(mix(OUTSIDE, INK, 0.15))
        if self.title is not None:
            self._lettering.draw(strip, self.title[0], (self.title[1], self.baseline), SOFT_INK)
        if self.bar is None:
            return
        bar, unit = self.bar, self._lettering.unit
        line, tick = max(1, round(unit - 0.3)), round(3 * unit)
        cv2.line(strip, (bar.left, bar.y), (bar.right, bar.y), bgr(SOFT_INK), line)
        for x in (bar.left, bar.right):
            cv2.line(strip, (x, bar.y - tick), (x, bar.y), bgr(SOFT_INK), line)
        above = strip[: bar.y - tick]
        self._lettering.draw(above, bar.label, (bar.start, bar.y - round(4 * unit)), SOFT_INK)

    def draw(self, strip: NDArray[np.uint8], snapshot: Snapshot, robots: int) -> None:
        """Writes the entries of a snapshot onto a copy of the still part."""
        for text, x, ink in self.entries(snapshot, robots):
            self._lettering.draw(strip, text, (x, self.baseline), ink)

    def _longest(self) -> int:
        """Pixels that the changing entries take where all are there."""
        snapshot = Snapshot(time=0, poses=np.empty((0, 3)), colors=(), coverage=1)
        entries = status_entries(snapshot, 0, self._film_speed)
        return sum(self._lettering.width(longest) + self.gap for _, longest in entries)

    def _bar(self, size: tuple[int, int], scale: float) -> Bar:
        least = BAR * self._lettering.unit
        metres = next((m for m in BAR_METRES if m * scale >= least), BAR_METRES[-1])
        length, label = round(metres * scale), f"{metres:g} m"
        right = size[0] - self.margin
        left = right - length
        start = left + (length - self._lettering.width(label)) // 2
        return Bar(left, right, size[1] - round(7 * self._lettering.unit), label, start)


def status_entries(
    snapshot: Snapshot, robots: int, film_speed: float | None = None
) -> list[tuple[str, str]]:
    """The entries from left to right, each with a text as long as it usually becomes."""
    entries = [(f"{snapshot.time:.1f} s", "0000.0 s")]
    if snapshot.coverage is not None:
        entries.append((f"painted {100 * snapshot.coverage:.1f} %", "painted 100.0 %"))
    if film_speed is not None:
        speed = f"film: {film_speed:g} x"
        entries.append((speed, speed))
    entries.append((f"{robots} robot{'' if robots == 1 else 's'}", "0000 robots"))
    return entries
