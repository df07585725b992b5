"""A run in which one client drives, the other robot stands: what that client is told of itself."""

from __future__ import annotations

from tests.sim.served_world import WORLD
from tests.sim.serving import Serving
from troupe.testing.wire import POSITION2D, RawClient, pulling

ONLY_ONE = WORLD.replace("pose: [6.5, 5.5, -100], controller: hand", "pose: [6.5, 5.5, -100]")
"""The second robot has no controller: it stands, and one client drives the run."""


def client_of(run: Serving, *devices: tuple[int, int]) -> RawClient:
    return pulling(run.port("one"), (POSITION2D, 0), *devices)


def state(client: RawClient, rounds: int = 1) -> tuple[float, ...]:
    """The last state after some rounds: pose, velocity, stall."""
    for _ in range(rounds):
        got = client.round()
    return got[POSITION2D, 0, 1].unpack("6dI")
