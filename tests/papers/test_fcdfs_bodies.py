"""FCDFS with bodies: in the simulated world robots make exactly the moves of the grid model."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import psutil
import pytest

import troupe
from gridworld.generators import random_region
from gridworld.grid import Outcome, simulate
from gridworld.regions import Region, load
from sim.result import Result
from tests.processes import ROOT
from troupe.testing.fcdfs import faults

WORLDS = ROOT / "worlds"


def agree(result: Result, region: Region, grid: Outcome) -> None:
    """The run is the grid's, robot by robot; nobody touched anything."""
    assert faults(result, region, grid) == []
    door = result.doors[0]
    assert door.emitted == grid.cells
    assert door.steps == grid.entered.tolist()


def bits(grid: Outcome) -> list[str]:
    return [f"{state & 31:05b}" for state in grid.state.tolist()]


@pytest.mark.parametrize(
    "name",
    ["corridor", "maze", "rooms", "spiral", "corridor_differential", "rooms_differential"],
)
def test_bodies_move_as_the_grid_model_says(name: str) -> None:
    region = load(WORLDS / "maps" / f"{name.partition('_')[0]}.txt")
    grid = simulate(region, "fcdfs5")
    result = troupe.run(WORLDS / f"fcdfs_{name}.yaml")
    agree(result, region, grid)
    assert [record.properties["bits"] for record in result.robots] == bits(grid)
    assert result.doors[0].steps == [2 * k + 1 for k in range(grid.cells)]
    assert [record.properties["travel"] for record in result.robots] == grid.travel.tolist()
    assert sum(grid.travel.tolist()) == grid.sum_of_distances


def test_no_more_processes_are_alive_than_there_are_active_robots() -> None:
    """A robot's process ends when it settles; besides there are the fork server and its keeper."""
    counts = []

    def count(simulation: troupe.Simulation) -> None:
        if simulation.ticks % 10 == 0:
            alive = [
                child
                for child in psutil.Process().children(recursive=True)
                if child.status() != psutil.STATUS_ZOMBIE
            ]
            counts.append((len(alive), simulation.states.count("running")))

    before = len(psutil.Process().children(recursive=True))
    troupe.run(WORLDS / "fcdfs_corridor.yaml", each_tick=count)
    assert all(alive - before - 2 <= active for alive, active in counts)
    assert max(active for _, active in counts) > 3


@pytest.mark.parametrize("kind", ["grown", "eroded", "branching", "maze", "rooms"])
def test_any_simply_connected_map_gives_the_grids_moves(kind: str, tmp_path: Path) -> None:
    region = random_region(kind, np.random.default_rng(5), 6)
    map_file = tmp_path / "map.txt"
    map_file.write_text(region.to_text())
    result = troupe.run(WORLDS / "fcdfs_rooms.yaml", settings=[f"map.file={map_file}"])
    agree(result, region, simulate(load(map_file), "fcdfs5"))


@pytest.mark.parametrize("rule", ["fcdfs", "symmetric", "left_hand"])
def test_other_rules_drive_bodies_too(rule: str) -> None:
    region = load(WORLDS / "maps" / "corridor.txt")
    result = troupe.run(
        WORLDS / "fcdfs_corridor.yaml", settings=[f"controllers.fcdfs.args.rule={rule}"]
    )
    agree(result, region, simulate(region, rule, seed=result.seed))


@pytest.mark.parametrize(("name", "q"), [("corridor", 0.2), ("rooms", 0.1)])
def test_robots_that_miss_steps_cover_everything_by_the_light(name: str, q: float) -> None:
    map_file = WORLDS / "maps" / f"{name}.txt"
    result = troupe.run(
        WORLDS / "fcdfs_async.yaml",
        settings=[f"map.file={map_file}", f"controllers.fcdfs.args.q={q}"],
    )
    region = load(map_file)
    grid = simulate(region, "light", seed=result.seed, q=q)
    agree(result, region, grid)
    assert {record.properties["color"] for record in result.robots} == {"#0000ff"}
    assert sum(grid.moves.tolist()) == grid.sum_of_distances
