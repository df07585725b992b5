"""Sprayers in whole runs: what is painted is what was swept, at any clock."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import troupe

TURN = """\
from player import DioProxy, PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base, sprayer = Position2dProxy(robot), DioProxy(robot)
    robot.read()
    sprayer.set_output(1)
    base.set_speed(0.0, 1.5707963)
    while robot.read():
        if robot.time > 5.0:
            break
"""
WORLD = """\
size: [10, 10]
duration: 60
models:
  r:
    body: {shape: circle, radius: 0.2}
    actuators: [{type: sprayer, size: [4, 0.1]}]
robots:
  - {model: r, name: a, pose: [5, 5, 0], controller: s}
controllers:
  s: {program: ./turn.py}
"""


@pytest.mark.parametrize("interval", [0.1, 0.5, 2.0])
def test_a_long_sprayer_turned_on_the_spot_paints_its_disc(tmp_path: Path, interval: float) -> None:
    (tmp_path / "turn.py").write_text(TURN)
    (tmp_path / "world.yaml").write_text(WORLD)
    result = troupe.run(tmp_path / "world.yaml", settings=[f"clock.interval={interval}"])
    x, y = np.meshgrid(*[(np.arange(200) + 0.5) * 0.05 - 5.0] * 2)
    disc = np.count_nonzero(np.hypot(x, y) < np.hypot(2.0, 0.05))
    # No centre lies within 0.1 mm of the rim, which is cut to a thousandth of a cell, 0.05 mm.
    assert abs(np.hypot(x, y) - np.hypot(2.0, 0.05)).min() > 1e-4
    assert round(result.floor.painted_area / 0.05**2) == disc
