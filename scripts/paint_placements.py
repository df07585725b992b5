"""Run Paint over many random placements, each run judged from true poses: a row each in a table.

    scripts/paint_placements [--worlds NAME ...] [--seeds FIRST LAST] [--jitter S ...]
                             [--jobs N] [--limit S] [--folder DIR] [--out FILE.csv]

Runs as far as the goals, without painting. A run ends when all robots are at their goals, or after
`--limit` simulated seconds (1800). It is a sweep into build/paint/placements of what the table
lacks, and can be interrupted; the rows of a table are in order of world, jitter and seed, and a run
gives the same row on every machine. With its defaults, the three cases with 200 seeds each and two
kinds of cycles, it takes more than an hour on two cores; a placement of 16 robots takes a minute or
two.
`scripts/pages paint` sums the table up in docs/results/paint.md.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

from pages import RESULTS, keep  # noqa: E402
from sweeps import JUDGE, runs, sweep  # noqa: E402

TABLE = RESULTS / "paint" / "placements.csv"
WORLDS = ("case_1", "case_2", "case_3", "line", "tall", "swarm_8", "swarm_12", "swarm_16")
LIMIT = 1800.0  # s
JITTER = "controllers.paint.args.jitter"
PAINT = "controllers.paint.args.paint"


class Row(NamedTuple):
    """One run: how many robots reached the goals that the paper gives them, and when all had."""

    world: str
    jitter: float  # s
    seed: int
    robots: int
    right: int
    contacts: int
    swaps: int  # changes of the order by height
    seconds: float  # simulated, until the run ended
    outcome: str


Key = tuple[str, float, int]


def read(path: Path) -> list[Row]:
    """The rows of a table; none if there is no such file."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [
            Row(
                line["world"],
                float(line["jitter"]),
                seed=int(line["seed"]),
                robots=int(line["robots"]),
                right=int(line["right"]),
                contacts=int(line["contacts"]),
                swaps=int(line["swaps"]),
                seconds=float(line["seconds"]),
                outcome=line["outcome"],
            )
            for line in csv.DictReader(file)
        ]


def swept(folder: Path) -> list[Row]:
    """The rows of what a sweep has run; of runs that have a result."""
    return [
        Row(
            str(row["world"]).removeprefix("paint_"),
            float(row[JITTER]),
            int(row["seed"]),
            len(result.robots),
            int(row["judged.right"]),
            int(row["judged.contacts"]),
            int(row["judged.passings"]),
            round(result.sim_time, 3),
            result.outcome,
        )
        for row, result in runs(folder)
        if result is not None and "judged.right" in row
    ]


def write(path: Path, rows: list[Row]) -> None:
    """Write a table anew, in order."""
    lines = [{**row._asdict(), "jitter": f"{row.jitter:g}"}.values() for row in sorted(rows)]
    keep(path, Row._fields, map(list, lines))


def write_asked(path: Path, keys: list[Key]) -> None:
    """The table of what a sweep is to run."""
    lines = [[f"paint_{world}", seed, jitter, "false"] for world, jitter, seed in keys]
    keep(path, ["world", "seed", JITTER, PAINT], lines)


def main() -> None:
    """Run what the table lacks."""
    options = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    options.add_argument("--worlds", nargs="+", choices=WORLDS, default=list(WORLDS[:3]))
    options.add_argument(
        "--seeds", type=int, nargs=2, default=(1000, 1199), metavar=("FIRST", "LAST")
    )
    options.add_argument("--jitter", type=float, nargs="+", default=[0.0, 1.0], help="s")
    options.add_argument("--jobs", type=int, default=2, help="runs at a time")
    options.add_argument("--limit", type=float, default=LIMIT, help="simulated s")
    options.add_argument("--folder", type=Path, default=ROOT / "build" / "paint" / "placements")
    options.add_argument("--out", type=Path, default=TABLE)
    given = options.parse_args()
    first, last = given.seeds
    if not 0 <= first <= last:
        options.error(f"--seeds: {first} to {last} holds no seed; give the first and the last")
    sound = all(math.isfinite(value) for value in (given.limit, *given.jitter))
    if not sound or given.jobs < 1 or given.limit <= 0.0 or min(given.jitter) < 0.0:
        options.error("--jobs has to be 1 or more, --limit above 0, --jitter 0 or more")
    try:
        rows = read(given.out)
        if given.out.exists() and not given.out.read_text(encoding="utf-8").startswith("world,"):
            raise ValueError("it does not begin with the names of the columns")
    except (KeyError, ValueError, TypeError, OSError) as error:
        options.error(f"{given.out} is not a table of this script ({error!r}); give another --out")
    done = {row[:3] for row in rows}
    wanted = [
        (world, jitter, seed)
        for seed in range(first, last + 1)
        for world in given.worlds
        for jitter in given.jitter
    ]
    todo = [key for key in wanted if key not in done]
    print(f"{len(todo)} runs, {len(wanted) - len(todo)} are in {given.out}", flush=True)
    if not todo:
        return
    asked = given.folder.with_suffix(".csv")
    write_asked(asked, todo)
    how = ["--table", asked, "--duration", given.limit, "--jobs", given.jobs, "--judge", JUDGE]
    try:
        sweep(given.folder, f"paint_{given.worlds[0]}", *map(str, how))
    finally:  # also of one that was interrupted
        fresh = {row[:3]: row for row in swept(given.folder)}
        write(given.out, [*rows, *(fresh[key] for key in todo if key in fresh)])
        print(f"the rows so far are in {given.out}")


if __name__ == "__main__":
    main()
