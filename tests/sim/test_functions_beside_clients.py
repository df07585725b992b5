"""A robot that a function drives, and a client that reads it: both see what either changes."""

from __future__ import annotations

import math
from pathlib import Path

from player import LaserConfig, LaserProxy, Robot
from tests.sim.served_world import WORLD
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import LASER, POSITION2D, pulling

MIXED = WORLD.replace("30], controller: hand", "30], controller: mine").replace(
    "{hand: {external: true}}", "{hand: {external: true}, mine: {program: wander}}"
)
"""Robot one has a program, in whose place a function stands; robot two is driven by a client."""

NARROW = LaserConfig(-0.5, 0.5, math.radians(1), 5.0, 0.0, False, 10.0)
LATER = 5
"""Ticks after which the function narrows its robot's scan."""


def test_a_scan_that_a_function_has_narrowed_is_narrow_for_clients_too(tmp_path: Path) -> None:
    lasers: list[LaserProxy] = []

    def narrow(robot: Robot) -> None:
        lasers.append(robot.laser)
        if len(lasers) == LATER:
            robot.laser.configure(NARROW)

    path = write_world(tmp_path, MIXED)
    with (
        Serving(path, controllers={"hand": True, "mine": narrow}) as run,
        pulling(run.port("two"), (POSITION2D, 0)) as clock,
        pulling(run.port("one"), (LASER, 0)) as client,
    ):
        sizes = []
        for _ in range(2 * LATER):
            client.ask()
            clock.round()
            sizes.append(len(client.answer()[LASER, 0, 1].payload))
    assert sizes[0] > sizes[-1]
    assert lasers[-1].count == (sizes[-1] - (sizes[0] - 181 * 4)) / 4
