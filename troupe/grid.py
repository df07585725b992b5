"""Dispersal on the grid as a function of parameters and a seed, which a sweep can run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field

from controllers.dispersal.rules import RULES
from gridworld.grid import simulate
from gridworld.median import best_door
from gridworld.named import named
from gridworld.regions import Cell, Region, RegionError, load
from troupe.maps import find_map
from troupe.usage import UsageError


def known(text: str) -> str:
    """A region's text as it is; raises ValueError where there is none."""
    region_of(text, 0)
    return text


if TYPE_CHECKING:
    Rule = str
else:
    Rule = Literal[tuple(RULES)]
RegionText = Annotated[str, AfterValidator(known)]


def disperse(
    seed: int,
    region: RegionText,
    *,
    door: str | None = None,
    doors: Annotated[int, Field(ge=1)] | None = None,
    rule: Rule = "fcdfs",
    q: Annotated[float, Field(ge=0, lt=1)] = 0.0,
    conflict: Literal["stop", "stay"] = "stop",
    force: bool = False,
    max_steps: Annotated[int, Field(ge=1)] | None = None,
) -> dict[str, Any]:
    """One run on the grid, in figures: those of `troupe disperse --json`, the size last.

    Args:
        seed: for all chance, that of the region and its doors too.
        region: a map (a file, or the name of one that comes with Troupe), or what stands for a
            region: `30x20`, `rooms 24`, `any`, see `gridworld.named`.
        door: cells of doors, `COL,ROW COL,ROW`, counted from the top left from 0, or `best`.
        doors: as many doors at random instead.
        rule: the rule by which robots move.
        q: probability that a robot misses a step.
        conflict: what happens where two robots would meet in a cell.
        force: the region may have holes.
        max_steps: the run ends after so many steps at the latest.

    Raises:
        RegionError: a region that cannot be used; UsageError, ValueError: another argument.
    """
    place = region_of(region, seed)
    if doors is not None:
        place = at_random(place, doors, seed)
    place = with_doors(place, [] if door is None else door.split(), holes=force)
    outcome = simulate(place, rule, seed=seed, q=q, conflict=conflict, max_steps=max_steps)
    figures = outcome.figures()
    cells = figures.pop("cells")
    return {**figures, "cells": cells}


def region_of(text: str, seed: int) -> Region:
    """The region of a text or a map; raises RegionError, UsageError where there is none."""
    found = named(text, seed)
    return load(find_map(Path(text))) if found is None else found


def at_random(region: Region, number: int, seed: int) -> Region:
    """The region with so many doors in cells drawn with the seed; raises RegionError."""
    free = np.argwhere(region.free)
    if not 1 <= number <= len(free):
        raise RegionError(f"{number} doors in {len(free)} cells: give 1 or more, and no more")
    chosen = free[np.random.default_rng([seed, number]).choice(len(free), number, replace=False)]
    return region.with_doors([(int(column), int(row)) for row, column in chosen])


def with_doors(region: Region, doors: Sequence[str], *, holes: bool = False) -> Region:
    """The region with the doors `COL,ROW`, or `best`; its own if there are none.

    Raises UsageError, and RegionError unless it has doors and is connected, without holes too
    unless told otherwise.
    """
    if list(doors) == ["best"]:
        region.check(holes=holes)
        return region.with_doors([best_door(region)])
    if doors:
        region = region.with_doors([two_numbers("--door", door, ",") for door in doors])
    if not region.doors:
        source = f"{region.source}: " if region.source else ""
        raise RegionError(f"{source}no door: mark one with S in the map, or give --door COL,ROW")
    region.check(holes=holes)
    return region


def two_numbers(option: str, text: str, separator: str) -> Cell:
    """`4,2` or `4x2` as two numbers; raises UsageError."""
    first, found, second = text.strip().partition(separator)
    if not (found and first.strip().isdecimal() and second.strip().isdecimal()):
        shape = "COL,ROW" if separator == "," else "WxH"
        raise UsageError(f"{option}: {text!r} is not {shape}, two whole numbers")
    return int(first), int(second)
