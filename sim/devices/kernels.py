"""Scans and blobs of many robots as the words that travel: compiled, as each tick has them made."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.devices.compiled import compiled

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
def blob_words(blobs: NDArray[Any], counts: NDArray[np.int64], rows: NDArray[np.int64]) -> Words:
    """Of blobs (capacity, n) those of rows (m,), one after the other: ten words each, the last one
    the range.
    """
    total = 0
    for m in range(rows.size):
        total += counts[rows[m]]
    words = np.empty((total, 10), np.uint32)
    one = np.empty(1, np.float32)
    bits = one.view(np.uint32)
    at = 0
    for m in range(rows.size):
        k = rows[m]
        for j in range(counts[k]):
            blob = blobs[j, k]
            words[at, 0] = swapped(blob.id)
            words[at, 1] = swapped(blob.color)
            words[at, 2] = swapped(blob.area)
            words[at, 3] = swapped(blob.x)
            words[at, 4] = swapped(blob.y)
            words[at, 5] = swapped(blob.left)
            words[at, 6] = swapped(blob.right)
            words[at, 7] = swapped(blob.top)
            words[at, 8] = swapped(blob.bottom)
            one[0] = blob.range
            words[at, 9] = swapped(bits[0])
            at += 1
    return words
