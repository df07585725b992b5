"""Run FCDFS with bodies in the worlds that come with Troupe, beside the grid model.

    scripts/fcdfs_bodies [--quick] [--out FILE]

Writes docs/results/fcdfs_bodies.md. `--quick` leaves out the grid of 30 x 30 cells (minutes).
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import troupe  # noqa: E402
from gridworld.grid import Outcome, simulate  # noqa: E402
from gridworld.regions import Region, load  # noqa: E402
from sim.result import Result  # noqa: E402
from troupe.testing.fcdfs import agreeing  # noqa: E402

WORLDS = (
    "corridor", "corridor_differential", "rooms", "rooms_differential", "maze", "spiral",
    "async", "grid_30x30",
)  # fmt: skip

HEAD = """\
# FCDFS with bodies

Written by `scripts/fcdfs_bodies`. In these worlds the rule that the grid model compiles drives
robots of 1 x 1 m in cells of 1.5 m: pymunk moves them, two lasers of 180 rays show them the cells
around, and each robot has a process of its own that ends when it settles. `agree` counts the
robots that entered, moved, settled and stand exactly as in the grid model: the step of entry, the
number of moves, the step in which they settled, and the cell. Contacts are counted by the physics.

| world | robots | agree | steps | total travel | contacts | simulated | wall time |
| --- | --- | --- | --- | --- | --- | --- | --- |
"""


def main() -> None:
    """Run the worlds and write the page."""
    options = argparse.ArgumentParser(prog="scripts/fcdfs_bodies", description=__doc__)
    options.add_argument("--quick", action="store_true")
    options.add_argument("--out", type=Path, default=ROOT / "docs/results/fcdfs_bodies.md")
    args = options.parse_args()
    rows = []
    for name in WORLDS[:-1] if args.quick else WORLDS:
        path = ROOT / "worlds" / f"fcdfs_{name}.yaml"
        world = troupe.load(path)
        assert world.map is not None
        region = load(path.parent / world.map.file)
        told = world.controllers["fcdfs"].args
        result = troupe.run(path)
        grid = simulate(region, told["rule"], seed=result.seed, q=told.get("q", 0.0))
        rows.append(row(name, region, grid, result))
        print(rows[-1], flush=True)
    args.out.write_text(HEAD + "\n".join(rows) + "\n")


def row(name: str, region: Region, grid: Outcome, result: Result) -> str:
    """One line of the table."""
    agree = sum(agreeing(result, region, grid))
    travel = sum(record.properties.get("travel", 0) for record in result.robots)
    contacts = sum(record.contacts for record in result.robots)
    last = result.doors[0].steps[-1]
    return (
        f"| {name} | {len(result.robots)} of {grid.cells} | {agree} | {last} | {travel} | "
        f"{contacts} | {result.sim_time:.0f} s | {result.wall_time:.0f} s |"
    )


if __name__ == "__main__":
    main()
