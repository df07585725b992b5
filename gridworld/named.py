"""Regions that a text stands for: `30x20`, `rooms 24`, `any`, `comb 6`, `ring 12 1`."""

from collections.abc import Callable, Mapping

import numpy as np

from gridworld.generators import KINDS, comb, random_region, ring
from gridworld.regions import Region, RegionError, rectangle

FORMS = (
    f"30x20 (columns and rows), KIND SIZE with KIND one of {', '.join(KINDS)}, any, comb, comb K, "
    "ring SIDE THICKNESS"
)
"""What `named` takes."""


def named(text: str, seed: int) -> Region | None:
    """The region that a text stands for, None if it is none of FORMS.

    A kind's region of about SIZE x SIZE cells is drawn with the seed, and its door with it; so is
    `any`, of all kinds in turn and 8 to 24 cells wide. Combs have a door, the others none. Raises
    RegionError for numbers that make no region.
    """
    word, *numbers = text.split() or [""]
    columns, by, rows = word.partition("x")
    if by and columns.isdecimal() and rows.isdecimal() and not numbers:
        return rectangle(int(columns), int(rows))
    makes: Mapping[str, tuple[tuple[int, ...], Callable[..., Region]]] = {
        "any": ((0,), lambda: any_region(seed)),
        "comb": ((0, 1), lambda k=None: comb(k)),
        "ring": ((2,), lambda side, thickness: ring(side, side, thickness)),
        **{kind: ((1,), drawn(kind, seed)) for kind in KINDS},
    }
    if word not in makes:
        return None
    lengths, make = makes[word]
    if len(numbers) not in lengths or not all(one.isdecimal() for one in numbers):
        raise RegionError(f"{text!r}: is no region; there are {FORMS}")
    try:
        return make(*map(int, numbers))
    except ValueError as error:
        raise RegionError(f"{text!r}: {error}") from None


def drawn(kind: str, seed: int) -> Callable[[int], Region]:
    """What draws a region of a kind, of a size."""
    return lambda size: random_region(kind, np.random.default_rng(seed), size)


def any_region(seed: int, smallest: int = 8, largest: int = 24) -> Region:
    """A random simply connected region, of all kinds in turn, with a door at random."""
    rng = np.random.default_rng(seed)
    kind = list(KINDS)[seed % len(KINDS)]
    return random_region(kind, rng, int(rng.integers(smallest, largest + 1)))
