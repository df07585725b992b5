"""A Player client and server made of struct alone: what tests say to our code, and hear from it."""

import struct
from typing import NamedTuple

HEADER = struct.Struct(">6IdII")
DATA, CMD, REQ, ACK, SYNCH, NACK = range(1, 7)
PLAYER, POSITION2D, LASER, RANGER = 1, 4, 6, 62
DEVLIST, DRIVERINFO, DEV, GET_DATA, DATAMODE, RULE = 1, 2, 3, 4, 5, 10
PUSH, PULL = 1, 2
BANNER = b"Player v.3.1.1-dev" + bytes(14)


class Heard(NamedTuple):
    interf: int
    index: int
    type: int
    subtype: int
    time: float
    seq: int
    payload: bytes


def say(interf, index, type_, subtype, payload=b"", time=0.0, seq=0):
    return HEADER.pack(0, 0, interf, index, type_, subtype, time, seq, len(payload)) + payload


def hear(data):
    """The whole messages at the start of `data`, and what is left."""
    found = []
    start = 0
    while len(data) - start >= HEADER.size:
        _, _, interf, index, type_, subtype, time, seq, size = HEADER.unpack_from(data, start)
        end = start + HEADER.size + size
        if len(data) < end:
            break
        payload = data[start + HEADER.size : end]
        found.append(Heard(interf, index, type_, subtype, time, seq, payload))
        start = end
    return found, data[start:]


def kinds(data):
    """What `data` holds, as (type, subtype) of each message; no byte may be left."""
    found, rest = hear(data)
    assert rest == b""
    return [(message.type, message.subtype) for message in found]


def open_device(interf, index=0, access=1):
    return say(PLAYER, 0, REQ, DEV, struct.pack(">7I", 0, 0, interf, index, access, 0, 0))


def data_mode(mode):
    return say(PLAYER, 0, REQ, DATAMODE, struct.pack(">I", mode))


def replace_rule(interf=-1, index=-1, type_=DATA, subtype=-1, replace=1):
    return say(PLAYER, 0, REQ, RULE, struct.pack(">5i", interf, index, type_, subtype, replace))


def velocity(speed, index=0):
    return say(POSITION2D, index, CMD, 1, struct.pack(">3dI", speed, 0.0, 0.0, 1))


ASK = say(PLAYER, 0, REQ, GET_DATA)
