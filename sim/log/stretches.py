"""Rows of a tape that follow each other: what there is in them; and the seconds that they begin."""

from __future__ import annotations

from typing import NamedTuple

from sim.log.cdr import HEAD
from sim.log.compiled import compiled
from sim.log.memory import get_long, put_word
from sim.log.page import BEFORE, Page, put_note, put_prefix
from sim.log.tape import LENGTH, TIME, TOLD

ENCODING = int.from_bytes(HEAD, "little")
START = BEFORE + len(HEAD)
"""Where the data of a message begin, from which CDR's alignment counts."""
SECOND = 10**9
CLOCK_SIZE = len(HEAD) + 8


class Stretch(NamedTuple):
    """Rows that follow each other: the address of the first, and how many of what there are."""

    rows: int
    ticks: int
    commands: int
    seconds: int
    """In how many seconds of simulated time there are commands."""
    last: int
    """The simulated time of the last row, ns."""


def stretch(base: int, start: int, end: int) -> Stretch:
    """The rows from an offset of a tape to another."""
    return Stretch(base + start, *surveyed(base + start, base + end))


@compiled
def surveyed(row: int, end: int) -> tuple[int, int, int, int]:
    count, told, seconds, last, second = 0, 0, 0, 0, -1
    while row < end:
        count += 1
        last = get_long(row + TIME)
        if get_long(row + TOLD) > 0:
            told += get_long(row + TOLD)
            if last // SECOND != second:
                second = last // SECOND
                seconds += 1
        row += get_long(row + LENGTH)
    return count, told, seconds, last


def write_clock(page: Page, part: Stretch, channel: int, second: int) -> int:
    """Add a rosgraph_msgs/Clock for each row that begins a second of simulated time.

    second: that of the row before the first one. Returns that of the last row.
    """
    size = BEFORE + CLOCK_SIZE
    most = min(part.ticks, part.last // SECOND - second)
    if most > 0:
        told = part.rows, part.ticks, channel, second
        page.fill(most * size, most, clock_written, *told)
    return part.last // SECOND


@compiled
def clock_written(
    row: int, rows: int, channel: int, second: int, base: int, at: int, notes: int
) -> tuple[int, int]:
    number, size = 0, BEFORE + CLOCK_SIZE
    for _ in range(rows):
        time = get_long(row + TIME)
        if time // SECOND != second:
            second = time // SECOND
            here = base + at + number * size
            put_prefix(here, CLOCK_SIZE, channel, time)
            put_word(here + BEFORE, ENCODING)
            put_word(here + START, second)
            put_word(here + START + 4, time % SECOND)
            put_note(notes, number, time, at + number * size, channel)
            number += 1
        row += get_long(row + LENGTH)
    return number * size, number
