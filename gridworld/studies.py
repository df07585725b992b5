"""The studies behind docs/results/fcdfs.md: what is run on the grid, and means over many runs."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gridworld.generators import polyominoes
from gridworld.grid import Outcome, simulate
from gridworld.median import best_door, sums_of_distances
from gridworld.named import any_region
from gridworld.regions import Region, load, rectangle
from gridworld.topology import first_hole

MAPS = Path(__file__).parent / "maps"
"""Regions that come with the package."""

Figures = Mapping[str, Any]
"""A run in figures, as `Outcome.figures` gives it."""

TABLE_1 = {
    "30x30": ((237984, 460), (16323, 50), (13620, 32)),
    "flat": ((16139, 126), (6742, 50), (5909, 38)),
    "labyrinth": ((100419, 296), (39576, 112), (35103, 99)),
    "apartment": ((50889, 190), (7283, 39), (6600, 35)),
}
"""Table 1 of the paper, total (maximal) travel without pauses for DFLF, BFLF and FCDFS. Its
second to fourth row are of the environments of figures 5, 6 and 9, in whose place ours stand."""

TABLE_2 = {
    "labyrinth": {
        ("fcdfs", 0.0): (669, 35103, 35772, 1338),
        ("light", 0.25): (669, 35103, 69092, 2565),
        ("light", 0.5): (669, 35103, 118658, 4350),
        ("bflf", 0.0): (669, 39649, 122787, 1338),
        ("dflf", 0.0): (669, 91959, 92628, 1338),
    },
    "flat": {
        ("fcdfs", 0.0): (277, 5909, 6186, 554),
        ("light", 0.25): (277, 5909, 11783, 1027),
        ("light", 0.5): (277, 5909, 20001, 1725),
        ("bflf", 0.0): (277, 7313, 28358, 554),
        ("dflf", 0.0): (277, 17214, 17491, 554),
    },
}
"""Table II of the later paper, "Time, Travel, and Energy in the Uniform Dispersion Problem" (2024):
per environment, rule and q, its cells, total travel, total energy and makespan. In place of its
figures 4 and 5 stand regions of ours of the same distances, but of more cells."""


@dataclass(frozen=True)
class Row:
    """Means over runs of one rule in one region; `spread` is the standard deviation of `moves`.

    `steps` is the step in which the last robot settles, the makespan of the later paper.
    """

    moves: float
    most_moves: float
    travel: float
    most_travel: float
    energy: float
    makespan: float
    steps: float
    spread: float


@dataclass(frozen=True)
class Share:
    """Of many runs: which shares were covered and collided, how much was settled, and the mean
    makespan of the covered ones, as a multiple of a bound (nan if there were none)."""

    covered: float
    collided: float
    settled: float
    slower: float
    on_shortest_paths: float


def table_region(name: str) -> Region:
    """The region of a row of TABLE_1, with its door."""
    if name == "30x30":
        return rectangle(30, 30, [(13, 13)])  # a door that makes FCDFS's row the paper's
    return load(MAPS / f"{name}.txt")


def averages(runs: Sequence[Figures]) -> Row:
    """Means over runs, in the figures of each. Raises RuntimeError if one did not complete."""
    if not all(run["outcome"] == "completed" for run in runs):
        raise RuntimeError("a run did not complete")

    def mean(name: str) -> float:
        return float(np.mean([run[name] or 0 for run in runs]))

    return Row(
        moves=mean("total_moves"),
        most_moves=mean("max_moves"),
        travel=mean("total_travel"),
        most_travel=mean("max_travel"),
        energy=mean("total_energy"),
        makespan=mean("makespan"),
        steps=mean("steps"),
        spread=float(np.std([run["total_moves"] for run in runs])),
    )


def share(runs: Sequence[Figures], bounds: Sequence[float]) -> Share:
    """Which of the runs did what, and their makespans as multiples of a bound for each."""
    slower = [
        run["makespan"] / bound
        for run, bound in zip(runs, bounds, strict=True)
        if run["makespan"] is not None
    ]
    return Share(
        covered=len(slower) / len(runs),
        collided=float(np.mean([run["collisions"] > 0 for run in runs])),
        settled=float(np.mean([run["settled"] / run["cells"] for run in runs])),
        slower=float(np.mean(slower)) if slower else float("nan"),
        on_shortest_paths=float(
            np.mean([run["total_moves"] == run["sum_of_distances"] for run in runs])
        ),
    )


def sample(count: int) -> list[Region]:
    """`count` random simply connected regions, of all kinds in turn, with a door at random."""
    return [any_region(number) for number in range(count)]


def most_entries(q: float) -> float:
    """alpha of the later paper: robots that can come in per step, on average and for long.

    Where each of them wakes with probability p = 1 - q, it is (1 - sqrt(1 - p)) / 2.
    """
    return (1.0 - math.sqrt(q)) / 2.0


def doors(seed: int, region: str) -> dict[str, object]:
    """A region's best door and its own, with the total travel from each, and the most there is.

    Nothing is drawn: `seed` is there as a sweep has one.
    """
    place = table_region(region)
    sums = sums_of_distances(place.free)
    (column, row), best = place.doors[0], best_door(place)
    free = sums[place.free]
    return {
        "best_door": f"{best[0]},{best[1]}",
        "best_total": int(free.min()),
        "own_door": f"{column},{row}",
        "own_total": int(sums[row, column]),
        "worst_total": int(free.max()),
    }


def small_regions(seed: int, size: int, rule: str = "fcdfs5") -> dict[str, int]:
    """`exhaust` of all polyominoes of `size` cells, in figures; nothing is drawn."""
    tried, failed, spared = exhaust(size, rule)
    return {"tried": tried, "not_optimal": failed, "spared": spared}


def exhaust(cells: int, rule: str) -> tuple[int, int, int]:
    """`rule` from every door of every polyomino of `cells` cells.

    Returns the number of runs without a hole, of those that were not optimal, and of runs with a
    hole that ended otherwise than in a collision.
    """
    tried = failed = spared = 0
    for free in polyominoes(cells):
        holed = first_hole(free)[0] is not None
        for row, column in np.argwhere(free):
            outcome = simulate(Region(free, ((int(column), int(row)),)), rule)
            if holed:
                spared += outcome.outcome != "collision"
            else:
                tried += 1
                failed += not is_optimal(outcome)
    return tried, failed, spared


def is_optimal(outcome: Outcome) -> bool:
    """Whether all was covered in 2V - 1 steps, and every robot took a shortest path."""
    return (
        outcome.all_settled
        and outcome.makespan == 2 * outcome.cells - 1
        and int(outcome.travel.sum()) == outcome.sum_of_distances
        and int(outcome.travel.max()) == outcome.max_distance
    )
