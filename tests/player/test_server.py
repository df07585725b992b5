"""The server's sockets, seen by raw clients that know nothing of our code but its bytes."""

import errno
import os
import socket
import struct

import pytest
from wire_talk import (
    ACK,
    ASK,
    BANNER,
    DATA,
    DATAMODE,
    DEV,
    DEVLIST,
    GET_DATA,
    LASER,
    NACK,
    PLAYER,
    POSITION2D,
    PULL,
    REQ,
    SYNCH,
    data_mode,
    hear,
    kinds,
    open_device,
    say,
    velocity,
)

from player.codes import DeviceAddr
from player.directory import Directory
from player.server import HELD_FOR, Connected, Disconnected, Server
from player.session import (
    Command,
    DataRequested,
    Malformed,
    ModeChanged,
    Request,
    Subscribed,
)
from tests.patience import PATIENCE

BASE = DeviceAddr(POSITION2D, 0)


def directory():
    return Directory({BASE: "wheels", DeviceAddr(LASER, 0): "eye"})


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


def test_small_messages_are_not_held_back_by_nagle(server, sockets):
    sockets(server.listen("127.0.0.1", 0, directory()))
    [(connection, _)] = handle(server, [Connected])
    assert connection._socket.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_who_may_have_more_to_say_is_acknowledged_at_once(server, sockets, monkeypatch):
    """Linux takes that back by itself, and then each of the client's writes waits 40 ms."""
    asked = []
    monkeypatch.setattr("player.server.quick_acknowledge", asked.append)
    client = sockets(server.listen("127.0.0.1", 0, directory()))
    [(connection, _)] = handle(server, [Connected])
    for times in (1, 2, 3):
        client.sendall(velocity(1.0))
        server.poll(PATIENCE)
        assert asked == [connection._socket] * times


def test_who_waits_for_data_is_acknowledged_with_the_data(server, sockets, monkeypatch):
    asked = []
    monkeypatch.setattr("player.server.quick_acknowledge", asked.append)
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
    monkeypatch.setattr("player.server.quick_acknowledge", lambda sock: client.sendall(ASK))
    connection = server._add(ours, directory(), False, "as if over TCP", 6665)
    connection.session.receive(data_mode(PULL))
    client.sendall(velocity(1.0))
    heard = [type(event) for _, event in server.poll(PATIENCE)]
    assert heard == [Command, DataRequested]


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
    monkeypatch.setattr("player.server.monotonic", lambda: 0.0)
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
    monkeypatch.setattr("player.server.monotonic", lambda: clock[0])
    client = pulling(server, sockets)
    clock[0] = HELD_FOR
    assert server.poll(0) == []
    client.settimeout(PATIENCE)
    assert message(client)[2:4] == (ACK, GET_DATA)
    publish(server)
    assert [message(client)[2] for _ in range(2)] == [DATA, SYNCH]


def test_any_other_answer_takes_it_along_at_once(server, sockets, monkeypatch):
    monkeypatch.setattr("player.server.monotonic", lambda: 0.0)
    client = pulling(server, sockets)
    client.sendall(say(5, 0, REQ, 1))
    server.poll(PATIENCE)
    assert server.poll(0) == []
    client.settimeout(PATIENCE)
    assert [message(client)[2:4] for _ in range(2)] == [(ACK, GET_DATA), (NACK, 1)]


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
