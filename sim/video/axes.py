"""Axes in metres along the lower and the left edge of a picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from sim.video.palette import PAPER, SOFT_INK, bgr
from sim.video.projection import Projection
from sim.video.text import Lettering

STEPS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
"""Metres between ticks, the first that leaves SPACE units between them."""
SPACE = 52.0
TICK = 4.0
"""Units of a tick's length."""


@dataclass(frozen=True)
class Tick:
    """A tick at a pixel position along its axis, with its text and that text's origin."""

    axis: Literal["x", "y"]
    at: float
    text: str
    origin: tuple[int, int]
    """(column, row) of the left end of the baseline."""


def edges_of(projection: Projection) -> tuple[float, float]:
    """The column of the y axis and the row of the x axis: the edges of what is shown."""
    left, bottom, _, _ = projection.extent
    x, y = projection.edges(np.array([left, bottom]))
    return float(x), float(y)


def ticks(size: tuple[float, float], projection: Projection, lettering: Lettering) -> list[Tick]:
    """The ticks of both axes of a world of `size` metres; the last number has the unit."""
    space = SPACE * projection.unit
    step = next((s for s in STEPS if s * projection.scale >= space), STEPS[-1])
    column, row = edges_of(projection)
    reach = round((TICK + 2) * projection.unit)
    found: list[Tick] = []
    for axis, low, length in zip("xy", projection.low, size, strict=True):
        first, last = math.ceil(low / step - 1e-9), math.floor((low + length) / step + 1e-9)
        for k in range(first, last + 1):
            value = k * step
            text = f"{value:g} m" if k == last else f"{value:g}"
            width = lettering.width(text)
            if axis == "x":
                at = projection.left + value * projection.scale
                number = lettering.width(f"{value:g}")
                origin = round(at - number / 2), round(row + reach + lettering.ascent)
                found.append(Tick("x", at, text, origin))
            else:
                at = projection.bottom - value * projection.scale
                origin = round(column - reach - width), round(at + lettering.ascent * 0.4)
                found.append(Tick("y", at, text, origin))
    return found


def draw_axes(
    image: NDArray[np.uint8],
    size: tuple[float, float],
    projection: Projection,
    lettering: Lettering,
) -> None:
    """Draws the axes on what is PAPER so far."""
    column, row = (round(edge) for edge in edges_of(projection))
    tick, line = round(TICK * projection.unit), projection.units(1)
    ink = bgr(SOFT_INK)
    for each in ticks(size, projection, lettering):
        at = round(each.at)
        if each.axis == "x":
            cv2.line(image, (at, row), (at, row + tick), ink, line)
        else:
            cv2.line(image, (column - tick, at), (column, at), ink, line)
        lettering.draw(image, each.text, each.origin, SOFT_INK, PAPER)
