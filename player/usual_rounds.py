"""What clients hear tick by tick: a round of data in one piece of bytes, handed out at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Protocol

from player.codes import Interface, MessageType, PlayerRequest
from player.familiar import STEP, Familiar
from player.header import HEADER_SIZE, Message

_PLAYER = int(Interface.PLAYER)
_DATA, _, _, _ACK, _SYNCH, _ = map(int, MessageType)


class Taker(Protocol):
    """Who gets data: a proxy."""

    def take(self, subtype: int, payload: bytes, time: float) -> None:
        """Takes one message over; may raise."""


Routes = Mapping[tuple[int, ...], Sequence[Taker]]
"""Who gets the data of each device, by its interface and index."""

Handing = tuple[Callable[[int, bytes, float], None], int, int, int]
"""Who takes data, its subtype, where its payload is among a piece's parts, and where it ends among
the piece's bytes."""


class Round(NamedTuple):
    """What a familiar piece is: a round, from its acknowledgement to its end."""

    handings: tuple[Handing, ...]
    stamp: int
    """Where its last timestamp is among its parts."""


class UsualRounds:
    """Knows the rounds of one connection that look like rounds before, and who gets their data.

    `routes` are those of the connection: `forget` is to be called when they have changed.
    """

    __slots__ = ("_familiar", "_routes", "rest", "time")

    def __init__(self, routes: Routes) -> None:
        self._routes = routes
        self._familiar = Familiar(self._read)
        self.time = 0.0
        """Timestamp of what was handed out last, seconds."""
        self.rest = b""
        """What is left of a round of which somebody could not take his part."""

    def hand_out(self, data: bytes) -> bool:
        """Hands a round out, if all of it is here and it is familiar; False otherwise.

        Raises what a taker raises: `rest` begins behind what that one was given.
        """
        found = self._familiar.match(data)
        if found is None:
            return False
        round, parts = found
        at, end = round.stamp + 2, 0
        try:
            for take, subtype, at, end in round.handings:  # noqa: B007 - for who raises
                take(subtype, parts[at], parts[at - 2])
        except BaseException:
            self.time, self.rest = parts[at - 2], data[end:]
            raise
        self.time = parts[round.stamp]
        return True

    def learn(self, data: bytes) -> None:
        """Remembers a piece, if it is a whole round."""
        self._familiar.learn(data)

    def forget(self) -> None:
        """Other devices are subscribed, or for others."""
        self._familiar.forget()

    def _read(self, found: list[Message]) -> Round | None:
        first, last = found[0], found[-1]
        if first[2:6] != (_PLAYER, 0, _ACK, PlayerRequest.DATA) or last.type != _SYNCH:
            return None
        handings: list[Handing] = []
        end = HEADER_SIZE + len(first.payload)
        at = STEP - 1
        for message in found[1:-1]:
            if message.type != _DATA:
                return None
            end += HEADER_SIZE + len(message.payload)
            at += STEP
            for taker in self._routes.get((message.interf, message.index), ()):
                handings.append((taker.take, message.subtype, at, end))
        return Round(tuple(handings), at - 2)
