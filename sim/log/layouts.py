"""Messages of one fixed size: where their numbers stand, to write and to read many at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.log.cdr import HEAD, Encoder


class Piece(NamedTuple):
    """Values of a field that stand at equal distances."""

    first: int
    """Which of the field's values comes first."""
    number: int
    at: int
    """Where that one stands in a message, its head included; bytes."""
    step: int
    """From one to the next; bytes."""


class Place(NamedTuple):
    """Where all values of a field stand."""

    dtype: np.dtype[Any]
    number: int
    """How many these are."""
    pieces: Sequence[Piece]


@dataclass(frozen=True)
class Layout:
    """The bytes of a message of one fixed size, and where in it the values of its fields stand."""

    message: NDArray[np.uint8]
    """(size,) one such message, CDR's head included."""
    places: Mapping[str, Place]
    """By a field's path."""

    @property
    def size(self) -> int:
        """Bytes of the message, its head included."""
        return len(self.message)

    def read(self, messages: NDArray[np.uint8], path: str) -> NDArray[Any]:
        """The values (k, count) of a field of messages (k, size)."""
        dtype, total, pieces = self.places[path]
        found = np.empty((len(messages), total), dtype)
        into = found.view(np.uint8).reshape(len(messages), total, dtype.itemsize)
        for first, number, at, step in pieces:
            wide = (number - 1) * step + dtype.itemsize
            part = messages[:, at : at + wide]
            row, byte = part.strides
            into[:, first : first + number] = np.lib.stride_tricks.as_strided(
                part, (len(part), number, dtype.itemsize), (row, step, byte), writeable=False
            )
        return found


def layout(name: str, values: Mapping[str, Any]) -> Layout:
    """The layout of messages of a type whose arrays and texts are as long as those of `values`."""
    encoder = Encoder(traced=True)
    encoder.message(name, values)
    places: dict[str, Place] = {}
    for path, at in encoder.places.items():
        if at:
            dtype = encoder.kinds.get(path, np.dtype("u1"))
            places[path] = Place(dtype, len(at), pieces_of(at, dtype.itemsize))
    return Layout(np.frombuffer(HEAD + bytes(encoder.data), np.uint8), places)


def pieces_of(at: Sequence[int], size: int) -> list[Piece]:
    """Ascending byte offsets behind CDR's head, as runs at equal distances."""
    found: list[Piece] = []
    steps = [after - before for before, after in pairwise(at)]
    first = 0
    while first < len(at):
        last = first
        while last < len(steps) and steps[last] == steps[first]:
            last += 1
        step = steps[first] if last > first else size
        found.append(Piece(first, last - first + 1, at[first] + len(HEAD), step))
        first = last + 1
    return found
