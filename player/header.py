"""The 40-byte header that starts every message, and bytes cut into messages again."""

from __future__ import annotations

import struct
from typing import NamedTuple

from player.errors import ProtocolError

HEADER = struct.Struct(">6IdII")
"""host, robot, interface, index, type, subtype, timestamp, seq, payload size."""

FRONT = struct.Struct(">6I")
"""The header up to its timestamp: what most messages of one kind have in common."""

TIME = struct.Struct(">d")
"""Its timestamp; behind it come seq and payload size, with a seq of 0 one number of eight bytes."""

HEADER_SIZE = HEADER.size

MAX_PAYLOAD = 8 << 20
"""Largest payload that Player itself would make (8 MB)."""

MAX_REQUEST = 1 << 20
"""Largest payload that a client may send, bytes: far above any request, 65 thousand points."""

_LAST_TYPE = 6


class Message(NamedTuple):
    """One message as it travels; `time` in seconds, `payload` still encoded."""

    host: int
    robot: int
    interf: int
    index: int  # type: ignore[assignment]  # Player's name for it, not tuple's method
    type: int
    subtype: int
    time: float
    seq: int
    payload: bytes

    def encode(self) -> bytes:
        """Header and payload."""
        return HEADER.pack(*self[:8], len(self.payload)) + self.payload


def pack_message(
    interf: int,
    index: int,
    type: int,
    subtype: int,
    payload: bytes = b"",
    *,
    time: float = 0.0,
    host: int = 0,
    robot: int = 0,
    seq: int = 0,
) -> bytes:
    """Header and payload of one message."""
    header = HEADER.pack(host, robot, interf, index, type, subtype, time, seq, len(payload))
    return header + payload


_new = tuple.__new__  # a quarter of the time that the named tuple's own constructor takes


class MessageReader:
    """Takes bytes in pieces of any size and gives whole messages, one at a time.

    Keeps at most one unfinished message and what was fed after it. A header that cannot be one
    (a type that does not exist, a payload above `max_payload`) raises ProtocolError: there is no
    way to find the next message after it.
    """

    __slots__ = ("_needed", "_offset", "left", "max_payload")

    def __init__(self, max_payload: int = MAX_PAYLOAD) -> None:
        self.max_payload = max_payload
        self.left: bytes | bytearray = b""
        """In whose end what was fed and not given as messages lies; empty if there is nothing."""
        self._offset = 0
        self._needed = HEADER_SIZE

    def feed(self, data: bytes) -> None:
        """Adds what has been received."""
        left = len(self.left) - self._offset
        if not left:
            self.left = data
            self._offset = 0
            return
        if not isinstance(self.left, bytearray):
            self.left = bytearray(self.left)
        if self._offset:
            del self.left[: self._offset]
            self._offset = 0
        self.left += data

    @property
    def buffered(self) -> int:
        """Bytes that were fed and not yet given as messages."""
        return len(self.left) - self._offset

    def take(self) -> Message | None:
        """The next whole message, None if more bytes are needed for it."""
        buffer = self.left
        start = self._offset
        left = len(buffer) - start
        if left < self._needed:
            return None
        header = HEADER.unpack_from(buffer, start)
        size = header[8]
        if size > self.max_payload:
            raise ProtocolError(
                f"a message announces {size} bytes of payload (at most {self.max_payload})"
            )
        if not 1 <= header[4] <= _LAST_TYPE or header[2] > 0xFFFF or header[3] > 0xFFFF:
            raise ProtocolError(
                f"not a message header: interface {header[2]}, index {header[3]}, type {header[4]}"
            )
        total = HEADER_SIZE + size
        if left < total:
            self._needed = total
            return None
        self._needed = HEADER_SIZE
        payload = bytes(buffer[start + HEADER_SIZE : start + total])
        if left == total:
            self.left = b""
            self._offset = 0
        else:
            self._offset = start + total
        return _new(Message, (*header[:8], payload))
