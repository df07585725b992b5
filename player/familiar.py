"""Bytes like those that came before: which messages they are is known without taking them apart.

What travels repeats from tick to tick, with other times and other payloads: a round of data, a
command with a request for more. What a piece of bytes consists of is found out once. The next
piece of its length is cut in one call, and consists of the same messages if all headers, but for
their times, are the same.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

from player.header import HEADER, HEADER_SIZE, Message

MOST_PIECES = 64
"""Pieces that are remembered: blobs come and go, and with each the length is another."""

STEP = 4
"""Parts into which each message is cut: its header up to the time, the time, the header's rest, and
the payload."""

Meaning = TypeVar("Meaning")


class _Piece(NamedTuple, Generic[Meaning]):
    cut: Callable[[bytes], tuple[Any, ...]]
    heads: tuple[bytes, ...]
    rests: tuple[bytes, ...]
    meaning: Meaning


class Familiar(Generic[Meaning]):
    """Remembers pieces by their lengths. `read(messages)` says what a new piece means to the owner;
    None if it is not worth to be remembered.
    """

    __slots__ = ("_pieces", "_read")

    def __init__(self, read: Callable[[list[Message]], Meaning | None]) -> None:
        self._read = read
        self._pieces: dict[int, _Piece[Meaning]] = {}

    def match(self, data: bytes) -> tuple[Meaning, tuple[Any, ...]] | None:
        """The meaning of a piece that is remembered, and its parts: STEP of them a message."""
        piece = self._pieces.get(len(data))
        if piece is None:
            return None
        parts = piece.cut(data)
        if parts[::STEP] != piece.heads or parts[2::STEP] != piece.rests:
            return None
        return piece.meaning, parts

    def learn(self, data: bytes) -> None:
        """Remembers a piece, if it is whole messages and its owner thinks it worth it."""
        messages = _whole(data)
        meaning = self._read(messages) if messages else None
        if meaning is None:
            return
        layout = "".join(f"24sd8s{len(message.payload)}s" for message in messages)
        cut = struct.Struct(f">{layout}").unpack
        parts = cut(data)
        if len(self._pieces) >= MOST_PIECES:
            self._pieces.clear()
        self._pieces[len(data)] = _Piece(cut, parts[::STEP], parts[2::STEP], meaning)

    def forget(self) -> None:
        """What pieces meant is not true any more."""
        self._pieces.clear()


def _whole(data: bytes) -> list[Message]:
    """The messages that `data` consists of; none if one of them is cut short."""
    found = []
    start = 0
    while start < len(data):
        if len(data) - start < HEADER_SIZE:
            return []
        header = HEADER.unpack_from(data, start)
        end = start + HEADER_SIZE + header[-1]
        if end > len(data):
            return []
        found.append(Message._make((*header[:-1], data[start + HEADER_SIZE : end])))
        start = end
    return found
