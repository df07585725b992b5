"""Reproduce the results of the FCDFS paper on the grid: docs/results/fcdfs.md and its tables.

    scripts/fcdfs_tables [--runs N] [--regions N] [--cells N] [--no-large] [--out FOLDER]

With its defaults it takes some minutes on one core. The grid model is no world and no run, so
these tables come from no sweep; the page's prose is in scripts/templates. Needs matplotlib (extra
"plots").
"""

import argparse
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from pages import keep, keep_about, write  # noqa: E402

from gridworld import studies  # noqa: E402
from gridworld.generators import comb, ring  # noqa: E402
from gridworld.grid import GridRun, simulate  # noqa: E402
from gridworld.median import best_door, sums_of_distances  # noqa: E402
from gridworld.regions import Region, rectangle  # noqa: E402
from troupe.grid_film import picture_of, write_picture  # noqa: E402

FAILURES = (0.0, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5)


def pair(total: float, most: float) -> str:
    return f"{total:.0f} ({most:.0f})"


def picture(folder: Path, name: str, region: Region, rule: str, steps: int, **more: object) -> None:
    """Draw the end of a step."""
    run = GridRun(region, rule, **more)  # type: ignore[arg-type]
    run.advance(steps)
    pixels = max(4, 420 // max(region.columns + 2, region.rows + 2))
    write_picture(folder / f"{name}.png", picture_of(run, rule, pixels), run)


def table_1(folder: Path, runs: int) -> None:
    without: list[list[object]] = []
    pauses: list[list[object]] = []
    for name, paper in studies.TABLE_1.items():
        region = studies.table_region(name)
        found = {rule: studies.averages(region, rule, runs) for rule in ("dflf", "bflf")}
        found |= {
            rule: studies.averages(region, rule, 1 if rule != "symmetric" else runs)
            for rule in ("fcdfs", "fcdfs5", "symmetric", "left_hand")
        }
        cells = [pair(row.moves, row.most_moves) for row in found.values()]
        without.append([f"{name} (V = {region.cells})", *cells])
        without.append(["the paper", *(pair(*figures) for figures in paper), "", "", ""])
        pauses.extend(
            [
                name,
                rule,
                pair(row.travel, row.most_travel),
                f"{row.makespan:.0f}",
                f"{row.spread:.0f}",
            ]
            for rule, row in found.items()
            if rule in ("dflf", "bflf", "fcdfs")
        )
    rules = ["DFLF", "BFLF", "FCDFS", "five bits", "symmetric", "left hand"]
    keep(folder / "table_1.csv", ["region", *rules], without)
    heads = ["region", "rule", "total (maximal) travel", "makespan", "deviation"]
    keep(folder / "pauses.csv", heads, pauses)
    for name, rule, step in (
        ("flat", "fcdfs", 420),
        ("labyrinth", "fcdfs", 900),
        ("apartment", "left_hand", 350),
    ):
        picture(folder, name, studies.table_region(name), rule, step)
    region = rectangle(30, 30, [(13, 13)])
    picture(folder, "symmetric", region, "symmetric", 900, seed=1)


def doors(folder: Path) -> None:
    rows = []
    for name in studies.TABLE_1:
        region = studies.table_region(name)
        sums = sums_of_distances(region.free)
        free = sums[region.free]
        (column, row), best = region.doors[0], best_door(region)
        rows.append(
            [
                name,
                f"{best[0]},{best[1]}",
                free.min(),
                f"{column},{row}",
                sums[row, column],
                free.max(),
            ]
        )
    region = studies.table_region("labyrinth")
    figure, axes = plt.subplots(figsize=(4.6, 4.2))
    sums = np.where(region.free, sums_of_distances(region.free), np.nan)
    shown = axes.imshow(sums, cmap="viridis_r")
    axes.plot(*best_door(region), "r*", markersize=11)
    axes.set(xticks=[], yticks=[], title="total travel by door, labyrinth")
    figure.colorbar(shown)
    save(figure, folder / "doors.png")
    heads = ["region", "best door", "its total", "door above", "its total", "worst total"]
    keep(folder / "doors.csv", heads, rows)


def combs(folder: Path) -> None:
    rows = []
    for k in (None, 2, 6, 11, 16, 20):
        region = comb(k)
        row: list[object] = ["none" if k is None else k, region.cells]
        for rule in ("fcdfs", "dflf", "bflf"):
            outcome = simulate(region, rule, seed=1)
            if rule == "fcdfs":
                row.append(outcome.sum_of_distances)
            total = pair(outcome.moves.sum(), outcome.moves.max())
            row.append(total if outcome.all_settled else f"{outcome.outcome}, step {outcome.steps}")
        rows.append(row)
    keep(
        folder / "combs.csv",
        ["k", "V", "sum of distances", "FCDFS", "DFLF", "BFLF without pauses"],
        rows,
    )


def rings(folder: Path) -> None:
    rows = []
    for columns, thickness, door in ((8, 1, (0, 4)), (12, 1, (5, 0)), (12, 2, (0, 5))):
        region = ring(columns, columns, thickness).with_doors([door])
        for conflict in ("stop", "stay"):
            out = simulate(region, conflict=conflict)
            name, end = f"{columns}x{columns}, {thickness} wide", out.outcome.replace("_", " ")
            came, settled = f"{len(out.entered)} of {out.cells}", int((out.settled > 0).sum())
            rows.append([name, conflict, end, came, settled, out.steps])
    region = ring(12, 12, 1).with_doors([(5, 0)])
    picture(folder, "ring", region, "fcdfs", 200, conflict="stay")
    heads = ["ring", "conflict", "end", "entered", "settled", "steps"]
    keep(folder / "rings.csv", heads, rows)


def missed_steps(folder: Path, regions: list[Region]) -> None:
    rows: list[list[object]] = []
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.2))
    for rule, conflict in (("fcdfs", "stop"), ("fcdfs", "stay"), ("light", "stop")):
        found = [studies.with_missed_steps(regions, rule, q, conflict) for q in FAILURES]
        rows.extend(
            [
                *(q, rule, conflict, f"{s.covered:.1%}", f"{s.settled:.1%}", f"{s.collided:.1%}"),
                *(f"{s.on_shortest_paths:.1%}", f"{s.slower:.2f}" if s.covered else "none covered"),
            ]
            for q, s in zip(FAILURES, found, strict=True)
        )
        label = "light (AsynchFCDFS)" if rule == "light" else f"{rule}, {conflict}"
        left.plot(FAILURES, [100 * s.settled for s in found], "o-", label=label)
        if rule == "light":
            right.plot(FAILURES, [s.slower for s in found], "o-C2", label="light (AsynchFCDFS)")
    right.plot(FAILURES, [1 / (1 - q) for q in FAILURES], "k:", label="1 / (1 - q)")
    bound = [0.5 / studies.most_entries(q) for q in FAILURES]
    right.plot(FAILURES, bound, "k--", label="V / alpha")
    left.set(xlabel="q", ylabel="cells settled, %", title="coverage")
    right.set(xlabel="q", ylabel="makespan / (2V - 1)", title="makespan")
    for axes in (left, right):
        axes.legend()
    save(figure, folder / "missed_steps.png")
    heads = ["q", "rule", "conflict", "covered", "cells settled", "collided"]
    heads += ["moves = distances", "makespan / (2V - 1)"]
    keep(folder / "missed_steps.csv", heads, rows)


def later_paper(folder: Path, runs: int) -> None:
    rows: list[list[object]] = []
    for name, lines in studies.TABLE_2.items():
        region = studies.table_region(name)
        for (rule, q), (cells, travel, energy, makespan) in lines.items():
            here = studies.averages(region, rule, 1 if rule == "fcdfs" else runs, q)
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
    corridors = [
        [
            f"{1 - q:g}",
            *(
                f"{makespan * studies.most_entries(q) / length:.3f}"
                for length in (100, 1000, 4000)
                for makespan in [studies.averages(corridor(length), "light", 3, q).makespan]
            ),
        ]
        for q in (0.1, 0.25, 0.5, 0.75)
    ]
    keep(folder / "later_paper.csv", heads, rows)
    keep(folder / "corridors.csv", ["p", "100", "1000", "4000"], corridors)


def corridor(length: int) -> Region:
    return rectangle(length, 1, [(0, 0)])


def several_doors(folder: Path, regions: list[Region]) -> None:
    rows = []
    for count in (1, 2, 3, 4):
        for conflict in ("stop", "stay"):
            s = studies.with_doors(regions, "fcdfs", count, conflict)
            rows.append(
                [count, conflict, f"{s.covered:.1%}", f"{s.collided:.1%}", f"{s.slower:.2f}"]
            )
    heads = ["doors", "conflict", "covered", "collided", "makespan / (2V / doors)"]
    keep(folder / "several_doors.csv", heads, rows)


def small_regions(folder: Path, cells: int) -> None:
    rows = []
    for size in range(1, cells + 1):
        tried, failed, spared = studies.exhaust(size, "fcdfs5")
        rows.append([size, tried, failed, spared])
    heads = ["cells", "region and door", "not optimal", "with a hole, no collision"]
    keep(folder / "small_regions.csv", heads, rows)


def cost(folder: Path, large: bool) -> None:
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


def save(figure: Figure, path: Path) -> None:
    figure.tight_layout()
    figure.savefig(path, dpi=80)
    plt.close(figure)


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    options.add_argument("--runs", type=int, default=100, help="seeds per rule with chance in it")
    options.add_argument("--regions", type=int, default=300, help="random regions")
    options.add_argument("--cells", type=int, default=9, help="size of the largest polyominoes")
    options.add_argument("--no-large", action="store_true", help="leave out 1000x1000")
    options.add_argument("--out", type=Path, default=ROOT / "docs" / "results")
    given = options.parse_args()
    folder = given.out / "fcdfs"
    folder.mkdir(parents=True, exist_ok=True)
    regions = studies.sample(given.regions)
    table_1(folder, given.runs)
    doors(folder)
    combs(folder)
    rings(folder)
    missed_steps(folder, regions)
    later_paper(folder, given.runs)
    several_doors(folder, regions)
    small_regions(folder, given.cells)
    cost(folder, not given.no_large)
    keep_about(folder, {"runs": given.runs, "regions": len(regions)})
    print(write("fcdfs", given.out))


if __name__ == "__main__":
    main()
