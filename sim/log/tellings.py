"""The commands of rows as messages: those of a second together, and velocities one by one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.log.cdr import HEAD
from sim.log.commands import MODE, MOTORS, NUMBERS
from sim.log.compiled import compiled
from sim.log.memory import get_float, get_long, put_byte, put_float, put_long, put_word
from sim.log.page import BEFORE, Page, put_note, put_prefix
from sim.log.stretches import ENCODING, SECOND, START, Stretch
from sim.log.tape import LENGTH, TELLING, TICK, TIME, TOLD, TOLD_AT

NUMBER_COUNT = len(NUMBERS)
TWIST_SIZE = len(HEAD) + 48
COMMANDS_ALONE = START + 8 + 16 * (4 + NUMBER_COUNT)
"""At most, bytes of a message of commands without the commands."""
COMMAND_SIZE = 14 + 8 * NUMBER_COUNT


def write_commands(page: Page, part: Stretch, channel: int) -> None:
    """Add the commands of rows, as messages of the type CommandColumns."""
    size = part.seconds * COMMANDS_ALONE + part.commands * COMMAND_SIZE
    page.fill(size, part.seconds, commands_written, part.rows, part.ticks, channel)


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
    put_word(here + 12, 0)
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


def commanded(part: Stretch, robots: int) -> NDArray[np.int64]:
    """The robots that have commands in rows, of so many."""
    flags = np.zeros(robots, np.bool_)
    mark_commanded(part.rows, part.ticks, flags)
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
        twists_written, part.rows, part.ticks, channels,
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
