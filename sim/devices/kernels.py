"""Scans and blobs of many robots as the words that travel: compiled, as each tick has them made."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.devices.compiled import compiled
from sim.stage.intrinsics import ints_at, longs_at

Words = NDArray[np.uint32]
SWAPS = sys.byteorder == "little"


@compiled
def swapped(word: Any) -> Any:
    """A 32-bit word as it travels: big-endian."""
    word = np.uint32(word)
    if not SWAPS:
        return word
    low = (word & np.uint32(0xFF)) << np.uint32(24) | (word & np.uint32(0xFF00)) << np.uint32(8)
    return low | word >> np.uint32(8) & np.uint32(0xFF00) | word >> np.uint32(24)


@compiled
def write_ranges(
    ranges: NDArray[np.float64],
    hits: NDArray[np.int32],
    rows: NDArray[np.int64],
    farthest: float,
    words: Words,
    first: int,
) -> None:
    """Write the ranges of rows (m,) of scans (n, k) to `words` (m, ...), from column `first` on.

    What is hit reads `farthest` at the most; see `encoding.told`.
    """
    floats = np.empty(ranges.shape[1], np.float32)
    bits = floats.view(np.uint32)
    for m in range(rows.size):
        k = rows[m]
        for i in range(floats.size):
            measured = ranges[k, i]
            if measured > farthest and hits[k, i] >= 0:
                measured = farthest
            floats[i] = measured
        for i in range(floats.size):
            words[m, first + i] = swapped(bits[i])


@compiled
def write_blobs(
    blobs: NDArray[Any],
    counts: NDArray[np.int64],
    rows: NDArray[np.int64],
    width: int,
    height: int,
    words: Words,
    starts: NDArray[np.int64],
) -> int:
    """Write of blobs (capacity, n) those of rows (m,) as messages: ten words each blob.

    `starts` (m + 1,): where each begins. The number of words that are needed: with more than there
    are, nothing is written.
    """
    at = 0
    for m in range(rows.size):
        starts[m] = at
        at += 4 + 10 * counts[rows[m]]
    starts[rows.size] = at
    if at > words.size:
        return at
    one = np.empty(1, np.float32)
    bits = one.view(np.uint32)
    at = 0
    for m in range(rows.size):
        k = rows[m]
        words[at] = swapped(width)
        words[at + 1] = swapped(height)
        words[at + 2] = words[at + 3] = swapped(counts[k])
        at += 4
        for j in range(counts[k]):
            blob = blobs[j, k]
            words[at] = swapped(blob.id)
            words[at + 1] = swapped(blob.color)
            words[at + 2] = swapped(blob.area)
            words[at + 3] = swapped(blob.x)
            words[at + 4] = swapped(blob.y)
            words[at + 5] = swapped(blob.left)
            words[at + 6] = swapped(blob.right)
            words[at + 7] = swapped(blob.top)
            words[at + 8] = swapped(blob.bottom)
            one[0] = blob.range
            words[at + 9] = swapped(bits[0])
            at += 10
    return at


@compiled
def write_rounds(
    tables: NDArray[np.uint64],
    sources: NDArray[np.int64],
    places: NDArray[np.int64],
    heads: Words,
    firsts: NDArray[np.int64],
    acks: Words,
    end: Words,
    stamp: Words,
    words: Words,
    ends: NDArray[np.int64],
) -> int:
    """Write rounds (p,): an acknowledgement each, messages, and what ends a round.

    Message m is the payload `places[m]` of the batch whose addresses are `tables[sources[m]]`,
    behind a header `heads[m]` of ten words; those of round k begin with `firsts[k]`. All but the
    end of a round get the time `stamp` (2,). `ends`: where each round ends. The number of words
    that are needed: with more than there are, nothing is written.
    """
    at = 0
    for k in range(firsts.size - 1):
        at += 20
        for m in range(firsts[k], firsts[k + 1]):
            starts = longs_at(tables[sources[m], 1])
            at += 10 + starts[places[m] + 1] - starts[places[m]]
        ends[k] = at
    if at > words.size:
        return at
    at = 0
    for k in range(firsts.size - 1):
        at = write_head(acks[k], stamp, words, at)
        for m in range(firsts[k], firsts[k + 1]):
            payload = ints_at(tables[sources[m], 0])
            starts = longs_at(tables[sources[m], 1])
            first, last = starts[places[m]], starts[places[m] + 1]
            at = write_head(heads[m], stamp, words, at)
            words[at - 1] = swapped(4 * (last - first))
            for i in range(first, last):
                words[at] = np.uint32(payload[i])
                at += 1
        for i in range(10):
            words[at + i] = end[i]
        at += 10
    return at


@compiled
def write_head(head: Words, stamp: Words, words: Words, at: int) -> int:
    """Write a header with its time; where it ends."""
    for i in range(10):
        words[at + i] = head[i]
    words[at + 6] = stamp[0]
    words[at + 7] = stamp[1]
    return at + 10
