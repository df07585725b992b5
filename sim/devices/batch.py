"""Messages of one kind that are encoded together, one after the other in one array."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

WORD = 4
"""Bytes: Player's messages are whole words."""


class Batch(Sequence[bytes]):
    """Payloads: message k is `words` from `starts[k]` to `starts[k + 1]`, as they travel.

    The numbers may be written anew for each tick; the arrays stay where they are.
    """

    def __init__(self, words: NDArray[np.uint32], starts: NDArray[np.int64]) -> None:
        self.words = words
        self.starts = starts
        self.addresses = (words.ctypes.data, starts.ctypes.data)
        """Where the two arrays lie, for compiled code."""

    @classmethod
    def of_rows(cls, rows: NDArray[Any]) -> Batch:
        """A batch whose messages are the rows of a contiguous array, each of whole words."""
        count, size = len(rows), rows.dtype.itemsize
        words = rows.reshape(-1).view(np.uint8).view(np.uint32)
        return cls(words, np.arange(count + 1, dtype=np.int64) * (size // WORD))

    def __len__(self) -> int:
        return len(self.starts) - 1

    @overload
    def __getitem__(self, k: int) -> bytes: ...
    @overload
    def __getitem__(self, k: slice) -> list[bytes]: ...
    def __getitem__(self, k: int | slice) -> bytes | list[bytes]:
        if isinstance(k, slice):
            return [self[i] for i in range(*k.indices(len(self)))]
        if not 0 <= k < len(self):
            raise IndexError(k)
        return self.words[self.starts[k] : self.starts[k + 1]].tobytes()
