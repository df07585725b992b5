"""A map of one's own, of up to 250 cells, goes with any of the worlds of FCDFS."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from gridworld.regions import load as load_region
from sim.build import load
from tests.troupe.test_check import APP
from troupe.worlds import find_world

CELLS = 250
WORLDS = ("corridor", "corridor_differential", "rooms", "rooms_differential", "maze", "spiral")


@pytest.fixture
def own_map(tmp_path: Path) -> Path:
    """A comb: a spine of 25 cells with the door at its end, and teeth of 18 or 17 cells."""
    spine = "#S" + "." * 24 + "#"
    teeth = [
        "#" + "".join("." if c % 2 == 0 and (r < 17 or c < 8) else "#" for c in range(25)) + "#"
        for r in range(18)
    ]
    path = tmp_path / "comb.txt"
    path.write_text("\n".join(["#" * 27, spine, *teeth, "#" * 27]) + "\n")
    region = load_region(path)
    region.check(holes=False)  # simply connected
    assert region.cells == CELLS
    return path


@pytest.mark.parametrize("name", WORLDS)
def test_it_is_accepted_and_there_is_time_for_all_its_robots(own_map: Path, name: str) -> None:
    setting = f"map.file={own_map}"
    done = CliRunner().invoke(APP, ["check", f"fcdfs_{name}", "--set", setting])
    assert done.exit_code == 0, done.stderr
    world = load(find_world(f"fcdfs_{name}"), settings=[setting]).world
    (door,) = world.doors
    # Robot V enters at the end of step 2V - 1, looks in the next step and ends one tick later:
    # two steps more are enough for the last one to report.
    assert world.duration >= (2 * CELLS - 1 + 2) * door.period
