"""The server's sockets, seen by raw clients that know nothing of our code but its bytes."""

import os
import struct

import pytest
from server_talk import BASE, directory, exactly, handle, message, publish
from wire_talk import (
    ACK,
    ASK,
    BANNER,
    DATA,
    DATAMODE,
    DEV,
    DEVLIST,
    GET_DATA,
    NACK,
    PLAYER,
    PULL,
    REQ,
    SYNCH,
    data_mode,
    open_device,
    say,
    velocity,
)

from player.codes import DeviceAddr
from player.directory import Directory
from player.server import Connected, Disconnected
from player.session import Command, Subscribed
from tests.patience import PATIENCE


def test_a_tcp_client_reads_a_round(server, sockets):
    address = server.listen("127.0.0.1", 0, directory())
    client = sockets(address)
    assert handle(server, [Connected])[0][0].port == address[1]
    assert exactly(client, 32) == BANNER
    client.sendall(data_mode(PULL) + open_device(*BASE))
    handle(server, [Subscribed])
    assert message(client)[2:4] == (ACK, DATAMODE)
    assert message(client)[2:4] == (ACK, DEV)
    client.sendall(velocity(0.5) + ASK)
    seen = handle(server, [Command])
    assert seen[0][1].message["vel"].x == 0.5
    publish(server)
    assert message(client)[2:4] == (ACK, GET_DATA)
    assert message(client)[2:4] == (DATA, 1)
    assert message(client)[2:4] == (SYNCH, 1)


def test_headers_tell_the_port_that_was_bound(server, sockets):
    address = server.listen("127.0.0.1", 0, directory())
    client = sockets(address)
    handle(server, [Connected])
    client.sendall(say(PLAYER, 0, REQ, DEVLIST))
    server.poll(PATIENCE)
    server.flush()
    exactly(client, 32)
    header = exactly(client, 40)
    assert struct.unpack_from(">II", header) == (0x0100007F, address[1])
    size = struct.unpack_from(">I", header, 36)[0]
    rows = struct.unpack(">2I8I", exactly(client, size))
    assert rows == (2, 2, 0x0100007F, address[1], 4, 0, 0x0100007F, address[1], 6, 0)


def test_an_adopted_socket_speaks_the_same_protocol(server, sockets):
    ours, client = sockets.pair()
    connection = server.adopt(ours, directory(), peer="robot r1")
    server.flush()
    assert exactly(client, 32) == BANNER
    client.sendall(data_mode(PULL) + open_device(*BASE) + ASK)
    handle(server, [Subscribed])
    assert [message(client)[2:4] for _ in range(2)] == [(ACK, DATAMODE), (ACK, DEV)]
    assert connection.session.waiting
    publish(server)
    assert [message(client)[2] for _ in range(3)] == [ACK, DATA, SYNCH]
    assert connection.peer == "robot r1"


def test_a_client_that_goes_is_reported_once(server, sockets):
    ours, client = sockets.pair()
    connection = server.adopt(ours, directory())
    client.sendall(open_device(*BASE) + velocity(1.0)[:50])
    client.close()
    seen = handle(server, [Disconnected])
    assert [type(event) for _, event in seen] == [Subscribed, Disconnected]
    assert not connection.is_open
    assert server.connections == set()
    publish(server)
    assert server.poll(0) == []


def test_last_words_are_heard_though_nobody_listens_any_more(server, sockets):
    """A controller that says something and ends, while the server writes to it."""
    ours, client = sockets.pair()
    connection = server.adopt(ours, directory(), patient=False)
    client.sendall(open_device(*BASE))
    handle(server, [Subscribed])
    client.sendall(velocity(0.75))
    client.close()
    publish(server)
    assert connection.is_open
    seen = handle(server, [Disconnected])
    assert [type(event) for _, event in seen] == [Command, Disconnected]
    assert seen[0][1].message["vel"].x == 0.75


def test_closing_a_connection_sends_what_was_said(server, sockets):
    ours, client = sockets.pair()
    connection = server.adopt(ours, directory())
    connection.close()
    assert exactly(client, 32) == BANNER
    assert client.recv(1) == b""
    connection.close()
    assert server.poll(0) == []


def test_a_taken_port_is_an_error_that_names_it(server):
    host, port = server.listen("127.0.0.1", 0, directory())
    with pytest.raises(OSError, match=f"cannot listen on {host}:{port}"):
        server.listen(host, port, directory())


def test_ports_have_their_own_devices(server, sockets):
    other = Directory({DeviceAddr(5, 0): "sonar"})
    first = sockets(server.listen("127.0.0.1", 0, directory()))
    second = sockets(server.listen("127.0.0.1", 0, other))
    for client in (first, second):
        client.sendall(open_device(5))
    handle(server, [Subscribed])
    while server.poll(0.05):
        server.flush()
    server.flush()
    assert exactly(first, 32) == exactly(second, 32) == BANNER
    assert message(first)[2] == NACK
    assert message(second)[2] == ACK


def test_other_files_can_be_waited_for(server):
    inside, outside = os.pipe()
    heard = []
    try:
        server.watch(inside, lambda: heard.append(os.read(inside, 9)))
        os.write(outside, b"hello")
        assert server.poll(PATIENCE) == []
        assert heard == [b"hello"]
        server.unwatch(inside)
        os.write(outside, b"again")
        server.poll(0)
        assert heard == [b"hello"]
    finally:
        os.close(inside)
        os.close(outside)
