"""The records of one chunk while they are made: their bytes, and where each message stands."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import NDArray

from sim.log.compiled import compiled
from sim.log.memory import address_of, get_long, put_byte, put_long, put_short, put_word

PREFIX = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
"""What stands before a message's data in its record (https://mcap.dev/spec#message-op0x05)."""
ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
INDEX = np.dtype([("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("bytes", "<u4")])
PLACE = np.dtype([("channel", "<u2"), ("offset", "<u8")])
BEFORE, CHANNEL_AT, TIME_AT = PREFIX.itemsize, 9, 15
MESSAGE = int(Opcode.MESSAGE)
MESSAGE_INDEX = int(Opcode.MESSAGE_INDEX)
NOTE = np.dtype([("time", "<i8"), ("offset", "<i8"), ("channel", "<i8")])
"""A message of a page: its log time (ns), its offset, its channel."""


class Page:
    """Room for records, which is used again for the next chunk."""

    def __init__(self) -> None:
        self.memory = np.empty(1 << 16, np.uint8)
        self.notes = np.empty(1 << 10, NOTE)
        self.size = 0
        self.count = 0

    def clear(self) -> None:
        self.size = self.count = 0

    def reserve(self, size: int, messages: int) -> tuple[int, int]:
        """Make room for so many bytes and messages more: the addresses of both."""
        if self.size + size > len(self.memory):
            self.memory = longer(self.memory, self.size, self.size + size)
        if self.count + messages > len(self.notes):
            self.notes = longer(self.notes, self.count, self.count + messages)
        return address_of(self.memory), address_of(self.notes)

    def fill(
        self, size: int, messages: int, write: Callable[..., tuple[int, int]], *told: Any
    ) -> None:
        """Add messages, of `size` bytes in all and as many as that at the most.

        write(*told, address of the page, offset, address of the notes) -> bytes and messages.
        """
        memory, notes = self.reserve(size, messages)
        more = write(*told, memory, self.size, notes + NOTE.itemsize * self.count)
        self.size += int(more[0])
        self.count += int(more[1])

    def record(self, data: bytes) -> None:
        """Add a record that is no message."""
        self.reserve(len(data), 0)
        self.memory[self.size : self.size + len(data)] = np.frombuffer(data, np.uint8)
        self.size += len(data)

    def message(self, data: bytes, channel: int, time: int) -> None:
        """Add a message; `data` with CDR's head, time in ns."""
        self.reserve(0, 1)
        self.notes[self.count] = time, self.size, channel
        self.count += 1
        head = struct.pack("<BQHIQQ", MESSAGE, BEFORE - 9 + len(data), channel, 0, time, time)
        self.record(head + data)


def longer(array: NDArray[Any], used: int, needed: int) -> NDArray[Any]:
    """A longer array with the same beginning."""
    found = np.empty(needed + needed // 4, array.dtype)
    found[:used] = array[:used]
    return found


@compiled
def put_prefix(at: int, size: int, channel: int, time: int) -> None:
    """Write what stands before a message's data of `size` bytes."""
    put_byte(at, MESSAGE)
    put_long(at + 1, BEFORE - 9 + size)
    put_short(at + CHANNEL_AT, channel)
    put_word(at + 11, 0)
    put_long(at + TIME_AT, time)
    put_long(at + TIME_AT + 8, time)


@compiled
def put_note(notes: int, number: int, time: int, offset: int, channel: int) -> None:
    """Write the note of a message."""
    put_long(notes + 24 * number, time)
    put_long(notes + 24 * number + 8, offset)
    put_long(notes + 24 * number + 16, channel)


class Indexes(NamedTuple):
    """The MessageIndex records of a chunk."""

    records: NDArray[np.uint8]
    places: NDArray[Any]
    """PLACE of each channel that has messages: where its record begins in `records`."""
    counts: NDArray[np.int64]
    """How many messages each of these channels has."""
    start: int
    end: int
    """When the first and the last message were, ns."""


def message_indexes(
    channels: NDArray[Any],
    times: NDArray[Any],
    offsets: NDArray[Any],
) -> Indexes:
    """The indexes of messages (count,), one at the least, in the order in which they stand.

    Within a channel they come in the order of time.
    """
    channels, times = channels.astype(np.int64), times.astype(np.int64)
    counts = np.bincount(channels)
    used = np.flatnonzero(counts)
    counts = counts[used]
    ends = np.cumsum(INDEX.itemsize + ENTRY.itemsize * counts)
    places = np.empty(len(used), PLACE)
    places["channel"] = used
    places["offset"] = ends - (INDEX.itemsize + ENTRY.itemsize * counts)
    records = np.empty(int(ends[-1]), np.uint8)
    at = np.zeros(int(used[-1]) + 1, np.int64)
    at[used] = places["offset"]
    start, end = write_indexes(
        channels, times, offsets.astype(np.int64), used, counts, at, address_of(records)
    )
    return Indexes(records, places, counts, start, end)


@compiled
def write_indexes(
    channels: NDArray[np.int64],
    times: NDArray[np.int64],
    offsets: NDArray[np.int64],
    used: NDArray[np.int64],
    counts: NDArray[np.int64],
    at: NDArray[np.int64],
    base: int,
) -> tuple[int, int]:
    """Write the records, of each used channel at `at` from `base` on; the first and last time."""
    for k in range(len(used)):
        here = base + at[used[k]]
        put_byte(here, MESSAGE_INDEX)
        put_long(here + 1, 6 + 16 * counts[k])
        put_short(here + 9, used[k])
        put_word(here + 11, 16 * counts[k])
    first = at + 15
    next_ = first.copy()
    start = end = times[0]
    for k in range(len(channels)):
        channel, time = channels[k], times[k]
        start, end = min(start, time), max(end, time)
        place = next_[channel]
        next_[channel] += 16
        # as a rule they come in their order; what does not is moved to the front
        while place > first[channel] and get_long(base + place - 16) > time:
            put_long(base + place, get_long(base + place - 16))
            put_long(base + place + 8, get_long(base + place - 8))
            place -= 16
        put_long(base + place, time)
        put_long(base + place + 8, offsets[k])
    return start, end
