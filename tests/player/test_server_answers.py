"""When the server answers: what is acknowledged at once, and what with the data."""

import socket

import pytest
from server_talk import BASE, directory, exactly, handle, message, publish
from wire_talk import (
    ACK,
    ASK,
    DATA,
    GET_DATA,
    NACK,
    PULL,
    REQ,
    SYNCH,
    data_mode,
    kinds,
    open_device,
    say,
    velocity,
)

from player.server import HELD_FOR, Connected
from player.session import Command, DataRequested, ModeChanged, Subscribed
from tests.patience import PATIENCE


def test_small_messages_are_not_held_back_by_nagle(server, sockets):
    sockets(server.listen("127.0.0.1", 0, directory()))
    [(connection, _)] = handle(server, [Connected])
    assert connection._socket.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_who_may_have_more_to_say_is_acknowledged_at_once(server, sockets, monkeypatch):
    """Linux takes that back by itself, and then each of the client's writes waits 40 ms."""
    asked = []
    monkeypatch.setattr("player.connection.quick_acknowledge", asked.append)
    client = sockets(server.listen("127.0.0.1", 0, directory()))
    [(connection, _)] = handle(server, [Connected])
    for times in (1, 2, 3):
        client.sendall(velocity(1.0))
        server.poll(PATIENCE)
        assert asked == [connection._socket] * times


def test_who_waits_for_data_is_acknowledged_with_the_data(server, sockets, monkeypatch):
    asked = []
    monkeypatch.setattr("player.connection.quick_acknowledge", asked.append)
    client = sockets(server.listen("127.0.0.1", 0, directory()))
    handle(server, [Connected])
    client.sendall(data_mode(PULL))
    handle(server, [ModeChanged])
    assert len(asked) == 1
    client.sendall(velocity(1.0) + ASK)
    handle(server, [Command, DataRequested])
    assert len(asked) == 1


def test_a_request_that_nagle_has_held_back_is_heard_with_the_command_before_it(
    server, sockets, monkeypatch
):
    """It is on its way as soon as the command is acknowledged."""
    ours, client = sockets.pair()
    monkeypatch.setattr("player.connection.quick_acknowledge", lambda sock: client.sendall(ASK))
    connection = server._add(ours, directory(), False, "as if over TCP", 6665)
    connection.session.receive(data_mode(PULL))
    client.sendall(velocity(1.0))
    heard = [type(event) for _, event in server.poll(PATIENCE)]
    assert heard == [Command, DataRequested]


def pulling(server, sockets):
    """A client over TCP that has asked for data, and been heard."""
    client = sockets(server.listen("127.0.0.1", 0, directory()))
    client.sendall(data_mode(PULL) + open_device(*BASE))
    handle(server, [Subscribed])
    exactly(client, 32)
    assert [message(client)[2] for _ in range(2)] == [ACK, ACK]
    client.sendall(ASK)
    while not any(type(event) is DataRequested for _, event in server.poll(PATIENCE)):
        pass
    client.setblocking(False)
    return client


def test_that_a_request_was_heard_is_told_with_the_data_in_one_piece(server, sockets, monkeypatch):
    monkeypatch.setattr("player.connection.monotonic", lambda: 0.0)
    client = pulling(server, sockets)
    with pytest.raises(BlockingIOError):
        client.recv(1)
    publish(server)
    client.settimeout(PATIENCE)
    assert kinds(client.recv(1 << 16)) == [(ACK, GET_DATA), (DATA, 1), (SYNCH, 1)]


def test_that_a_request_was_heard_is_told_before_long_if_there_are_no_data(
    server, sockets, monkeypatch
):
    clock = [0.0]
    monkeypatch.setattr("player.connection.monotonic", lambda: clock[0])
    client = pulling(server, sockets)
    clock[0] = HELD_FOR
    assert server.poll(0) == []
    client.settimeout(PATIENCE)
    assert message(client)[2:4] == (ACK, GET_DATA)
    publish(server)
    assert [message(client)[2] for _ in range(2)] == [DATA, SYNCH]


def test_any_other_answer_takes_it_along_at_once(server, sockets, monkeypatch):
    monkeypatch.setattr("player.connection.monotonic", lambda: 0.0)
    client = pulling(server, sockets)
    client.sendall(say(5, 0, REQ, 1))
    server.poll(PATIENCE)
    assert server.poll(0) == []
    client.settimeout(PATIENCE)
    assert [message(client)[2:4] for _ in range(2)] == [(ACK, GET_DATA), (NACK, 1)]
