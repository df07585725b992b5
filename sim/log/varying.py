"""Messages that not every row has, or not of one size: seconds, commands, velocities, blobs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.log.cdr import HEAD
from sim.log.commands import MODE, MOTORS, NUMBERS, WIDTH
from sim.log.compiled import compiled
from sim.log.memory import copy, get_float, get_long, put_byte, put_float, put_long, put_word
from sim.log.page import BEFORE, Page, put_note, put_prefix
from sim.log.tape import BLOB_SIZE, LENGTH, TELLING, TICK, TIME, TOLD, TOLD_AT

ENCODING = int.from_bytes(HEAD, "little")
START = BEFORE + len(HEAD)
"""Where the data of a message begin, from which CDR's alignment counts."""
SECOND = 10**9
NUMBER_COUNT = len(NUMBERS)
TWIST_SIZE, CLOCK_SIZE = len(HEAD) + 48, len(HEAD) + 8
COMMANDS_ALONE = START + 8 + 16 * (4 + NUMBER_COUNT)
"""At most, bytes of a message of commands without the commands."""
COMMAND_SIZE = 14 + 8 * NUMBER_COUNT
MOST_PADDING = 8
BLOB_WORDS = 9
"""uint32 that a blob begins with; its range follows."""


class Stretch(NamedTuple):
    """Rows that follow each other: the address of the first, and how many of what there are."""

    rows: int
    count: int
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


def write_commands(page: Page, part: Stretch, channel: int) -> None:
    """Add the commands of rows, as messages of the type CommandColumns."""
    size = part.seconds * COMMANDS_ALONE + part.commands * COMMAND_SIZE
    page.fill(size, part.seconds, commands_written, part.rows, part.count, channel)


@compiled
def commands_written(
    row: int, rows: int, channel: int, base: int, at: int, notes: int
) -> tuple[int, int]:
    number, size = 0, 0
    while rows > 0:
        second, first, count, some, time = get_long(row + TIME) // SECOND, row, 0, 0, 0
        while rows > 0 and get_long(row + TIME) // SECOND == second:
            if count == 0:
                time = get_long(row + TIME)
            count += get_long(row + TOLD)
            some += 1
            rows -= 1
            row += get_long(row + LENGTH)
        if count == 0:
            continue
        here = base + at + size
        end = _columns(here + START, first, some, count, time)
        put_prefix(here, len(HEAD) + end, channel, time)
        put_word(here + BEFORE, ENCODING)
        put_note(notes, number, time, at + size, channel)
        size += START + end
        number += 1
    return size, number


@compiled
def _columns(here: int, row: int, rows: int, count: int, time: int) -> int:
    """Write the data of a message of the commands of rows; how many bytes these are."""
    put_word(here, time // SECOND)
    put_word(here + 4, time % SECOND)
    put_word(here + 8, count)
    at, robots = 16, 16 + 8 * count
    put_word(here + robots, count)
    modes = robots + 4 + 4 * count
    put_word(here + modes, count)
    motors = (modes + 4 + count + 3) // 4 * 4
    put_word(here + motors, count)
    place = row
    k = 0
    for _ in range(rows):
        telling = place + get_long(place + TOLD_AT)
        for _ in range(get_long(place + TOLD)):
            put_long(here + at + 8 * k, get_long(place + TICK))
            put_word(here + robots + 4 + 4 * k, get_long(telling))
            put_byte(here + modes + 4 + k, int(get_float(telling + 8 * (1 + MODE))))
            put_byte(here + motors + 4 + k, int(get_float(telling + 8 * (1 + MOTORS))))
            telling += TELLING
            k += 1
        place += get_long(place + LENGTH)
    for k in range((modes + 4 + count), motors):
        put_byte(here + k, 0)
    end = motors + 4 + count
    for field in range(NUMBER_COUNT):
        end = _column(here, end, row, rows, count, field)
    return end


@compiled
def _column(here: int, end: int, row: int, rows: int, count: int, field: int) -> int:
    """Write one number of each command behind `end`; where that ends."""
    while end % 4:
        put_byte(here + end, 0)
        end += 1
    head, at = end, (end + 4 + 7) // 8 * 8
    for k in range(end + 4, at):
        put_byte(here + k, 0)
    some = False
    for _ in range(rows):
        telling = row + get_long(row + TOLD_AT)
        for _ in range(get_long(row + TOLD)):
            value = get_float(telling + 8 * (1 + field))
            # of the zeros -0.0 is none that could be left out
            some = some or get_long(telling + 8 * (1 + field)) != 0
            put_float(here + at, value)
            at += 8
            telling += TELLING
        row += get_long(row + LENGTH)
    put_word(here + head, count if some else 0)
    return at if some else head + 4


def write_clock(page: Page, part: Stretch, channel: int, second: int) -> int:
    """Add a rosgraph_msgs/Clock for each row that begins a second of simulated time.

    second: that of the row before the first one. Returns that of the last row.
    """
    size = BEFORE + CLOCK_SIZE
    most = min(part.count, part.last // SECOND - second)
    if most > 0:
        told = part.rows, part.count, channel, second
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


def commanded(part: Stretch, robots: int) -> NDArray[np.int64]:
    """The robots that have commands in rows, of so many."""
    flags = np.zeros(robots, np.bool_)
    mark_commanded(part.rows, part.count, flags)
    return np.flatnonzero(flags)


@compiled
def mark_commanded(row: int, rows: int, flags: NDArray[np.bool_]) -> None:
    for _ in range(rows):
        telling = row + get_long(row + TOLD_AT)
        for _ in range(get_long(row + TOLD)):
            flags[get_long(telling)] = True
            telling += TELLING
        row += get_long(row + LENGTH)


def write_twists(page: Page, part: Stretch, channels: NDArray[np.int64]) -> None:
    """Add a geometry_msgs/Twist for each command of rows, on the channel of its robot."""
    page.fill(
        part.commands * (BEFORE + TWIST_SIZE),
        part.commands,
        twists_written, part.rows, part.count, channels,
    )  # fmt: skip


@compiled
def twists_written(
    row: int, rows: int, channels: NDArray[np.int64], base: int, at: int, notes: int
) -> tuple[int, int]:
    number, size = 0, BEFORE + TWIST_SIZE
    for _ in range(rows):
        telling, time = row + get_long(row + TOLD_AT), get_long(row + TIME)
        for _ in range(get_long(row + TOLD)):
            here, channel = base + at + number * size, channels[get_long(telling)]
            put_prefix(here, TWIST_SIZE, channel, time)
            put_word(here + BEFORE, ENCODING)
            for k in range(6):
                put_float(here + START + 8 * k, 0.0)
            put_float(here + START, get_float(telling + 8))
            put_float(here + START + 8, get_float(telling + 16))
            put_float(here + START + 40, get_float(telling + 24))
            put_note(notes, number, time, at + number * size, channel)
            telling += TELLING
            number += 1
        row += get_long(row + LENGTH)
    return number * size, number


class Cameras(NamedTuple):
    """Cameras of equal settings: their channels, their frames, the size of their images."""

    channels: NDArray[np.int64]
    frames: NDArray[np.uint8]
    """(k, longest) each with a zero at its end."""
    lengths: NDArray[np.int64]
    """(k,) with the zero."""
    width: int
    height: int


def cameras(
    channels: Sequence[int], frames: Sequence[str], width: int, height: int
) -> Cameras:
    """Cameras with these channels and frames."""
    texts = [frame.encode() + b"\0" for frame in frames]
    longest = max(map(len, texts))
    padded = np.array([list(text.ljust(longest, b"\0")) for text in texts], np.uint8)
    lengths = np.array([len(text) for text in texts], np.int64)
    return Cameras(np.array(channels, np.int64), padded, lengths, width, height)


def write_blobs(page: Page, part: Stretch, seen_by: Cameras, at_row: int) -> None:
    """Add what cameras saw in rows; at_row: where a row tells it."""
    messages = part.count * len(seen_by.channels)
    alone = START + 24 + MOST_PADDING + seen_by.frames.shape[1]
    blobs = int(blobs_in(part.rows, part.count, len(seen_by.channels), at_row))
    page.fill(
        messages * alone + blobs * (BLOB_SIZE + 4),
        messages,
        blobs_written, part.rows, part.count, *seen_by, at_row,
    )  # fmt: skip


@compiled
def blobs_in(row: int, rows: int, cameras: int, at_row: int) -> int:
    count = 0
    for _ in range(rows):
        for k in range(cameras):
            count += get_long(row + at_row + 8 * k)
        row += get_long(row + LENGTH)
    return count


@compiled
def blobs_written(
    row: int,
    rows: int,
    channels: NDArray[np.int64],
    frames: NDArray[np.uint8],
    lengths: NDArray[np.int64],
    width: int,
    height: int,
    at_row: int,
    base: int,
    at: int,
    notes: int,
) -> tuple[int, int]:
    number, size = 0, 0
    for _ in range(rows):
        time = get_long(row + TIME)
        blob = row + get_long(row + at_row + 8 * len(channels))
        for k in range(len(channels)):
            here, count = base + at + size, get_long(row + at_row + 8 * k)
            data = here + START
            put_word(here + BEFORE, ENCODING)
            put_word(data, time // SECOND)
            put_word(data + 4, time % SECOND)
            put_word(data + 8, lengths[k])
            end = 12
            for j in range(lengths[k]):
                put_byte(data + end + j, frames[k, j])
            end += lengths[k]
            while end % 4:
                put_byte(data + end, 0)
                end += 1
            put_word(data + end, width)
            put_word(data + end + 4, height)
            put_word(data + end + 8, count)
            end += 12
            for _ in range(count):
                copy(data + end, blob, 4 * BLOB_WORDS)
                end += 4 * BLOB_WORDS
                if end % 8:
                    put_word(data + end, 0)
                    end += 4
                put_float(data + end, get_float(blob + 4 * BLOB_WORDS))
                end += 8
                blob += BLOB_SIZE
            put_prefix(here, len(HEAD) + end, channels[k], time)
            put_note(notes, number, time, at + size, channels[k])
            size += START + end
            number += 1
        row += get_long(row + LENGTH)
    return size, number
