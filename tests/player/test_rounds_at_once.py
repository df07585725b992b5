"""A round that a connection is given whole arrives whole, however little its socket takes."""

import socket

import pytest
from wire_talk import (
    ACK,
    ASK,
    DATA,
    GET_DATA,
    LASER,
    PLAYER,
    POSITION2D,
    PULL,
    SYNCH,
    data_mode,
    hear,
    open_device,
    say,
)

from player.codes import BANNER_SIZE, DeviceAddr
from player.directory import Directory
from player.server import Disconnected, Server
from tests.patience import PATIENCE

BASE, SCANNER = DeviceAddr(POSITION2D, 0), DeviceAddr(LASER, 0)
A_ROUND = [(ACK, GET_DATA), (DATA, 1), (DATA, 1), (SYNCH, 1)]
OTHERS = 3
"""Messages before the first round: the replies to a mode and to two subscriptions."""


@pytest.fixture(params=[True, False], ids=["patient", "as of Player's library"])
def talk(request):
    """A server, its connection, and the client's end: it has subscribed two devices, and asks."""
    ours, client = socket.socketpair()
    client.settimeout(PATIENCE)
    with Server() as server, client:
        directory = Directory({BASE: "wheels", SCANNER: "eye"})
        connection = server.adopt(ours, directory, patient=request.param)
        client.sendall(data_mode(PULL) + open_device(*BASE) + open_device(*SCANNER) + ASK)
        while not connection.session.waiting:
            server.poll(PATIENCE)
        yield server, connection, client


def round_of(size, fill=b"x"):
    return [(BASE, 1, b"pose"), (SCANNER, 1, fill * size)]


def read(server, client, wanted):
    """Reads, while the server writes, until so many messages have come; they, and the rest."""
    data = b""
    while len(hear(data[BANNER_SIZE:])[0]) < wanted:
        server.poll(0)
        data += client.recv(1 << 12)
    return hear(data[BANNER_SIZE:])


def test_a_round_larger_than_what_the_socket_takes_arrives_whole_and_once(talk):
    server, connection, client = talk
    connection._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 12)
    connection.publish_round(round_of(1 << 18), 1.0)
    assert connection.unsent
    assert not connection.session.waiting
    connection.publish_round(round_of(8), 2.0)  # nobody has asked: it waits
    told, rest = read(server, client, OTHERS + len(A_ROUND))
    assert rest == b""
    assert [(message.type, message.subtype) for message in told[OTHERS:]] == A_ROUND
    assert [message.time for message in told[-3:-1]] == [1.0, 1.0]
    assert told[-2].payload == b"x" * (1 << 18)


def test_a_round_while_an_earlier_one_is_still_on_its_way_goes_behind_it(talk):
    server, connection, client = talk
    connection._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 12)
    connection.publish_round(round_of(1 << 18), 1.0)
    client.sendall(ASK)
    while not connection.session.waiting:
        server.poll(PATIENCE)
    connection.publish_round(round_of(8, b"y"), 2.0)
    told, rest = read(server, client, OTHERS + 2 * len(A_ROUND))
    assert rest == b""
    assert [message.time for message in told if message.type == DATA] == [1.0, 1.0, 2.0, 2.0]


def test_a_client_that_has_gone_costs_nothing_but_its_connection(talk):
    server, connection, client = talk
    client.close()
    connection.publish_round(round_of(8), 1.0)
    heard = [event for _, event in server.poll(PATIENCE)]
    assert any(isinstance(event, Disconnected) for event in heard)
    connection.publish_round(round_of(8), 2.0)
    assert not connection.is_open


def test_a_round_that_is_encoded_already_may_change_when_it_has_been_taken(talk):
    """The next tick's is written where this one was, however little the socket has taken."""
    server, connection, client = talk
    connection._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 12)
    size = 1 << 18
    said = say(PLAYER, 0, ACK, GET_DATA) + say(*SCANNER, DATA, 1, b"x" * size)
    piece = bytearray(said + say(PLAYER, 0, SYNCH, 1))
    assert connection.take_round(memoryview(piece), 1)
    piece[:] = bytes(len(piece))
    messages, rest = read(server, client, OTHERS + 3)
    assert rest == b""
    assert [(got.type, got.subtype) for got in messages[OTHERS:]] == [
        (ACK, GET_DATA),
        (DATA, 1),
        (SYNCH, 1),
    ]
    assert messages[-2].payload == b"x" * size
    assert not connection.session.waiting


def test_a_round_that_is_encoded_already_is_for_those_who_wait_for_it_alone(talk):
    _, connection, _ = talk
    piece = memoryview(say(PLAYER, 0, ACK, GET_DATA) + say(PLAYER, 0, SYNCH, 1))
    session = connection.session
    assert session.round_ready(piece, 1 << 20) is None  # more than it keeps
    session.publish(BASE, 1, b"pose", 1.0)
    assert not connection.take_round(piece, 1)
    session.end_of_round()
    assert not connection.take_round(piece, 1)  # it has been served
    connection.close()
    assert not connection.take_round(piece, 1)
