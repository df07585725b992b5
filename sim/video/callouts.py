"""Where names and balloons go: beside their robots, not on each other and over nobody's body."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sim.video.snapshot import Snapshot
from sim.video.text import LONGEST, Box, Lettering, printable

MOST_NAMES = 64
"""Robots up to which names are written."""
SMALLEST_NAMED = 5.0
"""Pixels: smaller bodies are not named, except alone in a small company."""
SMALL_COMPANY = 12
MOST_BALLOONS = 24
"""Balloons in one frame; the latest are shown."""
CROWD, SHORT = 8, 20
"""With more robots than the first, what they say is cut to so many characters."""
NAME_ROWS = 0.8
"""A name's height in lines of text: what its ink takes."""
TOUCH = 0.15
"""Share of a name's height by which it may reach onto a body above or below it."""

Boxes = NDArray[np.float64]
"""(n, 4) left, top, right, bottom in pixels."""
Edges = tuple[float, ...]
"""The same of one box."""


@dataclass(frozen=True)
class Callout:
    """A text that belongs to a robot."""

    robot: int
    kind: Literal["name", "balloon"]
    text: str
    box: Box
    tip: tuple[float, float]
    """Where a balloon points (column, row)."""


def place_callouts(
    names: Sequence[str],
    said: Sequence[tuple[int, str]],
    bodies: Boxes,
    radii: Sequence[float],
    field: tuple[int, int],
    lettering: Lettering,
) -> list[Callout]:
    """The callouts that find a place in a field of (columns, rows); the others are left out.

    `names` by robot (empty: none), `said` as (robot, text), the more important last.
    """
    found: list[Callout] = []
    taken = Taken(bodies, 2 * (len(names) + 2 * len(said)))
    rows, unit = lettering.rows, lettering.unit
    height = round(NAME_ROWS * rows)
    for robot, name in enumerate(names):
        body: Edges = tuple(bodies[robot].tolist())
        if not name or not _inside(body, field):
            continue
        width = lettering.width(name) + 6
        for place in _around(body, width, height, unit):
            left, top, right, bottom = place
            core = left, top + TOUCH * height, right, bottom - TOUCH * height
            if _fits(place, field) and taken.free(place, core):
                taken.add(place)
                found.append(Callout(robot, "name", name, _pixels(place), (0.0, 0.0)))
                break
    for robot, words in reversed(said):
        body = tuple(bodies[robot].tolist())
        if not _inside(body, field):
            continue
        text = printable(words, SHORT if len(bodies) > CROWD else LONGEST)
        width = min(lettering.width(text) + round(14 * unit), field[0] - 6)
        for place in _over(body, width, rows + 2, unit, field):
            if not (_fits(place, field) and taken.free(place, place)):
                continue
            tip = _tip(body, radii[robot], place)
            stem = _stem(place, tip, 4 * unit)
            if taken.free(stem, stem, but=robot):
                taken.add(place, room=2 * unit)
                taken.add(stem)
                found.append(Callout(robot, "balloon", text, _pixels(place), tip))
                break
    return found


def speakers(snapshot: Snapshot, duration: float) -> list[tuple[int, str]]:
    """Who has said something within `duration` seconds, the latest at the end, and what."""
    since = snapshot.said_at or [snapshot.time] * len(snapshot.said)
    speaking = [
        (since[robot], robot, text)
        for robot, text in enumerate(snapshot.said)
        if text.strip() and snapshot.time - since[robot] < duration
    ]
    return [(robot, text) for _, robot, text in sorted(speaking)[-MOST_BALLOONS:]]


def named(names: Sequence[str], radii: Sequence[float]) -> list[str]:
    """The names to be written, "" for a robot that is too small for one."""
    count = len(names)
    if count > MOST_NAMES:
        return []
    return [
        name if radius >= SMALLEST_NAMED or count <= SMALL_COMPANY else ""
        for name, radius in zip(names, radii, strict=True)
    ]


class Taken:
    """What is covered already: bodies, and the texts beside them."""

    def __init__(self, bodies: Boxes, room: int) -> None:
        """`room`: boxes that may be added."""
        self._bodies = bodies
        self._texts = np.empty((room, 4))
        self._count = 0

    def add(self, box: Edges, room: float = 0.0) -> None:
        """Covers a box with text, and `room` pixels around it."""
        left, top, right, bottom = box
        self._texts[self._count] = left - room, top - room, right + room, bottom + room
        self._count += 1

    def free(self, box: Edges, core: Edges, but: int | None = None) -> bool:
        """Whether a box is off all texts and its core off all bodies, `but` one."""
        if _overlaps(self._texts[: self._count], box).any():
            return False
        met = _overlaps(self._bodies, core)
        return int(met.sum()) == (0 if but is None else int(met[but]))


def _overlaps(boxes: Boxes, box: Edges) -> NDArray[np.bool_]:
    """(n,) whether each of the boxes shares an area with `box`."""
    left, top, right, bottom = box
    shared: NDArray[np.bool_] = (
        (boxes[:, 0] < right) & (left < boxes[:, 2]) & (boxes[:, 1] < bottom) & (top < boxes[:, 3])
    )
    return shared


def _around(body: Edges, width: int, height: int, unit: float) -> Iterator[Edges]:
    """Places for a name: below, above, to the right and left of its body, and askew."""
    left, top, right, bottom = body
    x, y, gap = (left + right) / 2, (top + bottom) / 2, 2 * unit
    below, above = bottom + gap, top - gap - height
    for corner in (
        (x - width / 2, below),
        (x - width / 2, above),
        (right + gap, y - height / 2),
        (left - gap - width, y - height / 2),
        (right - 2 * gap, below),
        (left + 2 * gap - width, below),
        (right - 2 * gap, above),
        (left + 2 * gap - width, above),
    ):
        yield _box(*corner, width, height)


def _over(
    body: Edges, width: int, height: int, unit: float, field: tuple[int, int]
) -> Iterator[Edges]:
    """Places for a balloon within the field: over its body, higher up, beside it, below."""
    left, top, right, bottom = body
    x, y, gap = (left + right) / 2, (top + bottom) / 2, 7 * unit
    step = height + 3
    shifts = (x - width / 2, x - 0.15 * width, x - 0.85 * width)
    corners = [(shift, top - gap - height - rise * step) for rise in range(5) for shift in shifts]
    corners += [(right + gap, y - height / 2), (left - gap - width, y - height / 2)]
    corners += [(shift, bottom + gap + fall * step) for fall in range(4) for shift in shifts]
    for column, row in corners:
        yield _box(
            min(max(column, 3), max(field[0] - width - 3, 3)),
            min(max(row, 3), max(field[1] - height - 3, 3)),
            width,
            height,
        )


def _tip(body: Edges, radius: float, place: Edges) -> tuple[float, float]:
    """Where a balloon at a place points: within its body, on the balloon's side of it."""
    left, top, right, bottom = body
    x, y = (left + right) / 2, (top + bottom) / 2
    away_x, away_y = (a - b for a, b in zip(_nearest(place, (x, y)), (x, y), strict=True))
    reach = 0.75 * min(radius, (right - left) / 2, (bottom - top) / 2)
    part = reach / max(math.hypot(away_x, away_y), 1e-9)
    return x + away_x * part, y + away_y * part


def _stem(place: Edges, tip: tuple[float, float], half: float) -> Edges:
    """The box around the pointer from a balloon at a place to its tip."""
    (x, y), (u, v) = _nearest(place, tip), tip
    upright = abs(y - v) >= abs(x - u)
    across, along = (half, 0.0) if upright else (0.0, half)
    return min(x, u) - across, min(y, v) - along, max(x, u) + across, max(y, v) + along


def _nearest(place: Edges, point: tuple[float, float]) -> tuple[float, float]:
    """The point of a box that lies nearest to another point."""
    left, top, right, bottom = place
    return min(max(point[0], left), right), min(max(point[1], top), bottom)


def _box(column: float, row: float, width: int, height: int) -> Edges:
    left, top = round(column), round(row)
    return left, top, left + width, top + height


def _fits(place: Edges, field: tuple[int, int]) -> bool:
    """Whether a place lies inside the field."""
    return place[0] >= 0 and place[1] >= 0 and place[2] <= field[0] and place[3] <= field[1]


def _inside(body: Edges, field: tuple[int, int]) -> bool:
    """Whether a body's middle lies in the field."""
    return 0 <= body[0] + body[2] < 2 * field[0] and 0 <= body[1] + body[3] < 2 * field[1]


def _pixels(place: Edges) -> Box:
    left, top, right, bottom = (round(edge) for edge in place)
    return left, top, right - left, bottom - top
