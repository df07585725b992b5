"""Messages of one fixed size, pasted together from the rows of a tape, many in one call."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log.compiled import compiled
from sim.log.layouts import Layout
from sim.log.memory import (
    address_of,
    copy,
    get_float,
    get_long,
    put_float,
    put_long,
    put_short,
    put_single,
    put_word,
)
from sim.log.page import BEFORE, CHANNEL_AT, TIME_AT, Page, put_note, put_prefix
from sim.log.tape import LENGTH, TICK, TIME

TEXT, BYTES, SECONDS, NANOSECONDS, FLOATS, ROUNDED, SIN, COS, SINGLES, WORDS = range(10)
"""What is pasted: a text of each member's own; bytes of the row; its time, as seconds and the rest
of it; float64 as they are, or rounded; sine and cosine of half of an angle, rounded; float64 that
is rounded and made float32; int64 made uint32. What is rounded becomes a multiple of 1 / steps;
with steps 0 it is not."""
PASTING = 8


class Form:
    """How a row becomes messages: one for each member, on a channel of its own.

    members: their numbers, by which their values stand in the row; 0, 1, ... unless given.
    """

    def __init__(
        self, layout: Layout, channels: Sequence[int], members: Sequence[int] | None = None
    ) -> None:
        self.layout = layout
        self.channels = np.array(channels, np.int64)
        self.members = np.array(range(len(channels)) if members is None else members, np.int64)
        self.record = BEFORE + layout.size
        self.template = np.zeros(self.record, np.uint8)
        put_prefix(address_of(self.template), layout.size, 0, 0)
        self.template[BEFORE:] = layout.message
        self._pastings: list[list[int]] = []
        self._texts: list[NDArray[np.uint8]] = []
        self._plan: tuple[Any, ...] | None = None

    def paste(
        self, action: int, path: str, at: int, *, step: int = 8, stride: int = 0, steps: float = 0.0
    ) -> Form:
        """Fill a field from what stands at an offset of the row.

        step: bytes from one of the field's values to the next; stride: from one member's to the
        next one's. BYTES: `step` is the size of a value, and of as many bytes as the field has.
        """
        place = self.layout.places.get(path)
        if place is None:  # an array without elements
            return self
        for first, number, to, apart in place.pieces:
            from_ = at + first * step
            if action == BYTES:
                if apart != step and number > 1:
                    raise ValueError(f"{path}: its bytes do not stand together")
                number *= step  # noqa: PLW2901 - of bytes
            self._pastings.append(
                [action, from_, stride, step, BEFORE + to, apart, number, int(steps)]
            )
        return self

    def stamp(self, path: str) -> Form:
        """Fill a field that is a time."""
        self.paste(SECONDS, f"{path}.sec", 0, step=0)
        return self.paste(NANOSECONDS, f"{path}.nanosec", 0, step=0)

    def own(self) -> Form:
        """Fill what all of our own types have: when it was, and in which tick."""
        return self.stamp("stamp").paste(BYTES, "tick", TICK)

    def text(self, path: str, texts: NDArray[np.uint8]) -> Form:
        """Give each member its own text: (members, length) bytes."""
        self._texts.append(np.ascontiguousarray(texts))
        width = texts.shape[1]
        return self.paste(TEXT, path, address_of(self._texts[-1]), step=1, stride=width)

    def write(self, page: Page, rows: int, count: int) -> None:
        """Add the messages of `count` rows, whose first is at the address `rows`, to a page."""
        if self._plan is None:
            pastings = np.array(self._pastings, np.int64).reshape(-1, PASTING)
            self._plan = (
                self.template, self.channels, self.members, gaps(self.record, pastings), pastings,
            )  # fmt: skip
        messages = count * len(self.channels)
        page.fill(messages * self.record, messages, pasted, *self._plan, rows, count)


def gaps(size: int, pastings: NDArray[np.int64]) -> NDArray[np.int64]:
    """(g, 2) the parts of a record that are the template's: from and to."""
    long = [
        (to, to + number)
        for action, _, _, _, to, _, number, _ in pastings.tolist()
        if action == BYTES and number >= 64
    ]
    found, at = [], 0
    for start, end in sorted(long):
        found.append((at, start))
        at = end
    return np.array([*found, (at, size)], np.int64)


@compiled
def pasted(
    template: NDArray[np.uint8],
    channels: NDArray[np.int64],
    members: NDArray[np.int64],
    gaps: NDArray[np.int64],
    pastings: NDArray[np.int64],
    row: int,
    rows: int,
    base: int,
    at: int,
    notes: int,
) -> tuple[int, int]:
    """Write the records of rows to `base` + `at`; how many bytes and messages these are."""
    size, like = len(template), template.ctypes.data
    for tick in range(rows):
        time = get_long(row + TIME)
        seconds, rest = time // 1000000000, time % 1000000000
        for member in range(len(channels)):
            number = member * rows + tick  # a channel's messages stand together: they are alike
            here = base + at + number * size
            for g in range(len(gaps)):
                copy(here + gaps[g, 0], like + gaps[g, 0], gaps[g, 1] - gaps[g, 0])
            put_short(here + CHANNEL_AT, channels[member])
            put_long(here + TIME_AT, time)
            put_long(here + TIME_AT + 8, time)
            for p in range(len(pastings)):
                action, step = pastings[p, 0], pastings[p, 3]
                to, apart, count = here + pastings[p, 4], pastings[p, 5], pastings[p, 6]
                steps = np.float64(pastings[p, 7])
                if action == TEXT:
                    copy(to, pastings[p, 1] + pastings[p, 2] * member, count)
                    continue
                source = row + pastings[p, 1] + pastings[p, 2] * members[member]
                if action == BYTES:
                    copy(to, source, count)
                elif action == SECONDS:
                    for k in range(count):
                        put_word(to + k * apart, seconds)
                elif action == NANOSECONDS:
                    for k in range(count):
                        put_word(to + k * apart, rest)
                elif action == WORDS:
                    for k in range(count):
                        put_word(to + k * apart, get_long(source + k * step))
                elif action == SINGLES:
                    for k in range(count):
                        value = _rounded(get_float(source + k * step), steps)
                        put_single(to + k * apart, np.float32(value))
                else:
                    for k in range(count):
                        value = get_float(source + k * step)
                        if action == SIN:
                            value = np.sin(0.5 * value)
                        elif action == COS:
                            value = np.cos(0.5 * value)
                        put_float(to + k * apart, _rounded(value, steps))
            put_note(notes, number, time, at + number * size, channels[member])
        row += get_long(row + LENGTH)
    count = rows * len(channels)
    return count * size, count


@compiled
def _rounded(value: float, steps: float) -> float:
    """The nearest multiple of 1 / steps; -0.0, which is one with other bits, becomes 0.0."""
    return np.rint(value * steps) / steps + 0.0 if steps > 0.0 else value
