"""The numbers of Player's protocol: interfaces, message types, modes, and device addresses."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple, Self

DEFAULT_PORT = 6665
"""The TCP port on which a Player server listens unless told otherwise."""

BANNER = b"Player v.3.1.1-dev".ljust(32, b"\0")
"""What a server says first: 32 bytes, padded with NUL. Clients print it and check nothing."""

BANNER_SIZE = len(BANNER)

QUEUE_LIMIT = 1024
"""Messages that a server keeps for one client before it drops further data (as Player does)."""

ANY = -1
"""Stands for every interface, index, type or subtype in a replace rule."""


class Interface(IntEnum):
    """Player's interface codes."""

    PLAYER = 1
    POWER = 2
    GRIPPER = 3
    POSITION2D = 4
    SONAR = 5
    LASER = 6
    BLOBFINDER = 7
    PTZ = 8
    FIDUCIAL = 10
    SPEECH = 12
    GPS = 13
    BUMPER = 14
    DIO = 20
    AIO = 21
    IR = 22
    WIFI = 23
    LOCALIZE = 25
    POSITION3D = 30
    SIMULATION = 31
    BLINKENLIGHT = 33
    CAMERA = 40
    MAP = 42
    PLANNER = 44
    LOG = 45
    JOYSTICK = 49
    OPAQUE = 51
    POSITION1D = 52
    ACTARRAY = 53
    GRAPHICS2D = 55
    GRAPHICS3D = 58
    IMU = 60
    POINTCLOUD3D = 61
    RANGER = 62
    VECTORMAP = 63


class MessageType(IntEnum):
    """What a message is: the header's type field."""

    DATA = 1
    CMD = 2
    REQ = 3
    ACK = 4
    SYNCH = 5
    NACK = 6


class PlayerRequest(IntEnum):
    """Requests to the server itself: subtypes of interface `player`."""

    DEVLIST = 1
    DRIVERINFO = 2
    DEV = 3
    DATA = 4
    DATAMODE = 5
    AUTH = 7
    NAMESERVICE = 8
    ADD_REPLACE_RULE = 10


class Access(IntEnum):
    """What a subscription request asks for, or that it failed."""

    OPEN = 1
    CLOSE = 2
    ERROR = 3


class DataMode(IntEnum):
    """Whether a server sends data as it comes, or when the client asks for it."""

    PUSH = 1
    PULL = 2


class Synch(IntEnum):
    """The end of a round of data in pull mode; OVERFLOW: some were dropped since the last one."""

    OK = 1
    OVERFLOW = 2


class Replace(IntEnum):
    """What a replace rule does with a message while an older one of its kind is still queued."""

    ACCEPT = 0
    REPLACE = 1
    IGNORE = 2


_NAMES = {int(interface): interface.name.lower() for interface in Interface}


class DeviceAddr(NamedTuple):
    """A device of one server (or port): interface code and index.

    >>> str(DeviceAddr(Interface.LASER, 1))
    'laser:1'
    """

    interf: int
    index: int = 0  # type: ignore[assignment]  # Player's name for it, not tuple's method

    def __str__(self) -> str:
        return f"{_NAMES.get(self.interf, f'interface{int(self.interf)}')}:{self.index}"

    @classmethod
    def parse(cls, text: str) -> Self:
        """The address that `text` names: `laser:1`, or `laser` for index 0.

        Raises ValueError where there is no such interface or the index is no number in 0..65535.

        >>> DeviceAddr.parse("laser:1") == DeviceAddr(Interface.LASER, 1)
        True
        """
        name, colon, number = text.partition(":")
        try:
            interface = Interface[name.strip().upper()]
        except KeyError:
            raise ValueError(
                f"{text!r}: no interface {name!r} (one of {', '.join(sorted(_NAMES.values()))})"
            ) from None
        if not colon:
            return cls(interface, 0)
        if not (number.isascii() and number.isdigit() and int(number) <= 0xFFFF):
            raise ValueError(f"{text!r}: the index after ':' is a number from 0 to 65535")
        return cls(interface, int(number))


def interface_name(code: int) -> str:
    """The interface's name in lower case, `interface99` for a code that is not Player's."""
    return _NAMES.get(code, f"interface{code}")
