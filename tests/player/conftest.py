"""A server, and sockets that are closed in the end."""

import socket

import pytest

from player.server import Server
from tests.patience import PATIENCE


@pytest.fixture
def server():
    with Server() as server:
        yield server


@pytest.fixture
def sockets():
    """Makes client sockets; closes them in the end."""
    made = []

    def connect(address):
        sock = socket.create_connection(address, timeout=PATIENCE)
        made.append(sock)
        return sock

    connect.pair = lambda: made.extend(socket.socketpair()) or made[-2:]
    yield connect
    for sock in made:
        sock.close()
