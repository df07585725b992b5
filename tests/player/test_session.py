"""A client's session: subscriptions, the queue's rules, modes, and exactly one reply a request."""

import struct

import pytest
from wire_talk import (
    ACK,
    ASK,
    BANNER,
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
    PULL,
    PUSH,
    REQ,
    RULE,
    SYNCH,
    data_mode,
    hear,
    kinds,
    open_device,
    replace_rule,
    say,
    velocity,
)

from player.codes import DataMode, DeviceAddr
from player.directory import Directory
from player.errors import XdrError
from player.session import (
    BACKLOG_LIMIT,
    MAX_RULES,
    Command,
    DataRequested,
    Ignored,
    Malformed,
    ModeChanged,
    Request,
    Session,
    Subscribed,
    Unsubscribed,
)

BASE = DeviceAddr(POSITION2D, 0)
SCANNER = DeviceAddr(LASER, 0)
OK, OVERFLOW = 1, 2
A_ROUND = [(ACK, GET_DATA), (DATA, 1), (SYNCH, OK)]


def make(*, patient=False, mode=PULL, devices=(BASE,), rule=False, **kwargs):
    """A session that has said hello, is in `mode` and has subscribed `devices`."""
    directory = Directory({BASE: "wheels", SCANNER: "eye"}, port=6665)
    session = Session(directory, patient=patient, **kwargs)
    session.receive(data_mode(mode))
    if rule:
        session.receive(replace_rule())
    for addr in devices:
        session.receive(open_device(*addr))
    assert session.outgoing().startswith(BANNER)
    return session


def publish(session, *payloads, addr=BASE, time=1.0):
    for payload in payloads:
        session.publish(addr, 1, payload, time)
    session.end_of_round()


# -- pull mode


def test_the_banner_goes_first_and_once():
    session = Session(Directory())
    assert session.outgoing() == BANNER
    assert session.outgoing() == b""


def test_a_round_is_acknowledgement_then_data_then_synch():
    session = make()
    publish(session, b"old.")
    assert session.outgoing() == b""  # not before it is asked for
    assert session.receive(ASK) == [DataRequested(served=True)]
    assert kinds(session.outgoing()) == A_ROUND
    assert not session.waiting


def test_a_request_without_data_is_served_at_the_next_round():
    session = make()
    assert session.receive(ASK) == [DataRequested(served=False)]
    assert session.waiting
    assert kinds(session.outgoing()) == [(ACK, GET_DATA)]
    session.end_of_round()
    assert session.outgoing() == b""  # no SYNCH without data
    publish(session, b"new.", time=2.5)
    found, _ = hear(session.outgoing())
    assert [(m.type, m.subtype) for m in found] == A_ROUND[1:]
    assert found[0][:2] == BASE
    assert found[0].time == 2.5
    assert found[0].payload == b"new."
    assert not session.waiting


def test_a_patient_session_sends_a_round_in_one_piece():
    session = make(patient=True)
    session.receive(ASK)
    assert session.waiting
    assert session.outgoing() == b""
    session.directory.time = 7.0
    publish(session, b"new.", time=7.0)
    data = session.outgoing()
    assert kinds(data) == A_ROUND
    assert hear(data)[0][0].time == 7.0
    session.receive(ASK)
    publish(session, b"more")
    assert kinds(session.outgoing()) == A_ROUND


def test_a_round_is_not_served_by_halves():
    """A client that asks while a tick's data is being published gets all of that tick."""
    session = make(devices=(BASE, SCANNER))
    session.publish(BASE, 1, b"pose", 1.0)
    assert session.receive(ASK) == [DataRequested(served=False)]
    session.publish(SCANNER, 1, b"scan", 1.0)
    session.end_of_round()
    assert kinds(session.outgoing()) == [(ACK, GET_DATA), (DATA, 1), (DATA, 1), (SYNCH, OK)]


def test_data_queued_before_a_reply_goes_out_before_it():
    session = make()
    publish(session, b"data")
    [request] = session.receive(say(*BASE, REQ, 6))
    assert session.outgoing() == b""
    session.acknowledge(request)
    assert kinds(session.outgoing()) == [(DATA, 1), (ACK, 6)]
    publish(session, b"data")
    session.receive(say(PLAYER, 0, REQ, DEVLIST))
    assert kinds(session.outgoing()) == [(DATA, 1), (ACK, DEVLIST)]


def test_asking_twice_is_answered_twice():
    for patient in (False, True):
        session = make(patient=patient)
        session.receive(ASK + ASK)
        publish(session, b"data")
        told = kinds(session.outgoing())
        assert sorted(told) == sorted([(ACK, GET_DATA), *A_ROUND])
        assert told[-2:] == A_ROUND[1:]


def test_without_a_replace_rule_everything_is_kept():
    session = make()
    publish(session, b"one.", b"two.")
    session.receive(ASK)
    found, _ = hear(session.outgoing())
    assert [m.payload for m in found if m.type == DATA] == [b"one.", b"two."]


def test_with_a_replace_rule_the_newest_of_each_device_is_kept_at_the_end():
    session = make(devices=(BASE, SCANNER), rule=True)
    publish(session, b"pos1")
    publish(session, b"scan", addr=SCANNER)
    publish(session, b"pos2")
    session.receive(ASK)
    found, _ = hear(session.outgoing())
    assert [m.payload for m in found if m.type == DATA] == [b"scan", b"pos2"]
    publish(session, b"pos3")
    session.receive(ASK)
    assert kinds(session.outgoing()) == A_ROUND


def test_a_replace_rule_may_ignore_and_the_first_that_matches_counts():
    session = make(devices=(BASE, SCANNER))
    session.receive(replace_rule(LASER, replace=2) + replace_rule(replace=0))
    session.outgoing()
    publish(session, b"scan", addr=SCANNER)
    publish(session, b"pos1", b"pos2")
    session.receive(ASK)
    found, _ = hear(session.outgoing())
    assert [m.payload for m in found if m.type == DATA] == [b"pos1", b"pos2"]
    session.receive(replace_rule(LASER, replace=0))  # the same pattern again: changed, not added
    publish(session, b"scan", addr=SCANNER)
    session.receive(ASK)
    assert (DATA, 1) in kinds(session.outgoing())


def test_a_rule_that_is_none_is_refused():
    session = make()
    session.receive(replace_rule(replace=7))
    assert kinds(session.outgoing()) == [(NACK, RULE)]


def test_rules_are_bounded():
    session = make()
    for subtype in range(MAX_RULES + 1):
        session.receive(replace_rule(subtype=subtype))
    assert kinds(session.outgoing()) == [(ACK, RULE)] * MAX_RULES + [(NACK, RULE)]


def test_a_full_queue_drops_and_says_so_once():
    session = make(limit=3)
    publish(session, *[b"data"] * 5)
    assert session.dropped == 2
    session.receive(ASK)
    found, _ = hear(session.outgoing())
    assert [(m.type, m.subtype) for m in found[1:]] == [(DATA, 1)] * 3 + [(SYNCH, OVERFLOW)]
    assert found[-1].payload == struct.pack(">I", 2)
    publish(session, b"data")
    session.receive(ASK)
    assert kinds(session.outgoing()) == A_ROUND


def test_replacing_in_a_full_queue_loses_nothing():
    session = make(limit=2, devices=(BASE, SCANNER), rule=True)
    for _ in range(50):
        publish(session, b"scan", addr=SCANNER)
        publish(session, b"pose")
    assert session.dropped == 0


def test_players_queue_holds_1024_messages():
    session = make()
    publish(session, *[b"data"] * 2000)
    session.receive(ASK)
    assert kinds(session.outgoing()).count((DATA, 1)) == 1024


# -- push mode


def test_a_server_starts_in_push_mode():
    assert Session(Directory()).mode is DataMode.PUSH


def test_pushed_data_goes_out_without_asking_and_without_synch():
    session = make(mode=PUSH)
    publish(session, b"data", b"more")
    assert kinds(session.outgoing()) == [(DATA, 1), (DATA, 1)]


def test_asking_in_push_mode_is_acknowledged_only():
    session = make(mode=PUSH)
    assert session.receive(ASK) == []
    publish(session, b"data")
    assert kinds(session.outgoing()) == [(ACK, GET_DATA), (DATA, 1)]


@pytest.mark.parametrize("patient", [False, True])
def test_changing_to_push_while_waiting_leaves_no_request_unanswered(patient):
    session = make(patient=patient)
    session.receive(ASK)
    assert session.receive(data_mode(PUSH)) == [ModeChanged(DataMode.PUSH)]
    assert not session.waiting
    assert sorted(kinds(session.outgoing())) == [(ACK, GET_DATA), (ACK, DATAMODE)]
    publish(session, b"data")
    assert kinds(session.outgoing()) == [(DATA, 1)]


def test_any_mode_is_acknowledged_and_only_the_two_change_it():
    session = make()
    assert session.receive(data_mode(9)) == []
    assert kinds(session.outgoing()) == [(ACK, DATAMODE)]
    assert session.mode is DataMode.PULL


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
    session = make(notify=lambda: told.append(1))
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
