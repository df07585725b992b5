"""What a client's bytes mean to the owner of the devices: events of a session."""

from __future__ import annotations

from typing import NamedTuple

from player.codes import DataMode, DeviceAddr
from player.xdr import Values


class Subscribed(NamedTuple):
    """The client has subscribed a device (for the first time, or again after a close)."""

    addr: DeviceAddr


class Unsubscribed(NamedTuple):
    """The client has closed its last subscription of a device."""

    addr: DeviceAddr


class Command(NamedTuple):
    """A command to an existing device; `name` is the table's (`velocity`). Never answered."""

    addr: DeviceAddr
    subtype: int
    message: Values
    name: str


class Request(NamedTuple):
    """A request to an existing device: exactly one of `acknowledge` and `refuse` is due."""

    addr: DeviceAddr
    subtype: int
    message: Values
    name: str
    number: int
    seq: int


class DataRequested(NamedTuple):
    """The client waits for the next data. `served`: there was some, and it has gone out."""

    served: bool


class ModeChanged(NamedTuple):
    """The client has chosen to be sent data (push) or to ask for it (pull)."""

    mode: DataMode


class Ignored(NamedTuple):
    """A message that Player would warn about and pass over: no such device or command."""

    reason: str


class Malformed(NamedTuple):
    """The bytes are not the protocol: the connection is to be closed."""

    reason: str


Event = (
    Subscribed
    | Unsubscribed
    | Command
    | Request
    | DataRequested
    | ModeChanged
    | Ignored
    | Malformed
)
