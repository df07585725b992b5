"""The studies behind docs/results/fcdfs.md: rows of figures, from many runs on the grid."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gridworld.generators import KINDS, polyominoes, random_region
from gridworld.grid import Outcome, simulate
from gridworld.regions import Region, load, rectangle
from gridworld.topology import first_hole

MAPS = Path(__file__).parent / "maps"
"""Regions that come with the package."""

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


def averages(region: Region, rule: str, runs: int, q: float = 0.0) -> Row:
    """Means over runs with seeds 0, 1, ... Raises RuntimeError if a run does not complete."""
    outcomes = [simulate(region, rule, seed=seed, q=q) for seed in range(runs)]
    if not all(outcome.all_settled for outcome in outcomes):
        raise RuntimeError(f"{rule} did not complete")
    moves = [outcome.moves.sum() for outcome in outcomes]
    return Row(
        moves=float(np.mean(moves)),
        most_moves=float(np.mean([outcome.moves.max() for outcome in outcomes])),
        travel=float(np.mean([outcome.travel.sum() for outcome in outcomes])),
        most_travel=float(np.mean([outcome.travel.max() for outcome in outcomes])),
        energy=float(np.mean([outcome.energy.sum() for outcome in outcomes])),
        makespan=float(np.mean([outcome.makespan or 0 for outcome in outcomes])),
        steps=float(np.mean([outcome.steps for outcome in outcomes])),
        spread=float(np.std(moves)),
    )


def sample(count: int, smallest: int = 8, largest: int = 24) -> list[Region]:
    """`count` random simply connected regions, of all kinds in turn, with a door at random."""
    regions = []
    for number in range(count):
        rng = np.random.default_rng(number)
        kind = list(KINDS)[number % len(KINDS)]
        regions.append(random_region(kind, rng, int(rng.integers(smallest, largest + 1))))
    return regions


def with_missed_steps(regions: Sequence[Region], rule: str, q: float, conflict: str) -> Share:
    """`rule` in each region, activations failing with probability `q`; the bound is 2V - 1."""
    outcomes = [
        simulate(region, rule, seed=seed, q=q, conflict=conflict)
        for seed, region in enumerate(regions)
    ]
    return _share(outcomes, [2 * outcome.cells - 1 for outcome in outcomes])


def with_doors(regions: Sequence[Region], rule: str, doors: int, conflict: str) -> Share:
    """`rule` in each region through `doors` random doors; the bound is 2V / doors."""
    outcomes = []
    for seed, region in enumerate(regions):
        free = np.argwhere(region.free)
        rng = np.random.default_rng([seed, doors])
        chosen = free[rng.choice(len(free), doors, replace=False)]
        cells = [(int(column), int(row)) for row, column in chosen]
        outcomes.append(simulate(region.with_doors(cells), rule, seed=seed, conflict=conflict))
    return _share(outcomes, [2 * outcome.cells / doors for outcome in outcomes])


def most_entries(q: float) -> float:
    """alpha of the later paper: robots that can come in per step, on average and for long.

    Where each of them wakes with probability p = 1 - q, it is (1 - sqrt(1 - p)) / 2.
    """
    return (1.0 - math.sqrt(q)) / 2.0


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


def _share(outcomes: Sequence[Outcome], bounds: Sequence[float]) -> Share:
    slower = [
        outcome.makespan / bound
        for outcome, bound in zip(outcomes, bounds, strict=True)
        if outcome.makespan is not None
    ]
    return Share(
        covered=len(slower) / len(outcomes),
        collided=float(np.mean([outcome.collisions > 0 for outcome in outcomes])),
        settled=float(np.mean([(out.settled > 0).sum() / out.cells for out in outcomes])),
        slower=float(np.mean(slower)) if slower else float("nan"),
        on_shortest_paths=float(
            np.mean([int(out.moves.sum()) == out.sum_of_distances for out in outcomes])
        ),
    )
