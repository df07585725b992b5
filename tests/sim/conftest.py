"""Worlds that the tests of serving run."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.sim.serving import World, write_world

WORLD = """\
size: [20, 20]
until: {until}
models:
  rover:
    body: {{shape: box, size: [1, 1]}}
    sensors: [{{type: laser, samples: 5}}]
robots:
  - {{name: one, model: rover, pose: [3, 4, 0], controller: hand}}
  - {{name: two, model: rover, pose: [3, 8, 0], controller: {second}}}
controllers:
  hand: {{external: true}}
  wander: {{program: wander}}
player: {{layout: {layout}, clock: {clock}}}
"""


@pytest.fixture
def world(tmp_path: Path) -> World:
    """Two robots; the second stands unless told otherwise."""

    def make(
        second: str = "null",
        layout: str = "per_robot",
        clock: str = "all",
        until: str = "controllers",
    ) -> Path:
        text = WORLD.format(second=second, layout=layout, clock=clock, until=until)
        return write_world(tmp_path, text)

    return make


@pytest.fixture
def busy() -> Iterator[None]:
    """Every processor is kept busy by others."""
    count = 2 * (os.cpu_count() or 1)
    loops = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(count)]
    yield
    for loop in loops:
        loop.kill()
        loop.wait()
