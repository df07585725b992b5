"""Robots that come in by several doors draw their chance by the order of entry, as on the grid."""

from __future__ import annotations

import math
from pathlib import Path

import troupe
from gridworld.grid import simulate
from gridworld.regions import load

WORLDS = Path(__file__).resolve().parents[2] / "worlds"
MAP = """\
###########
#....#....#
#S........#
#....#...S#
###########
"""
CELL = 1.5
Q = 0.2
SEED = 5
STEPS = 30  # two streams of robots get in each other's way at last, on the grid too


def test_bodies_and_the_grid_number_robots_alike_with_two_doors(tmp_path: Path) -> None:
    (tmp_path / "two.txt").write_text(MAP)
    world = tmp_path / "two.yaml"
    door = "at: S, model: disperser, heading: 90, period: 4.0, controller: fcdfs"
    world.write_text(
        f"include: [{WORLDS}/fcdfs_async.yaml]\n"
        f"map: {{file: two.txt, cell: {CELL}}}\n"
        # names that end in digits: a robot's number is not to be had from them
        f"doors:\n  - {{name: north1, {door}}}\n  - {{name: south2, {door}}}\n"
        f"controllers: {{fcdfs: {{args: {{q: {Q}}}}}}}\n"
    )
    region = load(tmp_path / "two.txt")
    grid = simulate(region, "light", seed=SEED, q=Q)
    assert grid.collisions == 0
    result = troupe.run(world, seed=SEED, duration=4.0 * STEPS + 2.0)
    entered = [step for step in grid.entered.tolist() if step <= STEPS]
    settled = [k for k, step in enumerate(grid.settled.tolist()) if 0 < step <= STEPS]
    assert {grid.door[k] for k in settled} == {0, 1}
    assert len(settled) >= 6
    assert [round(record.entered / 4.0) for record in result.robots] == entered
    for k in settled:
        record = result.robots[k]
        x, y, _ = record.pose
        cell = [math.floor(x / CELL), region.rows - 1 - math.floor(y / CELL)]
        moved = (record.properties["settled_step"], record.properties["travel"], cell)
        assert moved == (grid.settled[k], grid.moves[k], grid.cell[k].tolist()), record.name
