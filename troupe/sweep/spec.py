"""What a sweep is asked for, and the combinations of worlds and settings that follow from it."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from sim.worldfile import nodes
from sim.worldfile.mistakes import Mistake
from sim.worldfile.nodes import Mark
from sim.worldfile.reader import Unreadable, read_text
from troupe.sweep.functions import is_function
from troupe.sweep.samplers import Sampler, draw, multiplied
from troupe.sweep.seeds import Unusable

MOST = 1_000_000
"""Combinations of one sweep."""


@dataclass(frozen=True)
class Row:
    """One row of a table: settings, and its own world and seeds if it has any, and its place."""

    settings: Mapping[str, Any]
    world: str | None = None
    seeds: tuple[int, ...] | None = None
    place: Mark | None = None


@dataclass(frozen=True)
class Spec:
    """A sweep before it is multiplied out. `rows` are a table's; None: there is no table.

    `places`: where parameters stand that were not given on the command line.
    """

    worlds: tuple[str, ...]
    seeds: tuple[int, ...] | None = None
    parameters: Mapping[str, Sampler] = field(default_factory=dict)
    rows: tuple[Row, ...] | None = None
    samples: int = 1
    sampling_seed: int = 1
    places: Mapping[str, Mark] = field(default_factory=dict)


@dataclass(frozen=True)
class Combination:
    """A world with settings. `seeds`: None for the world's own seed.

    `places`: where those settings stand that were not given on the command line.
    """

    world: str
    settings: Mapping[str, Any]
    seeds: tuple[int, ...] | None
    places: Mapping[str, Mark] = field(default_factory=dict)


def parse_setting(text: str) -> tuple[str, Sampler]:
    """`KEY=V1,V2` as a parameter and its values, each in YAML; raises Unusable.

    Commas within brackets, braces and quotes do not separate values.
    """
    key, equals, values = text.partition("=")
    key = ".".join(part.strip() for part in key.split("."))
    where = f"--set {text}"
    if not equals or not all(key.split(".")):
        allowed = "KEY=VALUE or KEY=VALUE,VALUE, such as clock.interval=0.05,0.1"
        raise Unusable(Mistake((), "is no setting", text, allowed, "--set"))
    try:
        node, mistakes = read_text(f"[{values}]", where)
    except Unreadable as error:
        raise Unusable(Mistake((), error.mistake.what, file=where)) from None
    if mistakes or not isinstance(node, nodes.ListNode):
        raise Unusable(*(Mistake(one.where, one.what, file=where) for one in mistakes))
    given: tuple[Any, ...] = nodes.plain(node)
    if not given:
        raise Unusable(Mistake((), "has no value", file=where))
    return key, Sampler("values", given)


def combinations(spec: Spec) -> list[Combination]:
    """All combinations, in the order of worlds, rows, multiplied values and samples.

    Raises Unusable where they are too many, or a parameter is none of a world's.
    """
    fixed = {key: multiplied(one) for key, one in spec.parameters.items() if not one.drawn}
    drawn = {key: one for key, one in spec.parameters.items() if one.drawn}
    samples = spec.samples if drawn else 1
    rows = spec.rows if spec.rows is not None else (Row({}),)
    number = len(spec.worlds or (None,)) * len(rows) * samples
    for one in fixed.values():
        number *= len(one)
    if number > MOST:
        raise Unusable(Mistake((), f"{number} combinations are too many", None, f"{MOST}"))
    columns = dict.fromkeys(key for row in rows for key in row.settings)
    worlds = [world for world in (*spec.worlds, *(row.world for row in rows)) if world]
    no_parameters = {"seed": "--seeds, or a column `seed`"}
    if not worlds or not all(map(is_function, worlds)):
        no_parameters["duration"] = "--duration"

    def note(key: str, what: str, *, table: bool = False) -> None:
        mark = None if table else spec.places.get(key)
        place: tuple[Any, ...] = ("--table" if table else "--set", None, None)
        mistakes.append(Mistake((key,), what, None, None, *(place if mark is None else mark)))

    mistakes: list[Mistake] = []
    for key, instead in no_parameters.items():
        if key in spec.parameters:
            note(key, f"is no parameter of a sweep; use {instead}")
        if key in columns:
            note(key, f"is no parameter of a sweep; use {instead}", table=True)
    for key in columns:
        if key in spec.parameters:
            note(key, "is a column of the table too")
    if any(row.world is None for row in rows) and not spec.worlds:
        mistakes.append(Mistake((), "there is no world to run", None, "WORLD, or a column `world`"))
    if mistakes:
        raise Unusable(*mistakes)
    found = []
    for row in rows:
        places = spec.places
        if row.place is not None:
            places = {**places, **dict.fromkeys(row.settings, row.place)}
        for world in (row.world,) if row.world is not None else spec.worlds:
            for values in itertools.product(*fixed.values()):
                for sample in range(samples):
                    settings = dict(row.settings) | dict(zip(fixed, values, strict=True))
                    for key, sampler in drawn.items():
                        settings[key] = draw(sampler, key, spec.sampling_seed, sample)
                    seeds = row.seeds if row.seeds is not None else spec.seeds
                    found.append(Combination(world, settings, seeds, places))
    return found
