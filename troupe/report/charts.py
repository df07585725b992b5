"""Charts as SVG, written by hand: curves, points, and a time line of what happened to whom."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from player.printable import printable
from sim.video.palette import TINTS, mix

Floats = NDArray[np.float64]

WIDTH, HEIGHT = 640, 220
LEFT, RIGHT, TOP, BOTTOM = 56, 14, 12, 40
LEGEND = 18
INK, SOFT, GRID = "#26292e", "#5d6066", "#e6e4de"
SIGNS = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;"}


@dataclass(frozen=True)
class Series:
    """A curve, or points: x (k,), y (k,); a NaN breaks the curve."""

    label: str
    color: str
    x: Floats
    y: Floats
    points: bool = False
    width: float = 1.5
    opacity: float = 1.0


@dataclass(frozen=True)
class Band:
    """What lies between two curves."""

    color: str
    x: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True)
class Axes:
    """What the edges of a chart's field stand for."""

    low: float
    high: float
    bottom: float
    top: float
    head: float
    """Pixels above the field."""

    def columns(self, x: Any) -> Any:
        """Where values are across the picture."""
        return LEFT + (WIDTH - RIGHT - LEFT) * (x - self.low) / (self.high - self.low)

    def rows(self, y: Any) -> Any:
        """Where values are down the picture."""
        floor = HEIGHT - BOTTOM
        return floor - (floor - self.head) * (y - self.bottom) / (self.top - self.bottom)

    def places(self, x: Floats, y: Floats) -> Floats:
        """(k, 2) in the picture."""
        return np.stack([self.columns(x), self.rows(y)], axis=1)


def color_of(robot: int) -> str:
    """A robot's colour on paper: its tint, a little darker."""
    return f"#{mix(TINTS[robot % len(TINTS)], 0x000000, 0.12):06x}"


def escaped(text: object) -> str:
    """Text as XML takes it, with control characters written out."""
    return "".join(SIGNS.get(sign, sign) for sign in printable(str(text)))


def chart(
    series: Sequence[Series],
    title: str,
    x_label: str,
    y_label: str,
    *,
    bands: Sequence[Band] = (),
    x_range: tuple[float, float] | None = None,
    y_top: float | None = None,
    whole: bool = False,
) -> str:
    """Curves and points over common axes from 0 upwards, with a legend if there are labels.

    `whole`: only whole numbers stand at the axis below.
    """
    xs = np.concatenate([np.zeros(0), *(one.x for one in series)])
    ys = np.concatenate([np.zeros(0), *(one.y for one in series), *(one.high for one in bands)])
    xs, ys = xs[np.isfinite(xs)], ys[np.isfinite(ys)]
    low, high = x_range or (float(xs.min(initial=0.0)), float(xs.max(initial=1.0)))
    bottom = float(ys.min(initial=0.0))
    top = float(ys.max(initial=0.0)) if y_top is None else y_top
    if top <= bottom:
        top = bottom + 1.0
    if high <= low:
        high = low + 1.0
    elif x_range is None and any(one.points for one in series):
        high += 0.02 * (high - low)  # no point is cut by the edge
    top = bottom + 1.04 * (top - bottom) if y_top is None else top
    labelled = [one for one in series if one.label]
    head = TOP + LEGEND * (len(labelled) > 1)
    axes = Axes(low, high, bottom, top, head)
    right, floor = WIDTH - RIGHT, HEIGHT - BOTTOM
    parts = []
    for value in nice(bottom, top, 5):
        y = float(axes.rows(value))
        parts.append(line(LEFT, y, right, y, GRID))
        parts.append(text(LEFT - 6, y + 4, number(value), anchor="end"))
    for value in nice(low, high, 8, whole=whole):
        x = float(axes.columns(value))
        parts.append(line(x, floor, x, floor + 4, SOFT))
        parts.append(text(x, floor + 17, number(value), anchor="middle"))
    parts.append(line(LEFT, floor, right, floor, SOFT))
    parts.append(text((LEFT + right) / 2, HEIGHT - 6, x_label, anchor="middle", soft=False))
    middle = (head + floor) / 2
    turned = f'transform="rotate(-90 13 {middle:.1f})"'
    parts.append(text(13, middle, y_label, anchor="middle", soft=False, more=turned))
    for band in bands:
        known = np.isfinite(band.low) & np.isfinite(band.high)
        upper = axes.places(band.x[known], band.high[known])
        lower = axes.places(band.x[known], band.low[known])
        outline = np.concatenate([upper, lower[::-1]])
        if len(outline):
            parts.append(f'<path d="M{path(outline)}z" fill="{band.color}" fill-opacity="0.2"/>')
    for one in series:
        parts.append(marks(one, axes) if one.points else curve(one, axes))
    beside = LEFT + 8.0
    for one in labelled if len(labelled) > 1 else ():
        parts.append(line(beside, TOP + 5, beside + 16, TOP + 5, one.color, 3.0))
        parts.append(text(beside + 20, TOP + 9, one.label))
        beside += 34 + 6.2 * len(printable(one.label))
    return document(title, parts, HEIGHT)


def curve(one: Series, axes: Axes) -> str:
    """A curve, broken where it is not known."""
    known = np.isfinite(one.y)
    edges = np.flatnonzero(np.diff(np.r_[False, known, False]))
    stretches = [
        axes.places(one.x[a:b], one.y[a:b]) for a, b in zip(edges[::2], edges[1::2], strict=True)
    ]
    data = "".join(f"M{path(points)}" for points in stretches)
    pale = "" if one.opacity == 1 else f' stroke-opacity="{one.opacity:g}"'
    return (
        f'<path d="{data}" fill="none" stroke="{one.color}" stroke-width="{one.width:g}"'
        f'{pale} stroke-linejoin="round"><title>{escaped(one.label)}</title></path>'
    )


def marks(one: Series, axes: Axes) -> str:
    """Points."""
    known = np.isfinite(one.x) & np.isfinite(one.y)
    places = axes.places(one.x[known], one.y[known])
    data = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in places.tolist())
    return (
        f'<path d="{data}" stroke="{one.color}" stroke-width="{5 * one.width / 1.5:g}" '
        f'stroke-opacity="{one.opacity:g}" stroke-linecap="round" fill="none"/>'
    )


@dataclass(frozen=True)
class Mark:
    """Something that happened to the robot of a row; `kind`: said, touch or end."""

    time: float
    row: int
    kind: str
    text: str


ROW = 16


def time_line(names: Sequence[str], happened: Iterable[Mark], until: float, title: str) -> str:
    """A row for each robot, with marks where something happened; each tells what."""
    left = 20 + 6.2 * max((len(printable(name)[:24]) for name in names), default=0)
    right, floor = WIDTH - RIGHT, TOP + ROW * len(names)
    until = until or 1.0

    def column(time: float) -> float:
        return left + (right - left) * time / until

    parts = []
    for k, name in enumerate(names):
        y = TOP + ROW * (k + 0.5)
        parts.append(line(left, y, right, y, GRID))
        parts.append(text(left - 8, y + 4, printable(name)[:24], anchor="end"))
    for one in happened:
        x, y = column(one.time), TOP + ROW * (one.row + 0.5)
        told = f"<title>{escaped(f'{one.time:.1f} s: {one.text}')}</title>"
        if one.kind == "said":
            shape = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3.5" fill="{color_of(one.row)}">'
            parts.append(f"{shape}{told}</circle>")
        elif one.kind == "touch":
            shape = f'<path d="M{x:.1f} {y - 6:.1f}v12" stroke="#d55e00" stroke-width="2">'
            parts.append(f"{shape}{told}</path>")
        else:
            shape = f'<path d="M{x - 4:.1f} {y - 4:.1f}h8l-4 7z" fill="{INK}">'
            parts.append(f"{shape}{told}</path>")
    for value in nice(0.0, until, 8):
        x = column(value)
        parts.append(line(x, floor, x, floor + 4, SOFT))
        parts.append(text(x, floor + 17, number(value), anchor="middle"))
    parts.append(line(left, floor, right, floor, SOFT))
    parts.append(text((left + right) / 2, floor + 34, "time, s", anchor="middle", soft=False))
    return document(title, parts, floor + BOTTOM)


# -- parts


def document(title: str, parts: Iterable[str], height: float) -> str:
    """The SVG of a chart."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:g}" '
        f'width="{WIDTH}" height="{height:g}" role="img" '
        'font-family="Helvetica, Arial, sans-serif" font-size="12">'
        f"<title>{escaped(title)}</title>" + "".join(parts) + "</svg>"
    )


def line(x0: float, y0: float, x1: float, y1: float, color: str, width: float = 1.0) -> str:
    return (
        f'<path d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" stroke="{color}" '
        f'stroke-width="{width:g}"/>'
    )


def text(
    x: float, y: float, words: str, *, anchor: str = "start", soft: bool = True, more: str = ""
) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{SOFT if soft else INK}" '
        f"{more}>{escaped(words)}</text>"
    )


def path(points: Floats) -> str:
    """Points (k, 2) as SVG's path data."""
    return "L".join(f"{x:.1f} {y:.1f}" for x, y in points.tolist())


def number(value: float) -> str:
    """A number at an axis."""
    return f"{value:.6g}"


def nice(low: float, high: float, most: int, *, whole: bool = False) -> list[float]:
    """Round numbers from low to high, `most` of them or fewer."""
    span = high - low
    if not (math.isfinite(span) and span > 0):
        return [low]
    least = span / most
    power = 10.0 ** math.floor(math.log10(least))
    step = next(k * power for k in (1, 2, 5, 10) if k * power >= least * (1 - 1e-9))
    if whole:
        step = max(1.0, step)
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, math.floor(high / step + 1e-9) + 1)]
