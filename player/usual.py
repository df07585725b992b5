"""What usually comes, tick by tick: commands with a request for data, and a round of data.

Each is read from messages once, for `Familiar` to remember; what does not come tick by tick, or
does not lie in the same way each time, is None.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from player import messages
from player.codes import DeviceAddr, Interface, MessageType, PlayerRequest
from player.errors import XdrError
from player.familiar import STEP
from player.header import HEADER_SIZE, Message
from player.xdr import Values

_PLAYER = int(Interface.PLAYER)
_DATA, _CMD, _REQ, _ACK, _SYNCH, _ = map(int, MessageType)

CommandAt = tuple[DeviceAddr, int, str, Callable[[bytes], Values], int]
"""To which device a command goes, its subtype and name, what reads its payload, and where among a
piece's parts that is."""


class Commands(NamedTuple):
    """What a client says in one piece: commands, then a request for data or none."""

    commands: tuple[CommandAt, ...]
    asks: bool
    seq: int
    """Of that request."""


def read_commands(found: list[Message]) -> Commands | None:
    """Commands of fixed size, and a request for data behind them or none."""
    last = found[-1]
    asks = last[2:6] == (_PLAYER, 0, _REQ, PlayerRequest.DATA)
    commands = []
    for number, message in enumerate(found[:-1] if asks else found):
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
        commands.append((addr, spec.subtype, spec.name, read, STEP * number + STEP - 1))
    return Commands(tuple(commands), asks, last.seq)


DataAt = tuple[int, int, tuple[int, int], int]
"""Data in a piece that is a round: where its payload is among the piece's parts, its subtype and
its device, and where it ends among the piece's bytes."""


def read_round(found: list[Message]) -> list[DataAt] | None:
    """The data of a round that is whole, from its acknowledgement to its end."""
    first, last = found[0], found[-1]
    if first[2:6] != (_PLAYER, 0, _ACK, PlayerRequest.DATA) or last.type != _SYNCH:
        return None
    data: list[DataAt] = []
    end = HEADER_SIZE + len(first.payload)
    for number, message in enumerate(found[1:-1], start=1):
        if message.type != _DATA:
            return None
        end += HEADER_SIZE + len(message.payload)
        at = STEP * number + STEP - 1
        data.append((at, message.subtype, (message.interf, message.index), end))
    return data
