"""What bad, slow and vanished clients cost the server, and how many it takes."""

import errno
import socket
import struct

import pytest
from server_talk import BASE, directory, ended, exactly, handle, message, publish
from wire_talk import BANNER, DATA, DEVLIST, NACK, PLAYER, REQ, hear, open_device, say, velocity

from player.codes import DeviceAddr
from player.directory import Directory
from player.server import Connected, Disconnected, Server
from player.session import Command, Malformed, Subscribed
from tests.patience import PATIENCE


@pytest.mark.parametrize(
    "garbage",
    [
        b"GET / HTTP/1.1\r\nHost: localhost:6665\r\nConnection: close\r\n\r\n",
        bytes(range(256)),
        struct.pack(">6IdII", 0, 0, 6, 0, 3, 1, 0.0, 0, 0x7FFFFFFF),
    ],
)
def test_garbage_closes_that_connection_and_no_other(server, sockets, garbage):
    address = server.listen("127.0.0.1", 0, directory())
    good, bad = sockets(address), sockets(address)
    bad.sendall(garbage)
    seen = handle(server, [Malformed, Disconnected])
    loser = next(c for c, e in seen if isinstance(e, Malformed))
    assert not loser.is_open
    assert ended(bad)
    good.sendall(say(5, 0, REQ, 1))
    server.poll(PATIENCE)
    server.flush()
    assert exactly(good, 32) == BANNER
    assert message(good)[2] == NACK


def test_a_slow_reader_costs_bounded_memory_and_can_still_command(server, sockets):
    """In push mode, never reading, as programs do that only drive."""
    ours, client = sockets.pair()
    connection = server.adopt(ours, directory(), patient=False)
    client.sendall(open_device(*BASE))
    handle(server, [Subscribed])
    for _ in range(3000):
        publish(server, bytes(1400))
    assert connection.unsent <= 1024 * 1440
    assert connection.session.dropped > 0
    client.sendall(velocity(0.25))
    seen = handle(server, [Command])
    assert seen[0][1].message["vel"].x == 0.25
    # It reads on, and all that it gets is whole messages.
    client.setblocking(False)
    data = b""
    quiet = 0
    while quiet < 3:
        server.poll(0)
        server.flush()
        try:
            data += client.recv(1 << 20)
            quiet = 0
        except BlockingIOError:
            quiet += 1
    found, rest = hear(data[32:])
    assert rest == b""
    assert sum(m.type == DATA for m in found) > 1024


def test_a_flood_without_reading_stops_being_read(server, sockets):
    ours, client = sockets.pair()
    many = Directory({DeviceAddr(5, i): "many" for i in range(300)})
    connection = server.adopt(ours, many, patient=False)
    client.setblocking(False)
    question = say(PLAYER, 0, REQ, DEVLIST) * 100
    sent = 0
    for _ in range(200):
        try:
            sent += client.send(question)
        except BlockingIOError:
            break
        server.poll(0)
        server.flush()
    else:
        pytest.fail("the server has read every question")
    held = connection.unsent + connection.session.backlog
    assert held < 4 << 20  # 1 MB of replies to be written, 1 MB more made, 5 kB each
    data = b""
    answers = 0
    idle = 0
    while answers < sent // 40:
        try:
            data += client.recv(1 << 20)
            idle = 0
        except BlockingIOError:
            idle += 1
            assert idle < 100, f"{answers} answers to {sent // 40} questions"
            server.poll(0)
            server.flush()
        found, data = hear(data.removeprefix(BANNER))
        answers += len(found)
    assert connection.is_open
    assert connection.unsent == connection.session.backlog == 0


def test_connections_beyond_the_limit_are_closed_at_once(sockets):
    with Server(max_connections=2) as server:
        address = server.listen("127.0.0.1", 0, directory())
        first, second = sockets(address), sockets(address)
        while len(server.connections) < 2:
            server.poll(PATIENCE)
        third = sockets(address)
        server.poll(PATIENCE)
        assert ended(third)
        assert exactly(second, 32) == BANNER
        first.close()
        handle(server, [Disconnected])
        fourth = sockets(address)
        handle(server, [Connected])
        assert exactly(fourth, 32) == BANNER


def test_the_listener_sleeps_while_there_is_no_room_for_a_socket(server, sockets, monkeypatch):
    """Out of file descriptors, it neither spins nor fails, and takes the client later."""
    address = server.listen("127.0.0.1", 0, directory())
    ours, _ = sockets.pair()
    connection = server.adopt(ours, directory())
    real = socket.socket.accept

    def full(self):
        raise OSError(errno.EMFILE, "too many open files")

    monkeypatch.setattr(socket.socket, "accept", full)
    client = sockets(address)
    assert server.poll(PATIENCE) == []
    assert server.poll(0) == []
    monkeypatch.setattr(socket.socket, "accept", real)
    connection.close()
    handle(server, [Connected])
    assert exactly(client, 32) == BANNER


def test_clients_that_vanish_in_all_ways_leave_nothing(server, sockets):
    address = server.listen("127.0.0.1", 0, directory())
    for step in range(30):
        client = socket.create_connection(address, timeout=PATIENCE)
        if step % 3 == 1:
            client.sendall(velocity(1.0)[:step])
        if step % 3 == 2:  # a reset instead of an end
            client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        client.close()
    gone = 0
    while gone < 30:
        gone += sum(isinstance(event, Disconnected) for _, event in server.poll(PATIENCE))
        server.flush()
    assert server.connections == set()
    assert sockets(address).recv(0) == b""
