"""Pieces of bytes like those before: what they are taken for is what their messages say."""

import struct

from hypothesis import given
from hypothesis import strategies as st
from player_sessions import BASE, SCANNER, make, publish
from scripted_server import scripted
from wire_talk import (
    ACK,
    ASK,
    CMD,
    DATA,
    GET_DATA,
    LASER,
    PLAYER,
    POSITION2D,
    REQ,
    SYNCH,
    hear,
    kinds,
    open_device,
    say,
    velocity,
)

from player import LaserProxy, PlayerClient, Position2dProxy, XdrError
from player.familiar import MOST_PIECES, Familiar
from player.session import Command, DataRequested, Ignored

PARTS = st.lists(
    st.tuples(st.integers(1, 9), st.integers(0, 3), st.integers(1, 6), st.binary(max_size=9)),
    min_size=1,
    max_size=4,
)
TIMES = st.floats(allow_nan=False)


def piece(parts, times, fill=None):
    """Messages of these kinds, with payloads of these lengths."""
    return b"".join(
        say(interf, index, type_, 1, payload if fill is None else fill * len(payload), time)
        for (interf, index, type_, payload), time in zip(parts, times, strict=True)
    )


def anywhere(found):
    """All of each payload may differ."""
    return [message.interf for message in found], [(0, len(m.payload)) for m in found]


@given(PARTS, st.lists(TIMES, min_size=8, max_size=8))
def test_a_piece_like_one_before_is_taken_for_the_messages_that_it_is(parts, times):
    familiar = Familiar(anywhere)
    first = piece(parts, times[: len(parts)])
    assert familiar.match(first) is None
    familiar.learn(first)
    again = piece(parts, times[-len(parts) :], b"x")
    assert familiar.match(again) == [message.interf for message in hear(again)[0]]


@given(PARTS, st.data())
def test_a_piece_of_the_same_length_that_is_another_is_not_taken_for_it(parts, data):
    familiar = Familiar(anywhere)
    known = piece(parts, [1.0] * len(parts))
    familiar.learn(known)
    at = data.draw(st.integers(0, len(known) - 1))
    other = known[:at] + bytes([known[at] ^ data.draw(st.integers(1, 255))]) + known[at + 1 :]
    if familiar.match(other) is None:
        return
    heads = [message._replace(time=0.0, payload=b"") for message in hear(known)[0]]
    told, rest = hear(other)
    assert rest == b""
    assert [message._replace(time=0.0, payload=b"") for message in told] == heads
    assert known[:8] == other[:8]


@given(PARTS, st.data())
def test_only_the_stretch_of_a_payload_that_may_differ_does(parts, data):
    stretches = []
    for *_, payload in parts:
        start = data.draw(st.integers(0, len(payload)))
        stretches.append((start, data.draw(st.integers(start, len(payload)))))
    familiar = Familiar(lambda found: ("known", stretches))
    known = piece(parts, [1.0] * len(parts))
    familiar.learn(known)
    at = data.draw(st.integers(0, len(known) - 1))
    other = known[:at] + bytes([known[at] ^ data.draw(st.integers(1, 255))]) + known[at + 1 :]
    begin, may = 0, False
    for (*_, payload), (start, end) in zip(parts, stretches, strict=True):
        may |= begin + 24 <= at < begin + 32
        may |= begin + 40 + start <= at < begin + 40 + end
        begin += 40 + len(payload)
    assert familiar.match(other) == ("known" if may else None)


def test_what_is_remembered_is_bounded_and_only_what_its_owner_wants():
    familiar = Familiar(lambda found: anywhere(found) if found[0].interf == LASER else None)
    for size in range(2 * MOST_PIECES):
        familiar.learn(say(LASER, 0, DATA, 1, bytes(size)))
        assert len(familiar._pieces) <= MOST_PIECES
    for other in (say(POSITION2D, 0, DATA, 1), say(LASER, 0, DATA, 1)[:-1], b"short", b""):
        familiar.learn(other)
        assert familiar.match(other) is None or other == say(LASER, 0, DATA, 1)


# -- a client's rounds


def state(x):
    return struct.pack(">6dI", x, 0, 0, 0, 0, 0, 0)


def scan(*ranges, far=8.0):
    head = struct.pack(">4f2I", -1.0, 1.0, 0.5, far, len(ranges), len(ranges))
    return head + struct.pack(f">{len(ranges)}f3I", *ranges, 0, 0, 5)


def test_rounds_that_look_alike_are_read_as_those_that_do_not():
    """Rounds of one length with other devices, other times, another order, and more data."""
    rounds = [
        [(POSITION2D, 1, state(1.0)), (LASER, 1, scan(1.0, 2.0))],
        [(POSITION2D, 1, state(2.0)), (LASER, 1, scan(3.0, 4.0))],
        [(LASER, 1, scan(5.0, 6.0)), (POSITION2D, 1, state(3.0))],
        [(POSITION2D, 1, state(4.0)), (LASER, 99, scan(7.0, 8.0))],  # a later Player's
        [(POSITION2D, 1, state(5.0)), (LASER, 1, scan(7.0, 7.5, far=9.0))],
        [(POSITION2D, 1, state(6.0))],
        [(POSITION2D, 1, state(7.0))],
        [(POSITION2D, 1, state(8.0)), (POSITION2D, 1, state(9.0))],
    ]

    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.subscribe()
        for number, data in enumerate(rounds):
            talk.whole_round(*data, time=float(number))

    found = []
    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base, laser = Position2dProxy(robot), LaserProxy(robot)
        while robot.read():
            far = laser.max_range
            found.append((robot.time, base.x, laser.ranges.tolist(), laser.fresh, far, laser.id))
    assert found == [
        (0.0, 1.0, [1.0, 2.0], True, 8.0, 5),
        (1.0, 2.0, [3.0, 4.0], True, 8.0, 5),
        (2.0, 3.0, [5.0, 6.0], True, 8.0, 5),
        (3.0, 4.0, [5.0, 6.0], True, 8.0, 5),
        (4.0, 5.0, [7.0, 7.5], True, 9.0, 5),
        (5.0, 6.0, [7.0, 7.5], False, 9.0, 5),
        (6.0, 7.0, [7.0, 7.5], False, 9.0, 5),
        (7.0, 9.0, [7.0, 7.5], False, 9.0, 5),
    ]


def test_what_comes_after_data_that_is_none_is_read_by_the_next_reading():
    """As in rounds that nobody has seen the like of."""

    def script(talk):
        talk.greet()
        talk.subscribe()
        talk.subscribe()
        talk.whole_round((LASER, 1, scan(1.0)), (POSITION2D, 1, state(1.0)))
        talk.whole_round((LASER, 1, scan(1.0)[:20] + b"lies" + bytes(20)), (4, 1, state(2.0)))
        talk.whole_round((LASER, 1, scan(3.0)), (POSITION2D, 1, state(3.0)))

    seen = []
    with scripted(script) as sock, PlayerClient(sock=sock) as robot:
        base, laser = Position2dProxy(robot), LaserProxy(robot)
        for _ in range(4):
            try:
                assert robot.read()
            except XdrError:
                seen.append("laser")
            seen.append((base.x, laser.ranges.tolist()))
    assert seen == [(1.0, [1.0]), "laser", (1.0, [1.0]), (2.0, [1.0]), (3.0, [3.0])]


# -- a server's clients


def test_commands_and_requests_that_look_alike_are_events_all_the_same():
    session = make(devices=(BASE, SCANNER))
    for speed in (0.5, 0.25, 0.125):
        command, asked = session.receive(velocity(speed) + ASK)
        assert isinstance(command, Command)
        assert command.addr == BASE
        assert (command.subtype, command.name) == (1, "velocity")
        assert command.message == {"vel": (speed, 0.0, 0.0), "state": 1}
        assert command.message["vel"].x == speed
        assert asked == DataRequested(served=False)
        assert session.receive(velocity(speed)) == [command]
        publish(session, b"data")
        assert kinds(session.outgoing()) == [(ACK, GET_DATA), (DATA, 1), (SYNCH, 1)]


def test_each_request_is_answered_with_its_own_number_and_the_time_of_its_answer():
    session = make()
    for seq, time in ((7, 1.0), (7, 2.0), (8, 3.0)):
        session.directory.time = time
        session.receive(say(PLAYER, 0, REQ, GET_DATA, seq=seq))
        [told] = hear(session.outgoing())[0]
        assert (told.seq, told.time) == (seq, time)
        publish(session, b"data")
        session.outgoing()


def test_a_command_to_a_device_that_has_gone_is_ignored_however_often_it_came():
    session = make()
    session.receive(velocity(1.0))
    session.receive(velocity(1.0))
    session.directory.remove(BASE)
    [event] = session.receive(velocity(1.0))
    assert isinstance(event, Ignored)
    session.directory.add(BASE)
    [event] = session.receive(velocity(1.0))
    assert isinstance(event, Command)


def test_commands_of_any_length_are_looked_at_each_time():
    """How many points there are stands in the payload: a second one may be cut short."""
    session = make()
    session.directory.add((55, 0))
    points = struct.pack(">2I2d4I", 1, 1, 1.0, 2.0, 255, 1, 2, 3)
    [event] = session.receive(say(55, 0, CMD, 2, points))
    assert isinstance(event, Command)
    wrong = struct.pack(">2I", 9, 9) + points[8:]
    [event] = session.receive(say(55, 0, CMD, 2, wrong))
    assert isinstance(event, Ignored)


def test_a_round_given_at_once_is_the_round_that_is_published_one_by_one():
    for patient in (False, True):
        one, other = (make(devices=(BASE, SCANNER), patient=patient) for _ in range(2))
        for step, asks in enumerate((True, True, False, True, False, False, True)):
            data = [(BASE, 1, b"pose"), (SCANNER, 1, bytes(8 * step))]
            for session in (one, other):
                session.directory.time = float(step)
                if asks:
                    session.receive(ASK)
            for addr, subtype, payload in data:
                one.publish(addr, subtype, payload, float(step))
            one.end_of_round()
            other.publish_round(data, float(step))
            assert one.outgoing() == other.outgoing()
            assert one.waiting == other.waiting
            if step == 3:
                for session in (one, other):
                    session.receive(open_device(*SCANNER, access=2))
