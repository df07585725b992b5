"""What all proxies have in common: a subscription, and data that comes in."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

from player import messages
from player.client import PlayerClient
from player.codes import DeviceAddr, Interface, MessageType
from player.errors import NoReading
from player.familiar import Stretch
from player.usual_rounds import Place, UsualRounds
from player.xdr import Pose3d, Values


class Size(NamedTuple):
    """An extent in metres: along x, y and z of the thing's own frame."""

    length: float
    width: float
    height: float


class Geometry(NamedTuple):
    """Where a device (or robot) is on its carrier, metres and radians, and how large it is."""

    pose: Pose3d
    size: Size


def geometry(values: Values) -> Geometry:
    """The geometry in a reply; its wire order is width, length, height."""
    width, length, height = values["size"]
    return Geometry(values["pose"], Size(length, width, height))


class _Reading:
    """What stands in a proxy's class for a value that data brings; an instance's own hides it."""

    def __init__(self, make: Callable[[Any], Any] | None) -> None:
        self._make = make

    def __set_name__(self, owner: type[Proxy], name: str) -> None:
        self._name = name

    def __get__(self, proxy: Proxy | None, owner: type[Proxy]) -> Any:
        if proxy is None:
            return self
        value = None if self._make is None else self._make(proxy)
        if value is not None:
            proxy.__dict__[self._name] = value
            if proxy._place is not None:
                proxy.rounds.looked.append((proxy.__dict__, self._name))
            return value
        if proxy._place is not None:
            proxy._read_up(proxy._place)
            return proxy.__dict__[self._name]
        raise NoReading(
            f"{proxy.addr} has sent no {self._name} yet: call read() first "
            "(a proxy's `valid` says whether a reading has come)"
        )


def reading(make: Callable[[Any], Any] | None = None) -> Any:
    """A proxy's value that data brings: whoever looks at it before gets NoReading.

    `make(proxy)`: makes the value of the last data when it is first looked at, None if it cannot;
    the proxy takes the one before out of its `__dict__` when new data comes.
    """
    return _Reading(make)


class Proxy:
    """A device that this client has subscribed.

    What its data brings (ranges, poses, blobs) is there from the first `read` that brings it;
    before, it raises NoReading.

    `index` is the device's; the client's own (PLAYER_INDEX, else 0) if left out. Raises
    PlayerRefused if the server has no such device.
    """

    interface: ClassVar[Interface]
    varying: ClassVar[tuple[str, ...]] = ()
    """The readings that differ among data that are `alike`."""
    rounds: UsualRounds
    """Where data lie that are read when somebody looks."""
    _readings: ClassVar[tuple[str, ...]] = ()
    _place: Place | None = None  # where in the round the data lie

    def __init_subclass__(cls) -> None:
        own = vars(cls)
        cls._readings += tuple(name for name, kind in own.items() if isinstance(kind, _Reading))
        if "alike" not in own and ("decode" in own or "take" in own):
            cls.alike = Proxy.alike  # type: ignore[method-assign]  # it wants to see all data

    def __init__(self, client: PlayerClient, index: int | None = None) -> None:
        self.client = client
        self.addr = DeviceAddr(int(self.interface), client.index if index is None else index)
        self._time = 0.0
        self._fresh = False
        self.valid = False
        """True once data has come."""
        self.driver = client.subscribe(self)
        """The name of the driver behind the device, as the server gave it."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.addr} at {self.client.address}>"

    def close(self) -> None:
        """Ends the subscription; the proxy keeps its last data."""
        self.client.unsubscribe(self)

    @property
    def time(self) -> float:
        """Timestamp of the last data, seconds of simulated time."""
        stamp = None if self._place is None else self.rounds.stamp(self)
        return self._time if stamp is None else stamp

    @property
    def fresh(self) -> bool:
        """True if data came with the last `read`."""
        return self._fresh or (self._place is not None and self.rounds.brought(self))

    @fresh.setter
    def fresh(self, fresh: bool) -> None:
        self._fresh = fresh

    def take(self, subtype: int, payload: bytes, time: float) -> None:
        """Called by the client for each message of data from the device."""
        self._time = time
        self._fresh = True
        self.valid = True
        self.decode(subtype, payload)

    def decode(self, subtype: int, payload: bytes) -> None:
        """Takes over one message of data; raises XdrError if it is not the interface's."""

    # -- data that nobody has looked at -----------------------------------------------------

    def alike(self, subtype: int, payload: bytes) -> Stretch | None:
        """Where data that need not be read before somebody looks may differ from this.

        The first byte and the one behind the last: what is the same elsewhere makes sense whatever
        stands between. None if data are to be read as they come, as those of a proxy of one's own.
        """
        return None

    def lie(self, place: Place, kept: bool) -> None:
        """Called by the client: where in a round the data are that come from now on.

        `kept`: they are like those before, but for what `alike` told.
        """
        self._place = place
        if not kept:
            for name in self._readings:
                self.__dict__.pop(name, None)

    def settle(self, subtype: int, payload: bytes, time: float) -> None:
        """Called by the client: the round goes in which this lies; what is read of it stays."""
        self._place = None
        self._time = time
        values = self.__dict__
        seen = {name: values[name] for name in self._readings if name in values}
        self.decode(subtype, payload)
        values.update(seen)

    def _read_up(self, place: Place) -> None:
        """Reads all that lies there."""
        self.decode(place.subtype, self.rounds.data[place.begin : place.end])
        self.rounds.looked += [(self.__dict__, name) for name in self.varying]

    def _table(self, subtype: int, payload: bytes) -> Values | None:
        """Fields of data by the message table; None for data that it does not list."""
        spec = messages.find(self.addr.interf, MessageType.DATA, subtype)
        return None if spec is None else spec.decode(payload)

    def _request(self, subtype: int, /, **message: Any) -> Values:
        return self.client.request(self.addr, subtype, message)

    def _command(self, subtype: int, /, **message: Any) -> None:
        self.client.command(self.addr, subtype, message)
