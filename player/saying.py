"""What a client says, as bytes."""

from __future__ import annotations

from player import messages
from player.codes import Access, DeviceAddr, Interface, MessageType, PlayerRequest
from player.errors import XdrError
from player.header import MAX_REQUEST, pack_message
from player.xdr import Values

_REQ = int(MessageType.REQ)

REQUEST_DATA = pack_message(Interface.PLAYER, 0, _REQ, PlayerRequest.DATA)
"""The request for a round of data."""


def encoded(addr: DeviceAddr, type_: int, subtype: int, values: Values) -> bytes:
    """A message with its header; raises XdrError where its values do not fit.

    Or where one is no finite number: no robot can do anything with that. Or where all of them are
    more than a server takes in one message: it would hang up.
    """
    spec = messages.known(addr.interf, type_, subtype)
    payload = spec.encode(values)
    spec.check_finite(values)
    if len(payload) > MAX_REQUEST:
        raise XdrError(f"{spec!r}: {len(payload)} bytes are too many (at most {MAX_REQUEST})")
    return pack_message(*addr, type_, subtype, payload)


def access_to(addr: DeviceAddr, access: Access) -> Values:
    """The fields of a request to open or to close a device."""
    return {"addr": (0, 0, *addr), "access": access, "driver": ""}


def request_name(addr: DeviceAddr, subtype: int) -> str:
    """A request as errors name it."""
    spec = messages.find(addr.interf, _REQ, subtype)
    return f"{spec.name if spec else subtype} of {addr}"
