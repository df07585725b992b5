"""Bytes like those that came before: which messages they are is known without taking them apart.

What travels repeats from tick to tick, with other times and other numbers: a round of data, a
command with a request for more. What a piece of bytes consists of is found out once. The next
piece of its length consists of the same messages if all is the same but what may differ: the
times, and of each payload the stretch that its reader names. That is one call and one comparison.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any, Generic, NamedTuple, TypeVar

from player.header import HEADER, HEADER_SIZE, Message

MOST_PIECES = 64
"""Pieces that are remembered: blobs come and go, and with each the length is another."""

TIME_AT, TIME_END = 24, 32
"""Where a header has its time: all else in it is what kind of message it is."""

Meaning = TypeVar("Meaning")

Stretch = tuple[int, int]
"""Where a payload may differ: from byte to byte."""


class _Piece(NamedTuple, Generic[Meaning]):
    same: Callable[[bytes], tuple[Any, ...]]
    """Cuts what must not differ out of a piece."""
    parts: tuple[Any, ...]
    meaning: Meaning


class Familiar(Generic[Meaning]):
    """Remembers pieces by their lengths.

    `read(messages)` says what a new piece means to the owner, and for each message where its
    payload may differ from this one; None if the piece is not worth to be remembered.
    """

    __slots__ = ("_pieces", "_read")

    def __init__(
        self, read: Callable[[list[Message]], tuple[Meaning, Sequence[Stretch]] | None]
    ) -> None:
        self._read = read
        self._pieces: dict[int, _Piece[Meaning]] = {}

    def match(self, data: bytes) -> Meaning | None:
        """The meaning of a piece that is remembered; None if it is not."""
        piece = self._pieces.get(len(data))
        if piece is None:
            return None
        same, parts, meaning = piece
        return meaning if same(data) == parts else None

    def learn(self, data: bytes) -> None:
        """Remembers a piece, if it is whole messages and its owner thinks it worth it."""
        messages = _whole(data)
        found = self._read(messages) if messages else None
        if found is None:
            return
        meaning, stretches = found
        same = struct.Struct(_layout(messages, stretches)).unpack
        if len(self._pieces) >= MOST_PIECES:
            self._pieces.clear()
        self._pieces[len(data)] = _Piece(same, same(data), meaning)

    def forget(self) -> None:
        """What pieces meant is not true any more."""
        self._pieces.clear()


def _layout(messages: list[Message], stretches: Sequence[Stretch]) -> str:
    """The struct that leaves out what may differ."""
    codes = ""
    kept = 0
    for message, (start, end) in zip(messages, stretches, strict=True):
        codes += f"{kept + TIME_AT}s{TIME_END - TIME_AT}x"
        kept = HEADER_SIZE - TIME_END + start
        if end > start:
            codes += f"{kept}s{end - start}x"
            kept = 0
        kept += len(message.payload) - end
    return f">{codes}{kept}s"


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
