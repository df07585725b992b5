"""A client's session: subscriptions, exactly one reply a request, and bytes that are garbage."""

import struct

import pytest
from player_sessions import A_ROUND, BASE, SCANNER, make, publish
from wire_talk import (
    ACK,
    ASK,
    CMD,
    DATA,
    DATAMODE,
    DEV,
    DEVLIST,
    DRIVERINFO,
    GET_DATA,
    LASER,
    NACK,
    PLAYER,
    POSITION2D,
    PUSH,
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
from player.errors import XdrError
from player.session import (
    BACKLOG_LIMIT,
    Command,
    Ignored,
    Malformed,
    Request,
    Subscribed,
    Unsubscribed,
)

# -- subscriptions


def test_data_of_devices_that_are_not_subscribed_is_never_sent():
    session = make()
    publish(session, b"scan", addr=SCANNER)
    session.receive(ASK)
    assert kinds(session.outgoing()) == [(ACK, GET_DATA)]


def test_a_subscription_tells_the_driver_and_the_address():
    session = make(devices=())
    assert session.receive(open_device(*SCANNER)) == [Subscribed(SCANNER)]
    found, _ = hear(session.outgoing())
    assert found[0].type == ACK
    assert found[0].payload == (
        bytes.fromhex("0100007f 00001a09 00000006 00000000 00000001 00000004 00000004") + b"eye\0"
    )


def test_an_absent_device_is_refused_with_access_error():
    session = make(devices=())
    assert session.receive(open_device(5)) == []
    found, _ = hear(session.outgoing())
    assert (found[0].type, found[0].subtype) == (NACK, DEV)
    assert found[0].payload.hex(" ", 4) == (
        "0100007f 00001a09 00000005 00000000 00000003 00000000 00000000"
    )


def test_subscribing_twice_needs_closing_twice_and_sends_data_once():
    session = make(devices=(BASE, BASE))
    publish(session, b"data")
    session.receive(ASK)
    assert kinds(session.outgoing()) == A_ROUND
    assert session.receive(open_device(*BASE, access=2)) == []
    assert BASE in session.subscribed
    assert session.receive(open_device(*BASE, access=2)) == [Unsubscribed(BASE)]
    assert BASE not in session.subscribed


@pytest.mark.parametrize("access", [2, 3, 200])
def test_what_cannot_be_done_with_a_subscription_is_acknowledged_as_an_error(access):
    session = make(devices=())
    assert session.receive(open_device(*BASE, access=access)) == []
    found, _ = hear(session.outgoing())
    assert found[0].type == ACK
    assert struct.unpack_from(">5I", found[0].payload)[4] == 3


def test_a_device_that_comes_later_can_be_subscribed():
    session = make(devices=())
    sonar = DeviceAddr(5, 2)
    session.directory.add(sonar, "late")
    assert session.receive(open_device(*sonar)) == [Subscribed(sonar)]


def test_the_device_list_holds_what_the_directory_holds():
    session = make()
    for count in (2, 3):
        session.receive(say(PLAYER, 0, REQ, DEVLIST))
        found, _ = hear(session.outgoing())
        assert struct.unpack_from(">II", found[0].payload) == (count, count)
        assert len(found[0].payload) == 8 + 16 * count
        session.directory.add(DeviceAddr(5, 0), "late")
    session.directory.remove(DeviceAddr(5, 0))
    assert len(session.directory) == 2


def test_the_driver_of_an_absent_device_is_refused():
    session = make()
    ask = struct.pack(">6I", 0, 0, 5, 0, 0, 0)
    session.receive(say(PLAYER, 0, REQ, DRIVERINFO, ask))
    assert kinds(session.outgoing()) == [(NACK, DRIVERINFO)]


# -- commands and requests


def test_a_command_is_decoded_and_not_answered():
    session = make()
    [event] = session.receive(velocity(0.5))
    assert isinstance(event, Command)
    assert (event.addr, event.subtype, event.name) == (BASE, 1, "velocity")
    assert event.message["vel"].x == 0.5
    assert session.outgoing() == b""


def test_a_reply_carries_the_requests_address_and_seq_and_the_given_time():
    session = make()
    [request] = session.receive(say(*BASE, REQ, 1, seq=1234))
    assert isinstance(request, Request)
    assert session.pending == [request]
    session.acknowledge(request, {"pose": (0,) * 6, "size": (1, 2, 3)}, time=4.5)
    [reply], _ = hear(session.outgoing())
    assert reply[:6] == (*BASE, ACK, 1, 4.5, 1234)
    assert struct.unpack(">9d", reply.payload)[6:] == (1, 2, 3)
    assert session.pending == []


def test_a_request_is_answered_exactly_once():
    session = make()
    [request] = session.receive(say(*BASE, REQ, 6))
    session.refuse(request)
    for answer in (session.refuse, session.acknowledge):
        with pytest.raises(KeyError):
            answer(request)
    assert kinds(session.outgoing()) == [(NACK, 6)]


def test_a_reply_that_does_not_fit_becomes_a_refusal():
    session = make()
    [request] = session.receive(say(*BASE, REQ, 1))
    with pytest.raises(XdrError, match="position2d ACK 1"):
        session.acknowledge(request, {"pose": (0,) * 6})
    assert kinds(session.outgoing()) == [(NACK, 1)]


@pytest.mark.parametrize(
    "message",
    [
        say(5, 0, REQ, 1),  # no such device
        say(POSITION2D, 7, REQ, 1),  # no such index
        say(*BASE, REQ, 99),  # no such request
        say(*BASE, REQ, 5, b"\0\0\0\0"),  # too short a pose
        say(*BASE, REQ, 5, bytes(28)),  # too long a pose
        say(PLAYER, 0, REQ, 6),  # the server has no such request
        say(PLAYER, 0, REQ, DATAMODE),  # without the mode
        say(PLAYER, 1, REQ, DEVLIST),  # there is one server
        say(PLAYER, 0, CMD, 1),
        say(PLAYER, 0, DATA, 1),
        say(PLAYER, 0, REQ, 7, struct.pack(">II", 0, 0)),  # authentication
        say(PLAYER, 0, REQ, 8, struct.pack(">III", 0, 0, 1)),  # name service
    ],
)
def test_whatever_cannot_be_answered_is_refused_at_once(message):
    session = make()
    events = session.receive(message)
    assert all(isinstance(event, Ignored) for event in events)
    subtype = hear(message)[0][0].subtype
    assert kinds(session.outgoing()) == [(NACK, subtype)]


@pytest.mark.parametrize(
    "message",
    [
        say(5, 0, CMD, 1),
        say(*BASE, CMD, 77),
        say(*BASE, CMD, 1, b"\0\0\0\0"),
        say(*BASE, DATA, 1),
        say(*BASE, ACK, 1),
        say(*BASE, SYNCH, 1),
    ],
)
def test_what_player_only_warns_about_is_ignored_with_a_reason(message):
    session = make()
    [event] = session.receive(message)
    assert isinstance(event, Ignored)
    assert event.reason
    assert session.outgoing() == b""


def test_a_request_without_fields_may_carry_garbage():
    session = make()
    [event] = session.receive(say(*BASE, REQ, 1, b"leftover"))
    assert isinstance(event, Request)
    assert event.message == {}


# -- bytes that are not the protocol


@pytest.mark.parametrize(
    "garbage",
    [
        b"GET / HTTP/1.1\r\nHost: localhost\r\nAccept: */*\r\n\r\n",
        bytes(40),
        say(LASER, 0, 9, 1),
        say(LASER, 70000, REQ, 1),
        struct.pack(">6IdII", 0, 0, 6, 0, 3, 1, 0.0, 0, 0xFFFFFFFF),
        struct.pack(">6IdII", 0, 0, 6, 0, 3, 1, 0.0, 0, (1 << 20) + 1),
    ],
)
def test_garbage_ends_the_session_and_what_came_before_counts(garbage):
    session = make()
    events = session.receive(velocity(1.0) + garbage + velocity(2.0))
    assert isinstance(events[0], Command)
    assert isinstance(events[1], Malformed)
    assert len(events) == 2
    assert session.receive(velocity(3.0)) == []


def test_a_flood_of_requests_waits_until_its_replies_are_read():
    session = make()
    for i in range(2000):
        session.directory.add(DeviceAddr(5, i), "many")  # a long list for a short question
    question = say(PLAYER, 0, REQ, DEVLIST)
    session.receive(question * 1000)
    assert session.stalled
    assert session.backlog < 2 * BACKLOG_LIMIT
    answers = 0
    while data := session.outgoing():
        answers += kinds(data).count((ACK, DEVLIST))
        session.receive(b"")
    assert answers == 1000


def test_a_closed_session_keeps_nothing():
    session = make()
    [request] = session.receive(say(*BASE, REQ, 6))
    session.close()
    session.acknowledge(request)
    publish(session, b"data")
    assert session.receive(ASK) == []
    assert session.outgoing() == b""


def test_the_owner_is_told_when_there_is_something_to_write():
    told = []
    session = make()
    session.on_output(lambda: told.append(1))
    told.clear()
    publish(session, b"data")
    assert told == []  # it waits to be asked for
    session.receive(ASK)
    assert told
    session.outgoing()
    told.clear()
    session.receive(data_mode(PUSH))
    session.outgoing()
    told.clear()
    publish(session, b"data")
    assert told
