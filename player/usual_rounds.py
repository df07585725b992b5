"""What clients hear tick by tick: a round of data in one piece of bytes.

A round that is like one before, with data that its proxies know how to take unread, is kept as it
came: what is in it is read when somebody looks. Otherwise its data are handed out at once.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

from player.codes import Interface, MessageType, PlayerRequest
from player.familiar import TIME_AT, Familiar, Stretch
from player.header import HEADER_SIZE, TIME, Message

_PLAYER = int(Interface.PLAYER)
_DATA, _, _, _ACK, _SYNCH, _ = map(int, MessageType)


class Place(NamedTuple):
    """Where a message of data lies in a round."""

    subtype: int
    begin: int
    """Where its payload begins and ends."""
    end: int
    same: bytes
    """Of the payload, what is the same in all rounds like this one."""


class Taker(Protocol):
    """Who gets data: a proxy."""

    fresh: bool
    """Whether data came with the last reading."""

    def take(self, subtype: int, payload: bytes, time: float) -> None:
        """Takes one message over; may raise."""

    def alike(self, subtype: int, payload: bytes) -> Stretch | None:
        """Where data that can be taken unread may differ from this; None if none can."""

    def lie(self, place: Place, kept: bool) -> None:
        """Its data lie in the round from now on, at one place, until it is to `settle`.

        `kept`: they are like those before, but for what `alike` told.
        """

    def settle(self, subtype: int, payload: bytes, time: float) -> None:
        """This is what lies in the round for it, which is going."""


Routes = Mapping[tuple[int, ...], Sequence[Taker]]
"""Who gets the data of each device, by its interface and index."""


class Round(NamedTuple):
    """What a familiar piece is: a round, from its acknowledgement to its end."""

    handings: tuple[tuple[Taker, Place], ...]
    """Who gets what, in its order."""
    places: dict[Taker, Place]
    """The same where all of it can be taken unread, and empty otherwise."""
    last: int
    """Where the last timestamp before the end is."""


_NONE = Round((), {}, 0)


class UsualRounds:
    """Knows the rounds of one connection that look like rounds before, and who gets their data.

    `routes` are those of the connection: `forget` is to be called when they have changed.
    """

    __slots__ = (
        "_familiar",
        "_round",
        "_routes",
        "_time",
        "data",
        "fresh",
        "handed",
        "looked",
        "rest",
    )

    def __init__(self, routes: Routes) -> None:
        self._routes = routes
        self._familiar = Familiar(self._read)
        self._round = _NONE
        self._time = 0.0
        self.data = b""
        """The round in which data lie."""
        self.fresh = False
        """Whether it is what the last reading brought."""
        self.looked: list[tuple[dict[str, Any], str]] = []
        """What has been read of it and differs in the next: values, by their names."""
        self.handed: list[Taker] = []
        """Who was handed data by the last reading."""
        self.rest = b""
        """What is left of a round of which somebody could not take his part."""

    @property
    def time(self) -> float:
        """Timestamp of what was handed out last, seconds."""
        return self._stamp(self._round.last) if self.data else self._time

    def _stamp(self, at: int) -> float:
        time: float = TIME.unpack_from(self.data, at)[0]
        return time

    def begin(self) -> None:
        """A reading begins: what came before it is not fresh any more."""
        self.fresh = False
        if self.handed:
            for taker in self.handed:
                taker.fresh = False
            self.handed.clear()

    def hand_out(self, data: bytes) -> bool:
        """Hands a round out, if all of it is here and it is familiar; False otherwise.

        Raises what a taker raises: `rest` begins behind what that one was given.
        """
        found = self._familiar.match(data)
        if found is None:
            return False
        if found is not self._round:
            if not found.places:
                self._give(found, data)
                return True
            self._turn(found)
        self.data = data
        self.fresh = True
        if self.looked:
            for values, name in self.looked:
                values.pop(name, None)
            self.looked.clear()
        return True

    def _turn(self, found: Round) -> None:
        """Data lie elsewhere from now on, or look another way."""
        before = self._round.places
        if before.keys() != found.places.keys():
            self.settle()
            before = {}
        self._round = found
        for taker, place in found.places.items():
            had = before.get(taker)
            kept = had is not None and had.same == place.same and had.subtype == place.subtype
            taker.lie(place, kept)

    def _give(self, found: Round, data: bytes) -> None:
        self.settle()
        at, end = found.last, 0
        try:
            for taker, place in found.handings:
                at, end = place.begin - HEADER_SIZE + TIME_AT, place.end
                time: float = TIME.unpack_from(data, at)[0]
                self.handed.append(taker)
                taker.take(place.subtype, data[place.begin : end], time)
        except BaseException:
            self.rest = data[end:]
            raise
        finally:
            self._time = TIME.unpack_from(data, at)[0]

    def stamp(self, taker: Taker) -> float | None:
        """The timestamp of what lies here for a taker, seconds; None if nothing does."""
        place = self._round.places.get(taker)
        return None if place is None else self._stamp(place.begin - HEADER_SIZE + TIME_AT)

    def brought(self, taker: Taker) -> bool:
        """Whether the last reading has brought what lies here for a taker."""
        return self.fresh and taker in self._round.places

    def settle(self) -> None:
        """What lies here is to go: all take it over."""
        if self._round is _NONE:
            return
        data, round = self.data, self._round
        self._time = self.time
        for taker, place in round.places.items():
            time = self._stamp(place.begin - HEADER_SIZE + TIME_AT)
            taker.settle(place.subtype, data[place.begin : place.end], time)
        self._round, self.data, self.fresh = _NONE, b"", False
        self.looked.clear()

    def learn(self, data: bytes) -> None:
        """Remembers a piece, if it is a whole round."""
        self._familiar.learn(data)

    def forget(self) -> None:
        """Other devices are subscribed, or for others."""
        self.settle()
        self._familiar.forget()

    def _read(self, found: list[Message]) -> tuple[Round, list[Stretch]] | None:
        first, last = found[0], found[-1]
        if first[2:6] != (_PLAYER, 0, _ACK, PlayerRequest.DATA) or last.type != _SYNCH:
            return None
        handings: list[tuple[Taker, Place]] = []
        stretches: list[Stretch] = [(0, len(first.payload))]
        unread = True
        stamp, end = 0, HEADER_SIZE + len(first.payload)
        for message in found[1:-1]:
            if message.type != _DATA:
                return None
            payload = message.payload
            stamp, begin, end = end, end + HEADER_SIZE, end + HEADER_SIZE + len(payload)
            takers = self._routes.get((message.interf, message.index), ())
            alike = {taker.alike(message.subtype, payload) for taker in takers}
            stretch = alike.pop() if alike else (0, len(payload))
            if alike or stretch is None:
                unread = False
                stretch = 0, len(payload)
            stretches.append(stretch)
            same = payload[: stretch[0]] + payload[stretch[1] :]
            place = Place(message.subtype, begin, end, same)
            handings += [(taker, place) for taker in takers]
        stretches.append((0, len(last.payload)))
        places = dict(handings)
        if not unread or len(places) != len(handings):
            places = {}
            stretches = [(0, len(message.payload)) for message in found]
        return Round(tuple(handings), places, stamp + TIME_AT), stretches
