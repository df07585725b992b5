"""Arbitrary bytes for a session: garbage, mutated conversations, any cut into pieces."""

from functools import cache

from captured_conversations import client_messages, stream
from hypothesis import given, settings
from hypothesis import strategies as st
from wire_talk import ASK, BANNER, POSITION2D, REQ, data_mode, hear, open_device, say, velocity

from player.codes import DeviceAddr
from player.directory import Directory
from player.header import HEADER_SIZE
from player.session import BACKLOG_LIMIT, MAX_REQUEST, Malformed, Request, Session

SETTINGS = settings(max_examples=150)
TALK = [
    data_mode(2),
    data_mode(1),
    open_device(POSITION2D),
    open_device(6),
    velocity(0.5),
    say(POSITION2D, 0, REQ, 1, seq=7),
    say(POSITION2D, 0, REQ, 5, bytes(24)),
    say(1, 0, REQ, 1),
    ASK,
]


def fresh(patient=False):
    """A session on the devices that the captured C client talks to."""
    addrs = {DeviceAddr(m.interf, m.index) for m in client_messages("misc_c_client")}
    addrs = {addr for addr in addrs if addr.interf not in (1, 5)}
    return Session(Directory(dict.fromkeys(sorted(addrs), "any")), patient=patient)


def converse(session, pieces):
    """Events and output when `pieces` come in, every request being refused at once."""
    events = []
    said = session.outgoing()
    for piece in pieces:
        for event in session.receive(piece):
            events.append(event)
            if isinstance(event, Request):
                session.refuse(event)
        session.publish(DeviceAddr(POSITION2D, 0), 1, b"data", 1.0)
        session.end_of_round()
        said += session.outgoing()
    return events, said


def receive_in(session, data, cuts):
    """Events, and messages told, when `data` comes in pieces cut at `cuts`.

    The messages are sorted: a device's reply may come after the server's own to a later request,
    if both come in one piece.
    """
    events = []
    said = b""
    for start, end in zip([0, *cuts], [*cuts, len(data)], strict=True):
        for event in session.receive(data[start:end]):
            events.append(repr(event))
            if isinstance(event, Request):
                session.refuse(event)
        said += session.outgoing()
    told, rest = hear(said[len(BANNER) :])
    assert rest == b""
    return events, sorted(told)


@cache
def captured():
    return stream("misc_c_client", "C")


@SETTINGS
@given(st.binary(max_size=300), st.booleans())
def test_garbage_does_no_harm(garbage, patient):
    events, said = converse(fresh(patient), [garbage])
    assert said.startswith(BANNER)
    assert hear(said[len(BANNER) :])[1] == b""
    malformed = [event for event in events if isinstance(event, Malformed)]
    assert malformed == events[-1:] if malformed else True


@SETTINGS
@given(st.data())
def test_a_mutated_conversation_does_no_harm(data):
    """Bytes of a real client, some of them changed: whole messages out, replies in order."""
    talk = bytearray(captured())
    start = data.draw(st.integers(0, len(talk) - 1))
    talk = talk[start // 4 * 4 : start // 4 * 4 + 600] if data.draw(st.booleans()) else talk
    for _ in range(data.draw(st.integers(1, 8))):
        talk[data.draw(st.integers(0, len(talk) - 1))] = data.draw(st.integers(0, 255))
    session = fresh()
    _, said = converse(session, [bytes(talk)])
    assert hear(said[len(BANNER) :])[1] == b""
    assert session.backlog == 0
    assert session._reader.buffered <= len(talk)


@SETTINGS
@given(st.lists(st.sampled_from(TALK), max_size=12), st.data())
def test_how_bytes_are_cut_changes_nothing(talk, data):
    whole = b"".join(talk)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(whole)), max_size=10)))
    assert receive_in(fresh(), whole, cuts) == receive_in(fresh(), whole, [])


@settings(max_examples=10)
@given(st.integers(1, 200))
def test_a_real_client_is_understood_in_pieces_of_any_size(size):
    whole = captured()
    cuts = list(range(size, len(whole), size))
    assert receive_in(fresh(), whole, cuts) == receive_in(fresh(), whole, [])


@SETTINGS
@given(st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1), st.integers(0, 2**32 - 1))
def test_no_announced_size_or_count_costs_memory(size, count, again):
    """A header may announce any payload, and a payload any count: little is kept for either."""
    session = fresh()
    header = say(1, 0, REQ, 7)[:36] + size.to_bytes(4)
    session.receive(header + count.to_bytes(4) + again.to_bytes(4))
    assert session.broken == (size > MAX_REQUEST)
    assert session._reader.buffered <= HEADER_SIZE + 8
    assert session.backlog <= len(BANNER) + 2 * HEADER_SIZE


@settings(max_examples=10)
@given(st.integers(100, 3000))
def test_a_client_that_only_talks_is_kept_within_bounds(times):
    session = fresh()
    session.receive(data_mode(2) + open_device(POSITION2D))
    for _ in range(times):
        session.publish(DeviceAddr(POSITION2D, 0), 1, bytes(52), 1.0)
        session.end_of_round()
        session.receive(say(5, 0, REQ, 1) * 10 if not session.stalled else b"")
    assert session.backlog <= BACKLOG_LIMIT + 1024 * (HEADER_SIZE + 52)
