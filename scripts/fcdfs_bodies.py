"""Run FCDFS with bodies in the worlds that come with Troupe, beside the grid model.

    scripts/fcdfs_bodies [--quick] [--jobs N] [--folder DIR] [--out FOLDER]

A sweep into build/fcdfs, from which docs/results/fcdfs/bodies.csv and the page
docs/results/fcdfs_bodies.md are made. `--quick` leaves out the grid of 30 x 30 cells (minutes).
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

from pages import RESULTS, keep, write  # noqa: E402
from sweeps import runs, sweep  # noqa: E402

from troupe.testing.fcdfs import measures  # noqa: E402

WORLDS = (
    "corridor", "corridor_differential", "rooms", "rooms_differential", "maze", "spiral",
    "async", "grid_30x30",
)  # fmt: skip
HEADS = ["world", "robots", "agree", "steps", "total travel", "contacts", "simulated", "wall time"]


def main() -> None:
    """Run the worlds and write the table and the page."""
    options = argparse.ArgumentParser(prog="scripts/fcdfs_bodies", description=__doc__)
    options.add_argument("--quick", action="store_true")
    options.add_argument("--jobs", type=int, default=1, help="runs at a time")
    options.add_argument("--folder", type=Path, default=ROOT / "build" / "fcdfs")
    options.add_argument("--out", type=Path, default=RESULTS)
    given = options.parse_args()
    names = WORLDS[:-1] if given.quick else WORLDS
    worlds = [f"fcdfs_{name}" for name in names]
    sweep(given.folder, *worlds, "--jobs", str(given.jobs))
    rows = {}
    for row, result in runs(given.folder):
        assert result is not None, row
        found = measures(result)
        rows[row["world"]] = [
            row["world"].removeprefix("fcdfs_"),
            f"{len(result.robots)} of {found['cells']}",
            *(found[key] for key in ("agree", "steps", "travel", "contacts")),
            f"{result.sim_time:.0f} s",
            f"{row['wall_time']:.0f} s",
        ]
    keep(given.out / "fcdfs" / "bodies.csv", HEADS, [rows[name] for name in worlds])
    print(write("fcdfs_bodies", given.out))


if __name__ == "__main__":
    main()
