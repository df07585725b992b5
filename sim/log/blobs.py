"""What cameras saw in rows, as messages: as many blobs as each saw."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.log.cdr import HEAD
from sim.log.compiled import compiled
from sim.log.memory import copy, get_float, get_long, put_byte, put_float, put_word
from sim.log.page import BEFORE, Page, put_note, put_prefix
from sim.log.stretches import ENCODING, SECOND, START, Stretch
from sim.log.tape import BLOB_SIZE, LENGTH, TIME

MOST_PADDING = 8
WORDS = 9
"""uint32 that a blob begins with; its range follows."""


class Cameras(NamedTuple):
    """Cameras of equal settings: their channels, their frames, the size of their images."""

    channels: NDArray[np.int64]
    frames: NDArray[np.uint8]
    """(k, longest) each with a zero at its end."""
    lengths: NDArray[np.int64]
    """(k,) with the zero."""
    width: int
    height: int


def cameras(channels: Sequence[int], frames: Sequence[str], width: int, height: int) -> Cameras:
    """Cameras with these channels and frames."""
    texts = [frame.encode() + b"\0" for frame in frames]
    longest = max(map(len, texts))
    padded = np.array([list(text.ljust(longest, b"\0")) for text in texts], np.uint8)
    lengths = np.array([len(text) for text in texts], np.int64)
    return Cameras(np.array(channels, np.int64), padded, lengths, width, height)


def write_blobs(page: Page, part: Stretch, seen_by: Cameras, at_row: int) -> None:
    """Add what cameras saw in rows; at_row: where a row tells it."""
    messages = part.ticks * len(seen_by.channels)
    alone = START + 24 + MOST_PADDING + seen_by.frames.shape[1]
    blobs = int(blobs_in(part.rows, part.ticks, len(seen_by.channels), at_row))
    page.fill(
        messages * alone + blobs * (BLOB_SIZE + 4),
        messages,
        blobs_written, part.rows, part.ticks, *seen_by, at_row,
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
                copy(data + end, blob, 4 * WORDS)
                end += 4 * WORDS
                if end % 8:
                    put_word(data + end, 0)
                    end += 4
                put_float(data + end, get_float(blob + 4 * WORDS))
                end += 8
                blob += BLOB_SIZE
            put_prefix(here, len(HEAD) + end, channels[k], time)
            put_note(notes, number, time, at + size, channels[k])
            size += START + end
            number += 1
        row += get_long(row + LENGTH)
    return size, number
