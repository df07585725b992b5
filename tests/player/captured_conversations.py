"""Reads captured conversations between Player's own clients and servers; knows no code of ours.

A file is a list of records: 1 byte direction (C: the client's, S: the server's bytes), 8 bytes
wall time, 4 bytes length, then what one recv() returned.
"""

import gzip
import struct
from pathlib import Path
from typing import NamedTuple

NAMES = ("pull_r0", "push_r1", "pull_r2_6666", "misc_c_client")
BANNER_SIZE = 32

_RECORD = struct.Struct(">cdI")
_HEADER = struct.Struct(">6IdII")


class Captured(NamedTuple):
    host: int
    robot: int
    interf: int
    index: int
    type: int
    subtype: int
    time: float
    seq: int
    payload: bytes
    raw: bytes


def stream(name: str, direction: str) -> bytes:
    """All bytes of one direction ("C" or "S"), the server's banner included."""
    data = gzip.decompress((Path(__file__).parent / "data" / f"{name}.bin.gz").read_bytes())
    parts = []
    offset = 0
    while offset < len(data):
        who, _, size = _RECORD.unpack_from(data, offset)
        offset += _RECORD.size
        if who.decode() == direction:
            parts.append(data[offset : offset + size])
        offset += size
    return b"".join(parts)


def split(data: bytes) -> list[Captured]:
    """The messages in `data`, which holds nothing else."""
    found = []
    offset = 0
    while offset < len(data):
        *head, size = _HEADER.unpack_from(data, offset)
        end = offset + _HEADER.size + size
        payload = data[offset + _HEADER.size : end]
        assert len(payload) == size
        found.append(Captured(*head, payload, data[offset:end]))
        offset = end
    return found


def client_messages(name: str) -> list[Captured]:
    return split(stream(name, "C"))


def server_messages(name: str) -> list[Captured]:
    return split(stream(name, "S")[BANNER_SIZE:])
