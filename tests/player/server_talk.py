"""What the tests of the server's sockets share: a server, sockets, and how both are heard."""

import struct

import pytest
from wire_talk import LASER, POSITION2D, hear

from player.codes import DeviceAddr
from player.directory import Directory
from player.session import Request
from tests.patience import PATIENCE

BASE = DeviceAddr(POSITION2D, 0)


def directory():
    return Directory({BASE: "wheels", DeviceAddr(LASER, 0): "eye"})


def handle(server, wanted):
    """Polls and flushes, refusing requests, until `wanted` kinds of events have come."""
    seen = []
    while not all(any(type(e) is kind for _, e in seen) for kind in wanted):
        for connection, event in server.poll(PATIENCE) or pytest.fail("nothing has come"):
            if isinstance(event, Request):
                connection.session.refuse(event)
            seen.append((connection, event))
        server.flush()
    return seen


def exactly(sock, size):
    data = b""
    while len(data) < size:
        got = sock.recv(size - len(data))
        assert got, f"closed after {len(data)} of {size} bytes"
        data += got
    return data


def message(sock):
    header = exactly(sock, 40)
    size = struct.unpack_from(">I", header, 36)[0]
    return hear(header + exactly(sock, size))[0][0]


def publish(server, payload=b"data", addr=BASE):
    for connection in server.connections:
        connection.session.publish(addr, 1, payload, 1.0)
        connection.session.end_of_round()
    server.flush()


def ended(sock):
    """True once the server has closed: the end of the bytes, or a reset."""
    try:
        while sock.recv(1 << 16):
            pass
    except ConnectionResetError:
        pass
    return True
