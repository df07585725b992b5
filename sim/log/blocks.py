"""Messages of one size as one array of MCAP's Message records, ready to be written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from mcap.opcode import Opcode
from numpy.typing import ArrayLike, NDArray

from sim.log.cdr import HEAD

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
    """Records (count, size) of messages with their channels (count,) and log times (count,), ns."""

    records: NDArray[np.uint8]
    channels: NDArray[np.uint16]
    times: NDArray[np.uint64]


def block(
    bodies: NDArray[np.uint8], channels: ArrayLike, sequences: ArrayLike, times: ArrayLike
) -> Block:
    """Records of messages whose data behind CDR's head are `bodies` (count, size).

    channels, sequences and times (ns): (count,) each, or one for all.
    """
    count, size = bodies.shape
    prefix = np.zeros(count, PREFIX)
    prefix["opcode"] = Opcode.MESSAGE
    prefix["length"] = PREFIX.itemsize - 9 + len(HEAD) + size
    prefix["channel"] = channels
    prefix["sequence"] = sequences
    prefix["log_time"] = prefix["publish_time"] = times
    records = np.empty((count, PREFIX.itemsize + len(HEAD) + size), np.uint8)
    records[:, : PREFIX.itemsize] = prefix.view(np.uint8).reshape(count, -1)
    records[:, PREFIX.itemsize : PREFIX.itemsize + len(HEAD)] = np.frombuffer(HEAD, np.uint8)
    records[:, PREFIX.itemsize + len(HEAD) :] = bodies
    return Block(records, prefix["channel"].copy(), prefix["log_time"].copy())


def single(data: bytes, channel: int, sequence: int, time: int) -> Block:
    """One message of its own size; `data` with CDR's head, time in ns."""
    return block(np.frombuffer(data, np.uint8)[None, len(HEAD) :], channel, sequence, time)


ENTRY = np.dtype([("time", "<u8"), ("offset", "<u8")])
INDEX = np.dtype([("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("bytes", "<u4")])
PLACE = np.dtype([("channel", "<u2"), ("offset", "<u8")])


def message_indexes(
    channels: NDArray[np.uint16], times: NDArray[np.uint64], offsets: NDArray[np.uint64]
) -> tuple[NDArray[np.uint8], NDArray[Any]]:
    """The MessageIndex records of a chunk's messages, and where each channel's begins (PLACE).

    channels, times, offsets: (count,) of the messages in the order in which they stand.
    """
    order = np.lexsort((times, channels))  # readers expect a channel's messages in order of time
    ranked = channels[order]
    firsts = np.flatnonzero(np.r_[True, ranked[1:] != ranked[:-1]])
    counts = np.diff(np.r_[firsts, len(ranked)])
    entries = np.empty(len(order), ENTRY)
    entries["time"], entries["offset"] = times[order], offsets[order]
    heads = np.zeros(len(firsts), INDEX)
    heads["opcode"] = Opcode.MESSAGE_INDEX
    heads["channel"] = ranked[firsts]
    heads["bytes"] = ENTRY.itemsize * counts
    heads["length"] = heads["bytes"] + 6
    starts = INDEX.itemsize * np.arange(len(firsts)) + ENTRY.itemsize * firsts
    out = np.empty(INDEX.itemsize * len(firsts) + ENTRY.itemsize * len(order), np.uint8)
    paste(out, starts, heads)
    ranks = np.repeat(np.arange(1, len(firsts) + 1), counts)
    paste(out, ENTRY.itemsize * np.arange(len(order)) + INDEX.itemsize * ranks, entries)
    places = np.empty(len(firsts), PLACE)
    places["channel"], places["offset"] = ranked[firsts], starts
    return out, places


def paste(out: NDArray[np.uint8], at: NDArray[Any], rows: NDArray[Any]) -> None:
    """Write rows (count,) of packed records at byte offsets (count,)."""
    size = rows.dtype.itemsize
    out[at[:, None] + np.arange(size)] = rows.view(np.uint8).reshape(len(rows), size)
