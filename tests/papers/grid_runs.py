"""What the tests of the papers' claims ask of runs on the grid, and the regions they are on."""

from functools import cache

import numpy as np

from gridworld.generators import KINDS, random_region

OPTIMAL = ["fcdfs", "fcdfs5", "symmetric", "left_hand"]
"""The rules of which the paper says that makespan and travel are the least possible."""


def is_optimal(outcome):
    """Makespan 2V - 1, every robot on a shortest path without a stop, everything covered."""
    return (
        outcome.all_settled
        and outcome.collisions == 0
        and outcome.makespan == 2 * outcome.cells - 1
        and outcome.travel.sum() == outcome.sum_of_distances
        and outcome.travel.max() == outcome.max_distance
        and (outcome.travel == outcome.moves).all()
    )


def moves_alike(one, other):
    return (one.settled == other.settled).all() and (one.cell == other.cell).all()


@cache
def random_regions(count, smallest=3, largest=20):
    """`count` regions of every kind, of all sizes, with a door at random."""
    return [
        random_region(
            kind, np.random.default_rng([seed, k]), smallest + seed % (largest - smallest + 1)
        )
        for k, kind in enumerate(KINDS)
        for seed in range(count)
    ]


def doors_of(free):
    return [(int(column), int(row)) for row, column in np.argwhere(free)]
