"""Reproduce the results of the FCDFS paper on the grid: docs/results/fcdfs.md and its tables.

    scripts/fcdfs_tables [--runs N] [--regions N] [--cells N] [--no-large] [--jobs N]
                         [--folder DIR] [--out FOLDER]

A sweep into build/fcdfs_grid, which goes on where it was when it is called again; with its defaults
it takes a minute on one core. The tables are made of the sweep's rows; only what shows no outcome
of runs is drawn and measured here: pictures, curves, and what a step costs. The page's prose is in
scripts/templates. Needs matplotlib (extra "plots").
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

import fcdfs_runs as asked  # noqa: E402
import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from fcdfs_runs import Found  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from pages import keep, keep_about, write  # noqa: E402
from sweeps import sweep  # noqa: E402

from gridworld import studies  # noqa: E402
from gridworld.generators import ring  # noqa: E402
from gridworld.grid import GridRun  # noqa: E402
from gridworld.median import best_door, sums_of_distances  # noqa: E402
from gridworld.regions import Region, rectangle  # noqa: E402
from troupe.grid_film import picture_of, write_picture  # noqa: E402


def pair(total: float, most: float) -> str:
    return f"{total:.0f} ({most:.0f})"


def table_1(folder: Path, found: Found, runs: int) -> None:
    without: list[list[object]] = []
    pauses: list[list[object]] = []
    for name, paper in studies.TABLE_1.items():
        means = {
            one["rule"]: studies.averages(found.of(one))
            for one in asked.table_1(runs)
            if one["region"] == name
        }
        cells = [pair(row.moves, row.most_moves) for row in means.values()]
        without.append([f"{name} (V = {studies.table_region(name).cells})", *cells])
        without.append(["the paper", *(pair(*figures) for figures in paper), "", "", ""])
        pauses.extend(
            [
                name,
                rule,
                pair(row.travel, row.most_travel),
                f"{row.makespan:.0f}",
                f"{row.spread:.0f}",
            ]
            for rule, row in means.items()
            if rule in ("dflf", "bflf", "fcdfs")
        )
    rules = ["DFLF", "BFLF", "FCDFS", "five bits", "symmetric", "left hand"]
    keep(folder / "table_1.csv", ["region", *rules], without)
    heads = ["region", "rule", "total (maximal) travel", "makespan", "deviation"]
    keep(folder / "pauses.csv", heads, pauses)


def doors(folder: Path, found: Found) -> None:
    names = ("best_door", "best_total", "own_door", "own_total", "worst_total")
    rows = []
    for name in studies.TABLE_1:
        row = found.one({"world": asked.DOORS, "seed": 0, "region": name})
        rows.append([name, *(row[key] for key in names)])
    heads = ["region", "best door", "its total", "door above", "its total", "worst total"]
    keep(folder / "doors.csv", heads, rows)


def combs(folder: Path, found: Found) -> None:
    rows: dict[str, list[object]] = {}
    for one in asked.combs():
        row = found.one(one)
        cells = rows.setdefault(one["region"], [one["region"][5:] or "none", row["cells"]])
        if one["rule"] == "fcdfs":
            cells.append(row["sum_of_distances"])
        done = row["outcome"] == "completed"
        short = f"{row['outcome']}, step {row['steps']}"
        cells.append(pair(row["total_moves"], row["max_moves"]) if done else short)
    heads = ["k", "V", "sum of distances", "FCDFS", "DFLF", "BFLF without pauses"]
    keep(folder / "combs.csv", heads, rows.values())


def rings(folder: Path, found: Found) -> None:
    rows = []
    for one in asked.rings():
        row = found.one(one)
        _, side, thickness = one["region"].split()
        name = f"{side}x{side}, {thickness} wide"
        came = f"{row['entered']} of {row['cells']}"
        end = row["outcome"].replace("_", " ")
        rows.append([name, one["conflict"], end, came, row["settled"], row["steps"]])
    heads = ["ring", "conflict", "end", "entered", "settled", "steps"]
    keep(folder / "rings.csv", heads, rows)


def missed_steps(folder: Path, found: Found, regions: int) -> None:
    rows: list[list[object]] = []
    shares: dict[tuple[str, str], list[studies.Share]] = {}
    for one in asked.missed_steps(regions):
        runs = found.of(one)
        s = studies.share(runs, [2 * run["cells"] - 1 for run in runs])
        shares.setdefault((one["rule"], one["conflict"]), []).append(s)
        rows.append(
            [
                *(one["q"], one["rule"], one["conflict"]),
                *(f"{s.covered:.1%}", f"{s.settled:.1%}", f"{s.collided:.1%}"),
                *(f"{s.on_shortest_paths:.1%}", f"{s.slower:.2f}" if s.covered else "none covered"),
            ]
        )
    draw_missed_steps(folder, shares)
    heads = ["q", "rule", "conflict", "covered", "cells settled", "collided"]
    heads += ["moves = distances", "makespan / (2V - 1)"]
    keep(folder / "missed_steps.csv", heads, rows)


def later_paper(folder: Path, found: Found, runs: int) -> None:
    means = {
        (one["region"], one["rule"], one["q"]): studies.averages(found.of(one))
        for one in asked.later_paper(runs)
    }
    rows: list[list[object]] = []
    for name, lines in studies.TABLE_2.items():
        region = studies.table_region(name)
        for (rule, q), (cells, travel, energy, makespan) in lines.items():
            here = means[name, rule, q]
            called = f"AsynchFCDFS, p = {1 - q:g}" if rule == "light" else rule.upper()
            share = here.steps * studies.most_entries(q) / region.cells
            rows.append(
                [
                    *(name, called, f"{here.energy:.0f}"),
                    *(f"{energy / travel:.2f}", f"{here.energy / here.moves:.2f}"),
                    *(f"{makespan / cells:.2f}", f"{here.steps / region.cells:.2f}"),
                    f"{share:.3f}",
                ]
            )
    heads = ["region", "rule", "energy", "energy / moves: the paper", "here"]
    heads += ["makespan / V: the paper", "here", "of V / alpha"]
    keep(folder / "later_paper.csv", heads, rows)
    corridors = []
    for q in asked.ASLEEP:
        spans = {n: means[f"{n}x1", "light", q].makespan for n in asked.CORRIDORS}
        alpha = studies.most_entries(q)
        corridors.append([f"{1 - q:g}", *(f"{span * alpha / n:.3f}" for n, span in spans.items())])
    keep(folder / "corridors.csv", ["p", *map(str, asked.CORRIDORS)], corridors)


def several_doors(folder: Path, found: Found, regions: int) -> None:
    rows = []
    for one in asked.several_doors(regions):
        runs, count = found.of(one), one["doors"]
        s = studies.share(runs, [2 * run["cells"] / count for run in runs])
        shown = (f"{s.covered:.1%}", f"{s.collided:.1%}", f"{s.slower:.2f}")
        rows.append([count, one["conflict"], *shown])
    heads = ["doors", "conflict", "covered", "collided", "makespan / (2V / doors)"]
    keep(folder / "several_doors.csv", heads, rows)


def small_regions(folder: Path, found: Found, cells: int) -> None:
    rows = []
    for size in range(1, cells + 1):
        row = found.one({"world": asked.SMALL, "seed": 0, "size": size})
        rows.append([size, row["tried"], row["not_optimal"], row["spared"]])
    heads = ["cells", "region and door", "not optimal", "with a hole, no collision"]
    keep(folder / "small_regions.csv", heads, rows)


def cost(folder: Path, large: bool) -> None:
    """What depends on the machine is no outcome of a run: it is measured here, alone."""
    rows = []
    for side in (100, 316, *((1000,) if large else ())):
        run = GridRun(rectangle(side, side, [(side // 2, side // 2)]), "fcdfs")
        start = time.process_time()
        run.advance(10**9)
        seconds = time.process_time() - start
        travel = run.outcome().figures()["total_travel"]
        rows.append(
            [f"{side}x{side}", f"{travel:,}", f"{seconds:.2f}", f"{seconds / travel * 1e9:.0f}"]
        )
    keep(folder / "cost.csv", ["region", "robot steps", "seconds", "ns per robot step"], rows)


def pictures(folder: Path) -> None:
    """Draw the ends of steps, and the total travel by door."""
    for name, rule, step in (
        ("flat", "fcdfs", 420),
        ("labyrinth", "fcdfs", 900),
        ("apartment", "left_hand", 350),
    ):
        picture(folder, name, studies.table_region(name), rule, step)
    square = rectangle(30, 30, [(13, 13)])
    picture(folder, "symmetric", square, "symmetric", 900, seed=1)
    frame = ring(12, 12, 1).with_doors([(5, 0)])
    picture(folder, "ring", frame, "fcdfs", 200, conflict="stay")
    region = studies.table_region("labyrinth")
    figure, axes = plt.subplots(figsize=(4.6, 4.2))
    sums = np.where(region.free, sums_of_distances(region.free), np.nan)
    shown = axes.imshow(sums, cmap="viridis_r")
    axes.plot(*best_door(region), "r*", markersize=11)
    axes.set(xticks=[], yticks=[], title="total travel by door, labyrinth")
    figure.colorbar(shown)
    save(figure, folder / "doors.png")


def picture(folder: Path, name: str, region: Region, rule: str, steps: int, **more: object) -> None:
    """Draw the end of a step."""
    run = GridRun(region, rule, **more)  # type: ignore[arg-type]
    run.advance(steps)
    pixels = max(4, 420 // max(region.columns + 2, region.rows + 2))
    write_picture(folder / f"{name}.png", picture_of(run, rule, pixels), run)


def draw_missed_steps(folder: Path, shares: dict[tuple[str, str], list[studies.Share]]) -> None:
    """Draw coverage and makespan against the probability of a missed step."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2))
    failures = asked.FAILURES
    for (rule, conflict), found in shares.items():
        label = "light (AsynchFCDFS)" if rule == "light" else f"{rule}, {conflict}"
        left.plot(failures, [100 * s.settled for s in found], "o-", label=label)
        if rule == "light":
            right.plot(failures, [s.slower for s in found], "o-C2", label="light (AsynchFCDFS)")
    right.plot(failures, [1 / (1 - q) for q in failures], "k:", label="1 / (1 - q)")
    bound = [0.5 / studies.most_entries(q) for q in failures]
    right.plot(failures, bound, "k--", label="V / alpha")
    left.set(xlabel="q", ylabel="cells settled, %", title="coverage")
    right.set(xlabel="q", ylabel="makespan / (2V - 1)", title="makespan")
    for axes in (left, right):
        axes.legend()
    save(figure, folder / "missed_steps.png")


def save(figure: Figure, path: Path) -> None:
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    plt.close(figure)


def main() -> None:
    """Sweep, and write the tables, the pictures and the page."""
    options = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    options.add_argument("--runs", type=int, default=100, help="seeds per rule with chance in it")
    options.add_argument("--regions", type=int, default=300, help="random regions")
    options.add_argument("--cells", type=int, default=9, help="size of the largest polyominoes")
    options.add_argument("--no-large", action="store_true", help="leave out 1000x1000")
    options.add_argument("--jobs", type=int, default=2, help="runs at a time")
    options.add_argument("--folder", type=Path, default=ROOT / "build" / "fcdfs_grid")
    options.add_argument("--out", type=Path, default=ROOT / "docs" / "results")
    given = options.parse_args()
    table = given.folder.with_suffix(".csv")
    asked.write_asked(table, asked.everything(given.runs, given.regions, given.cells))
    sweep(given.folder, "--table", table, "--jobs", str(given.jobs))
    found = Found(given.folder)
    folder = given.out / "fcdfs"
    folder.mkdir(parents=True, exist_ok=True)
    table_1(folder, found, given.runs)
    doors(folder, found)
    combs(folder, found)
    rings(folder, found)
    missed_steps(folder, found, given.regions)
    later_paper(folder, found, given.runs)
    several_doors(folder, found, given.regions)
    small_regions(folder, found, given.cells)
    pictures(folder)
    cost(folder, not given.no_large)
    keep_about(folder, {"runs": given.runs, "regions": given.regions})
    print(write("fcdfs", given.out))


if __name__ == "__main__":
    main()
