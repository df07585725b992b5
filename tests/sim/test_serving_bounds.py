"""What a run keeps for its clients, and of those that have gone, is bounded."""

from __future__ import annotations

import gc
import socket
import struct
import tracemalloc
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.sim.attacks import (
    ONE_DRIVES,
    ROUNDS,
    absurd_counts,
    garbage,
    truncated,
    vanishes_with_subscriptions,
)
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    ACK,
    GRAPHICS2D,
    LASER,
    NACK,
    POSITION2D,
    SIMULATION,
    RawClient,
    pulling,
    pushed,
    text,
)


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_world(tmp_path_factory.mktemp("robust"), ONE_DRIVES)


@pytest.fixture
def run(path: Path) -> Iterator[Serving]:
    with Serving(path) as serving:
        yield serving


def test_a_reader_that_has_stopped_reading_keeps_a_bounded_queue(run: Serving) -> None:
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
