"""What clients say tick by tick: commands, then a request for data, in one piece of bytes.

What a piece means is read from its messages once, for `Familiar` to remember; what does not come
tick by tick, or does not lie in the same way each time, is for others to read.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from player import messages
from player.codes import DeviceAddr, Interface, MessageType, PlayerRequest
from player.directory import Directory
from player.errors import XdrError
from player.events import Command, Event, Ignored
from player.familiar import Familiar, Stretch
from player.header import HEADER_SIZE, Message
from player.xdr import Values

LONGEST = 1 << 12
"""Bytes of the longest piece that is remembered, in case the client sends its like again."""

_PLAYER = int(Interface.PLAYER)
_CMD, _REQ = int(MessageType.CMD), int(MessageType.REQ)
_new = tuple.__new__  # a quarter of the time that the named tuple's own constructor takes

CommandAt = tuple[DeviceAddr, int, str, Callable[[bytes], Values], int, int]
"""To which device a command goes, its subtype and name, what reads its payload, and where in the
piece that begins and ends."""


class Commands(NamedTuple):
    """What a client says in one piece: commands, then a request for data or none."""

    commands: tuple[CommandAt, ...]
    asks: bool
    seq: int
    """Of that request."""


class UsualCommands:
    """Knows the pieces of one client that look like pieces before.

    Pieces that are longer than `longest` bytes, or LONGEST, are not remembered.
    """

    __slots__ = ("_directory", "_familiar", "_longest")

    def __init__(self, directory: Directory, longest: int) -> None:
        self._directory = directory
        self._familiar = Familiar(read_commands)
        self._longest = min(LONGEST, longest)

    def hear(self, data: bytes, events: list[Event]) -> Commands | None:
        """What a piece says, its commands added to the events; None if it is not familiar.

        It is the next time, if it is one of those that are to be remembered.
        """
        usual = self._familiar.match(data)
        if usual is None:
            if data and len(data) <= self._longest:
                self._familiar.learn(data)
            return None
        devices = self._directory.drivers
        for addr, subtype, name, read, at, end in usual.commands:
            if addr in devices:
                events.append(_new(Command, (addr, subtype, read(data[at:end]), name)))
            else:
                events.append(Ignored(f"there is no device {addr}"))
        return usual


def read_commands(found: list[Message]) -> tuple[Commands, list[Stretch]] | None:
    """Commands of fixed size, and a request for data behind them or none."""
    last = found[-1]
    asks = last[2:6] == (_PLAYER, 0, _REQ, PlayerRequest.DATA)
    commands = []
    at = 0
    for message in found[:-1] if asks else found:
        spec = messages.find(message.interf, _CMD, message.subtype)
        if message.type != _CMD or message.interf == _PLAYER or spec is None:
            return None
        read = spec.layout.plain
        if read is None:
            return None  # how it lies depends on more than its length
        try:
            spec.decode(message.payload)
        except XdrError:
            return None
        addr = DeviceAddr(message.interf, message.index)
        at += HEADER_SIZE
        end = at + len(message.payload)
        commands.append((addr, spec.subtype, spec.name, read, at, end))
        at = end
    return Commands(tuple(commands), asks, last.seq), [(0, len(m.payload)) for m in found]
