"""A scripted client that speaks Player's protocol by itself, on a plain socket.

It knows nothing of our packages: numbers, layouts and rules are written out again, so that a
mistake in them is not made twice alike. What is not as it should be is an AssertionError.
"""

from __future__ import annotations

import socket
import struct
from dataclasses import dataclass
from typing import Any, Self

from troupe.testing.patience import PATIENCE

DATA, CMD, REQ, ACK, SYNCH, NACK = 1, 2, 3, 4, 5, 6
PLAYER, POSITION2D, SONAR, LASER, BLOBFINDER, FIDUCIAL = 1, 4, 5, 6, 7, 10
SPEECH, BUMPER, DIO, SIMULATION, LOG, GRAPHICS2D, RANGER = 12, 14, 20, 31, 45, 55, 62
OPEN, CLOSE, ERROR = 1, 2, 3
PUSH, PULL = 1, 2

HEADER = struct.Struct(">IIIIIIdII")
BANNER_SIZE = 32


@dataclass(frozen=True)
class Got:
    """One message of the server's."""

    host: int
    robot: int
    interf: int
    index: int
    type: int
    subtype: int
    time: float
    seq: int
    payload: bytes

    def unpack(self, layout: str) -> tuple[Any, ...]:
        """The payload by a layout of the struct module, big-endian, to its last byte."""
        return struct.unpack(">" + layout, self.payload)


class Gone(Exception):
    """The server has closed the connection."""


def text(value: str) -> bytes:
    """A C string on the wire: count, count, bytes with NUL, padded to four."""
    return octets(value.encode() + b"\0")


def octets(value: bytes) -> bytes:
    """A byte array on the wire."""
    return struct.pack(">II", len(value), len(value)) + value + bytes(-len(value) % 4)


def message(
    interf: int, index: int, type_: int, subtype: int, payload: bytes = b"", seq: int = 0
) -> bytes:
    """Header and payload, as libplayerc sends them."""
    return HEADER.pack(0, 0, interf, index, type_, subtype, 0.0, seq, len(payload)) + payload


class RawClient:
    """One TCP connection to a Player server. Data that comes before a reply is kept in `data`."""

    def __init__(self, port: int, *, timeout: float = PATIENCE, host: str = "127.0.0.1") -> None:
        self.socket = socket.create_connection((host, port), timeout=timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.rest = b""
        self.banner = self.exactly(BANNER_SIZE)
        self.data: list[Got] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self.socket.close()

    # -- bytes ------------------------------------------------------------------------------

    def exactly(self, size: int) -> bytes:
        """So many bytes, or Gone."""
        while len(self.rest) < size:
            try:
                got = self.socket.recv(1 << 16)
            except ConnectionResetError:
                got = b""
            if not got:
                raise Gone
            self.rest += got
        found, self.rest = self.rest[:size], self.rest[size:]
        return found

    def receive(self) -> Got:
        """The next message."""
        host, robot, interf, index, type_, subtype, time, seq, size = HEADER.unpack(
            self.exactly(HEADER.size)
        )
        payload = self.exactly(size)
        return Got(host, robot, interf, index, type_, subtype, time, seq, payload)

    def send(self, *data: bytes) -> None:
        self.socket.sendall(b"".join(data))

    # -- messages ---------------------------------------------------------------------------

    def command(self, interf: int, index: int, subtype: int, payload: bytes = b"") -> None:
        self.send(message(interf, index, CMD, subtype, payload))

    def request(self, interf: int, index: int, subtype: int, payload: bytes = b"") -> Got:
        """The one reply to a request, which must be of its kind and carry its number."""
        seq = 1234
        self.send(message(interf, index, REQ, subtype, payload, seq))
        while (got := self.receive()).type in (DATA, SYNCH):
            self.data.append(got)
        assert got.type in (ACK, NACK)
        assert (got.interf, got.index, got.subtype, got.seq) == (interf, index, subtype, seq)
        return got

    def mode(self, mode: int) -> None:
        assert self.request(PLAYER, 0, 5, struct.pack(">I", mode)).type == ACK

    def access(self, interf: int, index: int, access: int) -> Got:
        device = struct.pack(">IIIIIII", 0, 0, interf, index, access, 0, 0)
        return self.request(PLAYER, 0, 3, device)

    def subscribe(self, interf: int, index: int = 0) -> None:
        got = self.access(interf, index, OPEN)
        assert got.type == ACK
        assert struct.unpack(">I", got.payload[16:20]) == (OPEN,)

    def devices(self) -> list[tuple[int, int]]:
        """The devices at this port: interface and index."""
        got = self.request(PLAYER, 0, 1)
        count, again, *rows = struct.unpack(f">{len(got.payload) // 4}I", got.payload)
        assert count == again == len(rows) / 4
        return [(rows[k + 2], rows[k + 3]) for k in range(0, len(rows), 4)]

    def ask(self) -> None:
        """Ask for data, without waiting for it."""
        self.send(message(PLAYER, 0, REQ, 4))

    def round(self) -> dict[tuple[int, int, int], Got]:
        """One round of pull mode: interface, index and subtype -> the data that came."""
        self.ask()
        return self.answer()

    def answer(self) -> dict[tuple[int, int, int], Got]:
        """What follows `ask`: one ACK, data (what was kept counts), and SYNCH."""
        found, self.data = self.data, []
        acknowledged = False
        while (got := self.receive()).type != SYNCH:
            if got.type == ACK:
                assert (got.interf, got.subtype, acknowledged) == (PLAYER, 4, False)
                acknowledged = True
            else:
                assert got.type == DATA, got
                found.append(got)
        assert acknowledged
        return {(got.interf, got.index, got.subtype): got for got in found if got.type == DATA}

    def drive(self, vx: float, wz: float = 0.0, index: int = 0, vy: float = 0.0) -> None:
        self.command(POSITION2D, index, 1, struct.pack(">dddI", vx, vy, wz, 1))


def pulling(port: int, *devices: tuple[int, int]) -> RawClient:
    """A client in pull mode with these devices (position2d:0 unless told)."""
    client = RawClient(port)
    client.mode(PULL)
    for interf, index in devices or [(POSITION2D, 0)]:
        client.subscribe(interf, index)
    return client


def pushed(port: int, *devices: tuple[int, int]) -> RawClient:
    """A client in push mode with these devices (position2d:0 unless told)."""
    client = RawClient(port)
    client.mode(PUSH)
    for interf, index in devices or [(POSITION2D, 0)]:
        client.subscribe(interf, index)
    return client
