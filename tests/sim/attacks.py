"""What clients may do to a run that is not theirs."""

from __future__ import annotations

import contextlib
import random
import socket
import struct
from collections.abc import Callable

import pytest

from tests.sim.served_world import WORLD
from tests.sim.serving import Serving
from troupe.testing.wire import (
    ACK,
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
