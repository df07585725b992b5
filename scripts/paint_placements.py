"""Run Paint over many random placements, each run judged from true poses: a row each in a table.

    scripts/paint_placements [--worlds NAME ...] [--seeds FIRST LAST] [--jitter S ...]
                             [--jobs N] [--limit S] [--out FILE.csv]

Runs as far as the goals, without painting. A run ends when all robots are at their goals, or after
`--limit` simulated seconds (1800). Rows that the table holds already are not run again, so that it
can be interrupted; the rows of a table are in order of world, jitter and seed, and a run gives the
same row on every machine. With its defaults, the three cases with 200 seeds each and two kinds of
cycles, it takes more than an hour on two cores; a placement of 16 robots takes a minute or two.
`scripts/paint_cases` sums the table up in docs/results/paint.md.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import signal
import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import active_children, get_context
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT)]

from troupe.testing.paint.judge import judged_run  # noqa: E402

TABLE = ROOT / "docs" / "results" / "paint" / "placements.csv"
WORLDS = ("case_1", "case_2", "case_3", "line", "tall", "swarm_8", "swarm_12", "swarm_16")
LIMIT = 1800.0  # s


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


def run(world: str, jitter: float, seed: int, limit: float = LIMIT) -> Row:
    """One placement, as far as the goals."""
    settings = ["controllers.paint.args.paint=false", f"controllers.paint.args.jitter={jitter:g}"]
    judged = judged_run(ROOT / "worlds" / f"paint_{world}.yaml", seed, settings, limit)
    return Row(
        world,
        jitter,
        seed,
        len(judged.right),
        sum(judged.right),
        len(judged.contacts),
        len(judged.swaps),
        round(judged.result["sim_time"], 3),
        judged.result["outcome"],
    )


def read(path: Path) -> list[Row]:
    """The rows of a table; none if there is no such file."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return [
            Row(
                line["world"],
                float(line["jitter"]),
                *(int(line[key]) for key in ("seed", "robots", "right", "contacts", "swaps")),
                float(line["seconds"]),
                line["outcome"],
            )
            for line in csv.DictReader(file)
        ]


def write(path: Path, rows: Iterable[Row]) -> None:
    """Write a table anew, in order; who interrupts this loses nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_suffix(".tmp")
    with fresh.open("w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(Row._fields)
        for row in sorted(rows):
            out.writerow([f"{v:g}" if name == "jitter" else v for name, v in row._asdict().items()])
    os.replace(fresh, path)


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
    pool = ProcessPoolExecutor(given.jobs, get_context("spawn"))
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        runs = [pool.submit(run, *key, given.limit) for key in todo]
        for count, future in enumerate(as_completed(runs), 1):
            rows.append(future.result())
            write(given.out, rows)
            print(f"{count} of {len(todo)}:", *rows[-1], flush=True)
    except KeyboardInterrupt:
        for worker in active_children():
            worker.terminate()
        pool.shutdown(cancel_futures=True)
        print(f"interrupted; the rows so far are in {given.out}", file=sys.stderr)
        sys.exit(130)
    finally:
        pool.shutdown(cancel_futures=True)


if __name__ == "__main__":
    main()
