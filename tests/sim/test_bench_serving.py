"""Benchmark of lockstep over TCP: `pytest tests/sim/test_bench_serving.py --benchmark-only`.

Old clients leave Nagle's algorithm on and write a command and a request one after the other: a
server that acknowledges late costs them 40 ms a round.
"""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from tests.sim.served_world import WORLD
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import LASER, POSITION2D, pulling

ALONE = WORLD.replace("pose: [6.5, 5.5, -100], controller: hand", "pose: [6.5, 5.5, -100]")


@pytest.mark.parametrize("nodelay", [1, 0])
def test_300_rounds_of_read_and_command(benchmark, tmp_path: Path, nodelay: int) -> None:
    with (
        Serving(write_world(tmp_path, ALONE)) as run,
        pulling(run.port("one"), (POSITION2D, 0), (LASER, 0)) as client,
    ):
        client.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, nodelay)

        def rounds() -> None:
            for _ in range(300):
                client.drive(0.1)
                client.round()

        benchmark.pedantic(rounds, rounds=5, warmup_rounds=1)
