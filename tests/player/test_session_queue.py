"""A client's session: what waits in its queue, and when it goes out, in pull and push mode."""

import struct

import pytest
from player_sessions import A_ROUND, BASE, OK, OVERFLOW, SCANNER, make, publish
from wire_talk import (
    ACK,
    ASK,
    BANNER,
    DATA,
    DATAMODE,
    DEVLIST,
    GET_DATA,
    LASER,
    NACK,
    PLAYER,
    PUSH,
    REQ,
    RULE,
    SYNCH,
    data_mode,
    hear,
    kinds,
    replace_rule,
    say,
)

from player.codes import DataMode
from player.directory import Directory
from player.outbox import MAX_RULES
from player.session import (
    DataRequested,
    ModeChanged,
    Session,
)

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
