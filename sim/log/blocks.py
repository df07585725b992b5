"""Messages of one size as one array of MCAP's Message records, written in a few numpy calls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import NDArray

from sim.log.layouts import Layout, Values

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


@dataclass(frozen=True)
class Block:
    """Messages of one layout, numbered by `shape`, and what is written into them.

    channels, times (log times, ns): arrays that broadcast to `shape`. values: by a field's path.
    """

    layout: Layout
    shape: tuple[int, ...]
    channels: NDArray[np.uint16]
    times: NDArray[np.uint64]
    values: Mapping[str, Values]

    @property
    def count(self) -> int:
        """Messages."""
        return math.prod(self.shape)

    @property
    def record(self) -> int:
        """Bytes of a message's record."""
        return PREFIX.itemsize + self.layout.size

    def write(self, out: NDArray[np.uint8]) -> None:
        """Write the records into (count * record,) bytes, one after the other."""
        prefix = np.zeros(self.shape, PREFIX)
        prefix["opcode"] = Opcode.MESSAGE
        prefix["length"] = self.record - 9
        prefix["channel"] = self.channels
        prefix["log_time"] = prefix["publish_time"] = self.times
        rows = out.reshape(-1, self.record)
        rows[:, : PREFIX.itemsize] = prefix.view(np.uint8).reshape(-1, PREFIX.itemsize)
        rows[:, PREFIX.itemsize :] = self.layout.message
        self.layout.fill(out, PREFIX.itemsize, self.shape, self.values)


def single(data: bytes, channel: int, time: int) -> Block:
    """One message of its own size; `data` with CDR's head, time in ns."""
    alone = Layout(np.frombuffer(data, np.uint8), {})
    return Block(alone, (1,), np.array(channel, np.uint16), np.array(time, np.uint64), {})


ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
INDEX = np.dtype([("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("bytes", "<u4")])
PLACE = np.dtype([("channel", "<u2"), ("offset", "<u8")])


class Indexes(NamedTuple):
    """The MessageIndex records of a chunk."""

    records: bytes
    places: NDArray[Any]
    """PLACE of each channel that has messages: where its record begins in `records`."""
    counts: NDArray[np.int64]
    """How many messages each of these channels has."""


def message_indexes(
    channels: NDArray[np.uint16], times: NDArray[np.uint64], offsets: NDArray[np.uint64]
) -> Indexes:
    """The indexes of messages (count,) in the order in which they stand."""
    # readers expect a channel's messages in order of time
    order = np.argsort(times, kind="stable")
    order = order[np.argsort(channels[order], kind="stable")]
    ranked = channels[order]
    firsts = np.flatnonzero(np.r_[True, ranked[1:] != ranked[:-1]])
    counts = np.diff(np.r_[firsts, len(ranked)])
    entries = np.empty(len(order), ENTRY)
    entries["time"], entries["offset"] = times[order], offsets[order]
    places = np.empty(len(firsts), PLACE)
    places["channel"] = ranked[firsts]
    parts, at = [], 0
    for count in np.unique(counts).tolist():  # records of one size go together
        which = np.flatnonzero(counts == count)
        size = INDEX.itemsize + ENTRY.itemsize * count
        heads = np.empty(len(which), INDEX)
        heads["opcode"] = Opcode.MESSAGE_INDEX
        heads["length"] = size - 9
        heads["channel"] = ranked[firsts[which]]
        heads["bytes"] = ENTRY.itemsize * count
        rows = np.empty((len(which), size), np.uint8)
        rows[:, : INDEX.itemsize] = heads.view(np.uint8).reshape(len(which), -1)
        own = entries[firsts[which, None] + np.arange(count)]
        rows[:, INDEX.itemsize :] = own.view(np.uint8).reshape(len(which), -1)
        places["offset"][which] = at + size * np.arange(len(which))
        parts.append(rows.tobytes())
        at += rows.size
    return Indexes(b"".join(parts), places, counts)
