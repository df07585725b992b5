"""Reproduce the results of the FCDFS paper on the grid: write docs/results/fcdfs.md.

    scripts/fcdfs_tables [--runs N] [--regions N] [--cells N] [--no-large] [--out FOLDER]

With its defaults it takes some minutes on one core. Needs matplotlib (extra "plots").
"""

import argparse
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402

from gridworld import studies  # noqa: E402
from gridworld.generators import comb, ring  # noqa: E402
from gridworld.grid import GridRun, simulate  # noqa: E402
from gridworld.median import best_door, sums_of_distances  # noqa: E402
from gridworld.regions import Region, rectangle  # noqa: E402
from troupe.grid_film import picture_of, write_picture  # noqa: E402

FAILURES = (0.0, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5)


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join("| " + " | ".join(map(str, line)) + " |\n" for line in lines)


def pair(total: float, most: float) -> str:
    return f"{total:.0f} ({most:.0f})"


def picture(folder: Path, name: str, region: Region, rule: str, steps: int, **more: object) -> str:
    """Draw the end of a step; returns the Markdown that shows it."""
    run = GridRun(region, rule, **more)  # type: ignore[arg-type]
    run.advance(steps)
    pixels = max(4, 420 // max(region.columns + 2, region.rows + 2))
    write_picture(folder / f"{name}.png", picture_of(run, rule, pixels), run)
    return f"![{name}, {rule}, step {run.steps}](fcdfs/{name}.png)\n"


def table_1(folder: Path, runs: int) -> str:
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
    text = f"""## Table 1

Total travel (maximal travel) without pauses, as the paper counts here; DFLF, BFLF and symmetric
averaged over {runs} seeds.

{table(["region", *rules], without)}
With pauses, which T_i of the paper's section 2 counts, and with the makespan and the standard
deviation of one run's total without pauses:

{table(["region", "rule", "total (maximal) travel", "makespan", "deviation"], pauses)}
The 30x30 row of FCDFS is the paper's exactly with the door at 13,13, 13,16, 16,13 or 16,16, and
with no other door of the square. The regions `flat`, `labyrinth` and `apartment` are ours: the
paper only draws its own. Each was picked from some thousand random divisions into rooms because
its sum of distances and its largest distance, which are FCDFS's travel, come near to the paper's;
so that column says nothing, and the comparison lies in the others. BFLF is left open in the paper;
as it is read here its totals come within a twentieth of the paper's, and its waiting never delays
the entry: the makespan is 2V - 1, as a later paper has it. Its maximum is a fifth less on the
square and in `flat`. DFLF depends on how much open space there is; `apartment` seems to have less
of it than the region of figure 9.

"""
    for name, rule, step in (
        ("flat", "fcdfs", 420),
        ("labyrinth", "fcdfs", 900),
        ("apartment", "left_hand", 350),
    ):
        text += picture(folder, name, studies.table_region(name), rule, step)
    region = rectangle(30, 30, [(13, 13)])
    return text + picture(folder, "symmetric", region, "symmetric", 900, seed=1) + "\n"


def doors(folder: Path) -> str:
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
    return f"""## The best door

Total travel is the sum of distances, so the best door is the geometric median (end of section
3.1). `troupe disperse --door best` finds it in a time that grows as the number of cells.

{table(heads, rows)}
![total travel by door](fcdfs/doors.png)

"""


def combs() -> str:
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
    return f"""## G(k), section 3.3

The comb whose columns 1 and k meet the top row, for robots that see two cells far (r = 2): 20
columns. No local rule reaches the sum of distances for all k. FCDFS needs a simply connected
region and collides; DFLF and BFLF (seed 1) cover it and travel farther, up to several times.
Without a column k the comb is simply connected, and all three are optimal.

{table(["k", "V", "sum of distances", "FCDFS", "DFLF", "BFLF without pauses"], rows)}
"""


def rings(folder: Path) -> str:
    rows = []
    for columns, thickness, door in ((8, 1, (0, 4)), (12, 1, (5, 0)), (12, 2, (0, 5))):
        region = ring(columns, columns, thickness).with_doors([door])
        for conflict in ("stop", "stay"):
            out = simulate(region, conflict=conflict)
            name, end = f"{columns}x{columns}, {thickness} wide", out.outcome.replace("_", " ")
            came, settled = f"{len(out.entered)} of {out.cells}", int((out.settled > 0).sum())
            rows.append([name, conflict, end, came, settled, out.steps])
    region = ring(12, 12, 1).with_doors([(5, 0)])
    shown = picture(folder, "ring", region, "fcdfs", 200, conflict="stay")
    heads = ["ring", "conflict", "end", "entered", "settled", "steps"]
    return f"""## Figure 7: a ring

In the model as it is written, the first robot has come around when a new one enters: loops have
even length, so they enter the door's cell in one step and collide. The paper's picture, the door
sealed and the robots circling for ever, appears where the loser of a conflict stays
(`--conflict stay`; the robot that entered first wins, one that would enter waits outside).

{table(heads, rows)}
{shown}
"""


def missed_steps(folder: Path, regions: list[Region]) -> str:
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
    return f"""## Missed steps, section 5

Every activation fails with probability q, on {len(regions)} random simply connected regions of all
kinds. A delayed robot is taken for a wall by plain FCDFS. With one visible bit, a light that is on
when a robot has settled, and waiting while the wanted cell holds an active robot (`light`, which a
later paper of the authors calls asynchronous FCDFS, AsynchFCDFS), every region is covered, nobody
collides, and every robot moves as often as its distance from the door. Makespans are means over the
runs that covered their region.

{table(heads, rows)}
![missed steps](fcdfs/missed_steps.png)

"""


def later_paper(runs: int) -> str:
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
    return f"""## Time, travel, and energy

A later paper of the authors, "Time, Travel, and Energy in the Uniform Dispersion Problem" (2024),
adds energy, the steps in which a robot is active with the one in which it settles, and asynchronous
FCDFS, our `light`, where every robot wakes with probability p = 1 - q in a step. It counts a
makespan up to the last robot's settling, one step more than above. Its environments are again not
ours: `labyrinth` and `flat` have their distances, but more cells. So what compares is energy over
moves and makespan over cells; means over {runs} seeds here, over 10 there.

{table(heads, rows)}
BFLF waits less here than there, with the same makespan and nearly the same travel: how long a
robot stays active before it settles is left open. That paper's largest energies of one robot are,
for AsynchFCDFS, less than the means that its totals give, and are left out.

The makespan of AsynchFCDFS is bounded by (1 / alpha + o(1)) V, alpha = (1 - sqrt(1 - p)) / 2, the
most robots that can come in per step. No run here exceeds V / alpha; in a corridor with the door at
its end it comes near to it, by its length in cells:

{table(["p", "100", "1000", "4000"], corridors)}
"""


def corridor(length: int) -> Region:
    return rectangle(length, 1, [(0, 0)])


def several_doors(regions: list[Region]) -> str:
    rows = []
    for count in (1, 2, 3, 4):
        for conflict in ("stop", "stay"):
            s = studies.with_doors(regions, "fcdfs", count, conflict)
            rows.append(
                [count, conflict, f"{s.covered:.1%}", f"{s.collided:.1%}", f"{s.slower:.2f}"]
            )
    heads = ["doors", "conflict", "covered", "collided", "makespan / (2V / doors)"]
    return f"""## Several doors, section 5

Plain FCDFS through random doors of the same regions. The paper leaves this open; what FCDFS was
made for is one door.

{table(heads, rows)}
"""


def small_regions(cells: int) -> str:
    rows = []
    for size in range(1, cells + 1):
        tried, failed, spared = studies.exhaust(size, "fcdfs5")
        rows.append([size, tried, failed, spared])
    heads = ["cells", "region and door", "not optimal", "with a hole, no collision"]
    return f"""## All small regions

Algorithm 2 from every door of every polyomino: optimal in each without a hole, a collision in each
with one.

{table(heads, rows)}
"""


def cost(large: bool) -> str:
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
    return f"""## Cost

FCDFS on squares with the door in the middle, one core, compiled code loaded, in processor time of
the machine on which this page was written.

{table(["region", "robot steps", "seconds", "ns per robot step"], rows)}
"""


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
    text = (
        """# FCDFS on the grid

Written by `scripts/fcdfs_tables`. The paper: Amir and Bruckstein, "Minimizing Travel in the
Uniform Dispersal Problem for Robotic Sensors", AAMAS 2019. Robot k enters at the end of step
2k - 1; the makespan is the first step at whose end all V cells are occupied; entering and settling
are no travel. In the pictures active robots are arrows in their primary direction (dots before
their first move), settled ones diamonds, and the door has a frame. How DFLF and BFLF are read is
written with the rules, in `controllers/dispersal/rules`.

"""
        + table_1(folder, given.runs)
        + doors(folder)
        + combs()
        + rings(folder)
        + missed_steps(folder, regions)
        + later_paper(given.runs)
        + several_doors(regions)
        + small_regions(given.cells)
        + cost(not given.no_large)
    )
    (given.out / "fcdfs.md").write_text(text.rstrip() + "\n", encoding="utf-8")
    print(given.out / "fcdfs.md")


if __name__ == "__main__":
    main()
