"""The states of many ticks, one after the other in memory: the run notes them, a thread reads them.

A row holds a tick. It begins with HEAD; then come arrays, each at the same offset in every row;
then what is of another length in each: commands where they have changed, and blobs. All of a tick
is copied in one compiled call, from where the arrays lie, which does not change until robots come
or other sensors are read.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sensors.readings import BLOB
from sim.log import commands
from sim.log.compiled import compiled, quick
from sim.log.memory import (
    address_of,
    copy,
    get_byte,
    get_float,
    get_int,
    get_long,
    put_float,
    put_long,
    put_single,
)
from sim.log.moment import Read
from sim.stage.records import MOVER

LENGTH, TICK, TIME, COVERAGE, TOLD, TOLD_AT, HEAD = range(0, 56, 8)
"""What a row begins with: its bytes; the tick; its simulated time, ns; the painted share of the
floor; how many commands it has, and where in it they stand."""
TELLING = 8 * (1 + commands.WIDTH)
"""Bytes of a command: whose it is (int64), and its numbers."""
COPY, NARROW, BLOBS, WATCH = range(4)
"""What is done with a source: its bytes are copied; its float64 made float32; of BLOBS (most, n)
as many of each column are copied as there are; it is not noted, but compared with what it was."""
SOURCE = 7
"""Numbers that tell of a source: see `Source.numbers`."""
FIELDS, SOURCES = 6, 6 + commands.WIDTH
"""Where these begin in a plan: the places of a command's numbers in MOVER, and the sources."""
BLOB_SIZE = BLOB.itemsize
OFFSETS = {name: int(place[1]) for name, place in (MOVER.fields or {}).items()}


class Source(NamedTuple):
    """An array that is part of every row, or some rows of it (of BLOBS: columns)."""

    name: object
    array: NDArray[Any]
    action: int = COPY
    rows: NDArray[np.int64] | None = None
    """(k,) those that are noted; None: all."""
    other: NDArray[Any] | None = None
    """Of BLOBS: how many each robot has, int64. Of WATCH: what was seen last; it is written."""

    @property
    def number(self) -> int:
        """k"""
        if self.rows is not None:
            return len(self.rows)
        return len(self.array) if self.action != BLOBS else self.array.shape[1]

    @property
    def width(self) -> int:
        """Bytes of a row of the array."""
        return int(self.array.nbytes if self.action == WATCH else self.array.strides[0])

    @property
    def size(self) -> int:
        """Bytes that it has in a row of the tape: of BLOBS the counts, and where the blobs are."""
        if self.action == WATCH:
            return 0
        if self.action == BLOBS:
            return 8 * (self.number + 1)
        return self.number * self.width // (2 if self.action == NARROW else 1)

    def numbers(self, at: int) -> list[int]:
        """What the compiled code is told of it; `at`: its offset in a row of the tape."""
        rows = 0 if self.rows is None else address_of(self.rows)
        other = 0 if self.other is None else address_of(self.other)
        return [self.action, at, address_of(self.array), self.width, rows, self.number, other]


class Sheet:
    """What rows hold, as long as the same robots are there and the same sensors are read.

    names: of the robots, as ROS takes them. movers: (n,) of MOVER, the stage's records. told: (n,
    11) the commands that were noted last; it is written. movables: how many things can be pushed.
    read: whose readings are among the sources.
    """

    def __init__(
        self,
        names: Sequence[str],
        sources: Sequence[Source],
        movers: NDArray[Any],
        told: NDArray[np.float64],
        movables: int = 0,
        read: Sequence[Read] = (),
    ) -> None:
        self.names = tuple(names)
        self.movables, self.read = movables, read
        self.arrays = sources, movers, told  # they stay where they are while somebody has them
        self.at: dict[object, int] = {}
        """By a source's name: its offset in a row."""
        self.written: Any = None
        """How its rows are made messages: whoever does that keeps it here."""
        at, listed = HEAD, []
        for source in sources:
            self.at[source.name] = at
            listed += source.numbers(at)
            at += -(-source.size // 8) * 8
        self.fixed = at
        offsets = [OFFSETS[name] for name in (*commands.NUMBERS, "mode", "motors")]
        self.plan = np.array(
            [
                len(movers), address_of(movers), MOVER.itemsize,
                address_of(told), at, len(sources), *offsets, *listed,
            ],
            np.int64,
        )  # fmt: skip

    @property
    def robots(self) -> int:
        return len(self.names)


class Tape:
    """Memory with rows of one sheet. The run alone moves `end`, once a row is complete."""

    def __init__(self, sheet: Sheet, memory: NDArray[np.uint8]) -> None:
        self.sheet = sheet
        self.memory = memory
        self.base, self.room = address_of(memory), len(memory)
        self.plan = sheet.plan
        self.place = np.array([self.base, 0, self.room], np.int64)

    @property
    def end(self) -> int:
        """Bytes of complete rows."""
        return int(self.place[1])

    def note(self, tick: int, time: float, coverage: float, told: bool) -> int:
        """Add a row; -1, and nothing is noted, where there is no room for it.

        time: simulated seconds. told: whether robots may have got other commands. Returns bits:
        the first one for the first watched source, if it is not as it was, and so on.
        """
        return noted(self.plan, self.place, tick, time, coverage, told)

    def need(self) -> int:
        """Bytes that a row may take now."""
        return int(needed(self.plan, True))


@compiled
def needed(plan: NDArray[np.int64], told: bool) -> int:
    """Bytes that a row takes at the most."""
    size = plan[4]
    if told:
        size += plan[0] * TELLING
    for k in range(plan[5]):
        place = SOURCES + SOURCE * k
        if plan[place] == BLOBS:
            for i in range(plan[place + 5]):
                row = i if plan[place + 4] == 0 else get_long(plan[place + 4] + 8 * i)
                size += get_long(plan[place + 6] + 8 * row) * BLOB_SIZE
            size += 8
    return int(size)


@quick
def noted(
    plan: NDArray[np.int64],
    place: NDArray[np.int64],
    tick: int,
    time: float,
    coverage: float,
    told: bool,
) -> int:
    """Write a row where a tape's `place` (its address, end and room) says, and move the end."""
    if place[1] + needed(plan, told) > place[2]:
        return -1
    row = place[0] + place[1]
    end, changes = plan[4], 0
    put_long(row + TICK, tick)
    put_long(row + TIME, np.int64(np.rint(time * 1e9)))
    put_float(row + COVERAGE, coverage)
    for k in range(plan[5]):
        source = SOURCES + SOURCE * k
        if plan[source] == WATCH:
            changes = 2 * changes + _changed(plan[source + 2], plan[source + 6], plan[source + 3])
        else:
            end = _note_source(plan, source, row, end)
    count = _note_commands(plan, row + end) if told else 0
    put_long(row + TOLD, count)
    put_long(row + TOLD_AT, end)
    end += count * TELLING
    put_long(row + LENGTH, end)
    place[1] += end
    return int(changes)


@compiled
def _changed(address: int, seen: int, size: int) -> int:
    """1 if so many bytes are not as they were seen last: then they are seen; else 0."""
    same, k = True, 0
    while same and k + 8 <= size:
        same = get_long(address + k) == get_long(seen + k)
        k += 8
    while same and k < size:
        same = get_byte(address + k) == get_byte(seen + k)
        k += 1
    if not same:
        copy(seen, address, size)
    return 0 if same else 1


@compiled
def _note_source(plan: NDArray[np.int64], source: int, row: int, end: int) -> int:
    """Write a source into a row that ends at `end` so far; where it ends then."""
    action, to, address = plan[source], row + plan[source + 1], plan[source + 2]
    width, rows, number = plan[source + 3], plan[source + 4], plan[source + 5]
    if action == COPY and rows == 0:
        copy(to, address, number * width)
    elif action == COPY:
        for i in range(number):
            copy(to + i * width, address + get_long(rows + 8 * i) * width, width)
    elif action == NARROW:
        count = width // 8
        for i in range(number):
            here = address + (i if rows == 0 else get_long(rows + 8 * i)) * width
            there = to + i * (width // 2)
            for j in range(count):
                put_single(there + 4 * j, np.float32(get_float(here + 8 * j)))
    elif action == BLOBS:
        put_long(to + 8 * number, end)
        for i in range(number):
            which = i if rows == 0 else get_long(rows + 8 * i)
            count = get_long(plan[source + 6] + 8 * which)
            put_long(to + 8 * i, count)
            for j in range(count):
                copy(row + end, address + j * width + which * BLOB_SIZE, BLOB_SIZE)
                end += BLOB_SIZE
        end += -end % 8
    return end


@compiled
def _note_commands(plan: NDArray[np.int64], to: int) -> int:
    """Write the commands that are new; how many these are."""
    count = 0
    now, was = np.empty(commands.WIDTH), np.empty(commands.WIDTH)
    for robot in range(plan[0]):
        mover, known = plan[1] + robot * plan[2], plan[3] + 8 * commands.WIDTH * robot
        same = True
        for j in range(commands.WIDTH):
            place = mover + plan[FIELDS + j]
            if j == commands.MODE:
                now[j] = get_int(place)
            elif j == commands.MOTORS:
                now[j] = get_byte(place)
            else:
                now[j] = get_float(place)
            was[j] = get_float(known + 8 * j)
            same = same and now[j] == was[j]
        if same:
            continue
        for j in range(commands.WIDTH):
            put_float(known + 8 * j, now[j])
        if commands.is_told(was, now):
            put_long(to + count * TELLING, robot)
            for j in range(commands.WIDTH):
                put_float(to + count * TELLING + 8 * (1 + j), now[j])
            count += 1
    return count
