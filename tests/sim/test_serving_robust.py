"""Whatever a client sends or leaves undone: it loses its connection, and nobody else notices."""

from __future__ import annotations

import contextlib
import gc
import random
import socket
import struct
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.sim.served_world import WORLD
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    ACK,
    CMD,
    GRAPHICS2D,
    HEADER,
    LASER,
    NACK,
    PLAYER,
    POSITION2D,
    REQ,
    SIMULATION,
    Gone,
    RawClient,
    message,
    pulling,
    pushed,
    text,
)

ONE_DRIVES = WORLD.replace("pose: [6.5, 5.5, -100], controller: hand", "pose: [6.5, 5.5, -100]")
ROUNDS = 40

Attack = Callable[[Serving, int], None]
"""What somebody does to a run that is not his, at its k-th round."""


def drive(run: Serving, attack: Attack | None = None) -> str:
    """Robot one's client drives about, in lockstep; the digest of what came of it."""
    with pulling(run.port("one"), (POSITION2D, 0), (LASER, 0)) as client:
        for k in range(ROUNDS):
            if attack is not None:
                attack(run, k)
            client.drive(0.3, 0.5 - 0.03 * k)
            client.round()
    return run.result().digest  # its client has gone: the run ends in order, by itself


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_world(tmp_path_factory.mktemp("robust"), ONE_DRIVES)


@pytest.fixture
def run(path: Path) -> Iterator[Serving]:
    with Serving(path) as serving:
        yield serving


@pytest.fixture(scope="module")
def undisturbed(path: Path) -> str:
    """The digest of the run that is left alone."""
    with Serving(path) as serving:
        return drive(serving)


def closed(client: RawClient) -> bool:
    """Whether the server closes a connection, whatever it says before."""
    with contextlib.suppress(Gone, OSError):
        while True:
            client.receive()
    client.close()
    return True


def reset(client: RawClient) -> None:
    """Vanish without a word: the other end gets a reset instead of an end."""
    client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    client.close()


# -- attacks ------------------------------------------------------------------------------------


def garbage(run: Serving, k: int) -> None:
    client = RawClient(run.port("one"))
    noise = random.Random(k).randbytes(1000)
    client.send(noise if noise[16:20] != bytes(4) else b"\xff" * 1000)
    assert closed(client)


def another_protocol(run: Serving, k: int) -> None:
    client = RawClient(run.port("one"))
    client.send(b"GET / HTTP/1.1\r\nHost: localhost\r\nUser-Agent: somebody\r\n\r\n")
    assert closed(client)


def absurd_size(run: Serving, k: int) -> None:
    client = RawClient(run.port("two"))
    client.send(HEADER.pack(0, 0, POSITION2D, 0, REQ, 1, 0.0, 0, 0xFFFFFFFF - k))
    assert closed(client)


def absurd_counts(run: Serving, k: int) -> None:
    """Arrays that announce more than there is are refused; the connection is sound."""
    with RawClient(run.port("one")) as client:
        most = struct.pack(">II", 0xFFFFFFFF, 0xFFFFFFFF)
        assert client.request(SIMULATION, 0, 1, most).type == NACK
        assert client.request(SIMULATION, 0, 6, most + b"\0" * 64).type == NACK
        assert client.request(PLAYER, 0, 7, most).type == NACK
        client.command(GRAPHICS2D, 0, 4, most + b"\0" * 64)
        assert client.request(POSITION2D, 0, 1).type == ACK


def truncated(run: Serving, k: int) -> None:
    """Everything up to some byte, then the end."""
    whole = message(SIMULATION, 0, REQ, 2, text("one") + struct.pack(">3d", 1, 1, 1))
    client = RawClient(run.port("one"))
    client.send(whole[: 1 + k * (len(whole) - 2) // ROUNDS])
    (reset if k % 2 else RawClient.close)(client)


def vanishes_with_subscriptions(run: Serving, k: int) -> None:
    client = (pushed if k % 2 else pulling)(run.port("two"), (POSITION2D, 0), (LASER, 0))
    client.ask()
    reset(client)


def asks_and_never_reads(run: Serving, k: int) -> None:
    """Requests until the socket takes no more: they are not taken in any longer."""
    if k % 10:
        return
    client = RawClient(run.port("one"))
    client.socket.settimeout(0.05)
    requests = message(PLAYER, 0, REQ, 1) * 2000
    with contextlib.suppress(TimeoutError):
        for _ in range(1000):
            client.send(requests)
        pytest.fail("the server has taken in everything")
    backlogs = [one.session.backlog + one.unsent for one in run.engine.server.connections]
    assert max(backlogs) < 8 << 20
    reset(client)


def floods_with_connections(run: Serving, k: int) -> None:
    """More than there is room for: some are closed at once, those that were there stay."""
    run.engine.server.max_connections = 12
    crowd = [socket.create_connection(("127.0.0.1", run.port("two"))) for _ in range(20)]
    for one in crowd:
        one.close()


def storms_of_subscriptions(run: Serving, k: int) -> None:
    with RawClient(run.port("one")) as client:
        for _ in range(20):
            for access in (1, 1, 2, 2, 2):
                client.access(LASER, 0, access)
                client.access(POSITION2D, 0, access)


def commands_that_make_no_sense(run: Serving, k: int) -> None:
    """None of them is the tick's last command, so nothing comes of them."""
    with RawClient(run.port("one")) as client:
        for bad in (float("nan"), float("inf"), 1e300, -1e300):
            client.command(POSITION2D, 0, 1, struct.pack(">3dI", bad, bad, bad, 1))
            client.command(POSITION2D, 0, 2, struct.pack(">6dI", *[bad] * 6, 1))
            client.command(POSITION2D, 0, 3, struct.pack(">2d", bad, bad))
            client.command(POSITION2D, 0, 4, struct.pack(">2d", bad, bad))
        client.command(POSITION2D, 7, 1, bytes(28))
        client.command(99, 0, 1, bytes(28))
        assert client.request(POSITION2D, 0, 1).type == ACK


ATTACKS = [
    garbage,
    another_protocol,
    absurd_size,
    absurd_counts,
    truncated,
    vanishes_with_subscriptions,
    asks_and_never_reads,
    floods_with_connections,
    storms_of_subscriptions,
]


@pytest.mark.parametrize("attack", ATTACKS)
def test_an_attack_costs_its_client_the_connection_and_changes_nothing(
    run: Serving, undisturbed: str, attack: Attack
) -> None:
    assert drive(run, attack) == undisturbed


def test_commands_that_make_no_sense_are_followed_by_those_that_do(
    run: Serving, undisturbed: str
) -> None:
    assert drive(run, commands_that_make_no_sense) == undisturbed
    assert sum("which is no number" in line for line in run.lines) == ROUNDS  # a line per client


def test_a_message_that_never_ends_is_waited_for_without_harm(
    run: Serving, undisturbed: str
) -> None:
    client = RawClient(run.port("one"))
    client.send(HEADER.pack(0, 0, SIMULATION, 0, REQ, 6, 0.0, 0, 1 << 20))

    def trickle(run: Serving, k: int) -> None:
        client.send(b"\0" * 1000)

    assert drive(run, trickle) == undisturbed
    client.close()


def test_a_reader_that_has_stopped_reading_keeps_a_bounded_queue(
    run: Serving, undisturbed: str
) -> None:
    """In push mode: 1024 messages wait at the most, as in Player, and no more than they hold."""
    slow = pushed(run.port("one"), (LASER, 0), (POSITION2D, 0))
    (ours,) = run.engine.server.connections  # small buffers: the queue is soon all there is
    ours._socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    with pulling(run.port("one")) as client:
        largest = 0
        for _ in range(1500):
            client.round()
            for one in run.engine.server.connections:
                largest = max(largest, one.session.backlog + one.unsent)
        stuck = [one for one in run.engine.server.connections if one.session.dropped]
        assert len(stuck) == 1
        # a round is a scan of 800 bytes and a state of 92: 1024 of them, and what was on its way
        assert largest < 1024 * 800 + (1 << 20)
        # when it reads again it gets what was kept, and then what is new
        for _ in range(1024):
            slow.receive()
        client.round()
    slow.close()


def test_a_pull_client_that_does_not_ask_for_long_is_told_that_data_was_lost(
    run: Serving,
) -> None:
    idle = pulling(run.port("two"))
    with pulling(run.port("one")) as client:
        for _ in range(1100):
            client.round()
        idle.ask()
        got = [idle.receive() for _ in range(1 + 1024 + 1)]
        assert (got[0].type, got[0].subtype) == (ACK, 4)
        assert (got[-1].type, got[-1].subtype) == (5, 2)  # SYNCH, overflow
        assert got[-1].unpack("I") == (1100 - 1024,)
        client.ask()
        idle.round()
        client.answer()
    idle.close()


def test_nothing_is_kept_of_clients_that_have_gone(run: Serving) -> None:
    engine = run.engine
    with pulling(run.port("one")) as client:

        def storm() -> None:
            for k in range(40):
                for attack in (garbage, truncated, vanishes_with_subscriptions, absurd_counts):
                    attack(run, k % ROUNDS)
                with RawClient(run.port("two")) as other:
                    other.drive(0.1)
                    other.command(12, 0, 1, b"")
                    other.request(LASER, 0, 3)
                client.round()
            gc.collect()

        storm()
        tracemalloc.start()
        storm()
        before = tracemalloc.get_traced_memory()[0]
        storm()
        storm()
        grown = tracemalloc.get_traced_memory()[0] - before
        tracemalloc.stop()
        client.round()
        assert len(engine.server.connections) == 1
        assert len(engine.switchboard.connections) == 1
        assert sum(len(have) for have in engine.switchboard.connections.values()) == 1
        assert len(engine.crew.clocks.driven) == 1
        assert all(not robot.driver.origins for robot in engine.robots)
        # 400 connections have come and gone: had each left its session, of some 2 KB, that were
        # 800 KB; half a kilobyte for each is left to the interpreter's own caches
        assert grown < 200_000


def test_what_clients_leave_behind_is_bounded(run: Serving) -> None:
    """Properties, sentences and drawings are kept: so many, and no more."""
    with pulling(run.port("one")) as client:
        answers = [
            client.request(
                SIMULATION,
                0,
                6,
                text("one") + text(f"key{k}") + bytes(4) + struct.pack(">II", 1, 1) + b"1\0\0\0",
            ).type
            for k in range(300)
        ]
        assert answers.count(ACK) == 256
        assert answers == sorted(answers)  # the first ones are taken
        large = struct.pack(">II", 70_000, 70_000) + b"1" * 70_000
        assert (
            client.request(SIMULATION, 0, 6, text("one") + text("key0") + bytes(4) + large).type
            == NACK
        )
        points = struct.pack(">II", 30_000, 30_000) + bytes(16 * 30_000) + bytes(16)
        for _ in range(5):
            client.command(GRAPHICS2D, 0, 3, points)
        client.command(12, 0, 1, text("x" * 100_000))
        for _ in range(1000):
            client.drive(0.1)  # while the world waits, the last command is all that is kept
        client.request(POSITION2D, 0, 1)
        context, robot = run.engine.context, run.engine.robots[0]
        assert len(context.pending[0]) == 256 + 3  # a velocity, a picture, a sentence
        assert not robot.drawings  # not before the others' turn
        assert not robot.record.said
        client.round()
        assert sum(len(drawing.points) for drawing in robot.drawings) <= 50_000
        assert len(robot.record.said[0][1]) == 1000
        assert len(robot.record.properties) == 256


# -- fuzz ---------------------------------------------------------------------------------------

SIZES = {
    (POSITION2D, CMD): {1: 28, 2: 52, 3: 16, 4: 16},
    (POSITION2D, REQ): {1: 0, 2: 4, 3: 4, 4: 4, 5: 24, 6: 0, 7: 12, 8: 12, 9: 8},
    (LASER, REQ): {1: 0, 2: 28, 3: 0, 4: 4, 5: 0},
    (62, REQ): {1: 0, 2: 4, 3: 4, 4: 56, 5: 0},
    (7, REQ): {1: 28, 2: 16, 3: 0},
    (10, REQ): {1: 0, 2: 0, 3: 12, 7: 0, 8: 4},
    (20, CMD): {1: 8},
    (SIMULATION, CMD): {1: 0, 2: 0, 3: 0},
    (PLAYER, REQ): {1: 0, 2: 24, 3: 28, 4: 0, 5: 4, 10: 20},
}
"""Bytes of payloads of fixed size, by interface and type, and subtype."""

KNOWN = [(i, t, s, n) for (i, t), row in SIZES.items() for s, n in row.items()]

numbers = st.one_of(
    st.floats(width=64).map(lambda x: struct.pack(">d", x)),
    st.floats(width=32).map(lambda x: struct.pack(">f", x)),
    st.sampled_from([0, 1, 2, 3, 255, 1 << 31, 0xFFFFFFFF]).map(lambda x: struct.pack(">I", x)),
    st.binary(min_size=4, max_size=4),
)


@st.composite
def known_messages(draw: st.DrawFn) -> bytes:
    """A message of the protocol, of the right size, that holds any numbers whatever."""
    interf, type_, subtype, size = draw(st.sampled_from(KNOWN))
    payload = b"".join(draw(st.lists(numbers, min_size=size // 4, max_size=size // 4)))[:size]
    return message(interf, draw(st.sampled_from([0, 0, 0, 1])), type_, subtype, payload)


@st.composite
def poses(draw: st.DrawFn) -> bytes:
    """A robot put anywhere."""
    values = draw(st.lists(st.floats(width=64), min_size=3, max_size=3))
    name = draw(st.sampled_from(["one", "two", "", "three"]))
    return message(SIMULATION, 0, REQ, 2, text(name) + struct.pack(">3d", *values))


@st.composite
def loose_messages(draw: st.DrawFn) -> bytes:
    """A header of any kind with any payload."""
    interf = draw(st.sampled_from([1, 4, 5, 6, 7, 10, 12, 14, 20, 31, 45, 55, 62, 99, 70_000]))
    type_ = draw(st.integers(0, 8))
    subtype = draw(st.integers(0, 256))
    return message(interf, draw(st.integers(0, 3)), type_, subtype, draw(st.binary(max_size=80)))


@pytest.fixture(scope="module")
def fuzzed(path: Path) -> Iterator[Serving]:
    with Serving(path) as serving:
        yield serving


@pytest.fixture(scope="module")
def driver(fuzzed: Serving) -> Iterator[RawClient]:
    with pulling(fuzzed.port("one"), (POSITION2D, 0), (LASER, 0)) as client:
        yield client


@settings(
    max_examples=150,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    data=st.lists(
        st.one_of(known_messages(), known_messages(), poses(), loose_messages()), max_size=12
    ),
    cut=st.integers(0, 100),
)
def test_no_sequence_of_messages_ends_the_run(
    fuzzed: Serving, driver: RawClient, data: list[bytes], cut: int
) -> None:
    stream = b"".join(data)
    with RawClient(fuzzed.port("one")) as client:
        client.send(stream[: len(stream) - cut] if cut < 20 else stream)
    driver.mode(2)
    driver.round()
    assert fuzzed.running
    assert not [line for line in fuzzed.lines if "Traceback" in line]
    x, y, _ = fuzzed.pose()
    assert 0 <= x <= 10
    assert 0 <= y <= 10
