"""What a report tells of a sweep: its measures, its combinations, pairs of runs of one seed."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from troupe.sweep.rows import Row, columns, in_order
from troupe.sweep.statistics import Middle, middle
from troupe.usage import UsageError

MOST_MEASURES = 4
MOST_LEVELS = 6
"""Values of a parameter between which runs are paired."""

HIGHER = ("coverage", "success", "score", "emitted", "reward")
"""Words in the name of a measure of which more is better, unless told otherwise."""

VERSION = "version"
"""A world that was changed between two sweeps into one folder is told apart by its hash."""


@dataclass(frozen=True)
class Measure:
    """A column that runs are compared by."""

    name: str
    higher: bool

    def worst(self, values: NDArray[np.float64]) -> int:
        return int(np.argmin(values) if self.higher else np.argmax(values))

    def best(self, values: NDArray[np.float64]) -> int:
        return int(np.argmax(values) if self.higher else np.argmin(values))


@dataclass(frozen=True)
class Group:
    """The runs of one combination."""

    label: str
    levels: Mapping[str, Any]
    rows: list[Row]

    @property
    def completed(self) -> list[Row]:
        return [row for row in self.rows if row["outcome"] == "completed"]

    @property
    def failed(self) -> int:
        return len(self.rows) - len(self.completed)

    def values(self, measure: Measure) -> tuple[NDArray[np.float64], list[Row]]:
        """The measure of the runs that are complete and have one, and these."""
        rows = [row for row in self.completed if is_number(row.get(measure.name))]
        return np.array([row[measure.name] for row in rows], dtype=np.float64), rows

    def median_of_all(self, measure: Measure) -> float:
        """The median where a run that is not complete counts as worse than any that is.

        Not finite where it lies among these, NaN without runs.
        """
        worse = np.full(self.failed, -np.inf if measure.higher else np.inf)
        values = np.concatenate([self.values(measure)[0], worse])
        return float(np.median(values)) if len(values) else np.nan


@dataclass(frozen=True)
class Pairing:
    """One level of a parameter against the first one: runs that differ in nothing else.

    before, after (n,): the measure where both runs are complete; `only_before`, `only_after`: in
    how many pairs only the one is, or the other.
    """

    factor: str
    base: Any
    other: Any
    before: NDArray[np.float64]
    after: NDArray[np.float64]
    difference: Middle
    only_before: int
    only_after: int

    @property
    def lower(self) -> int:
        return int(np.count_nonzero(self.after < self.before))

    @property
    def higher(self) -> int:
        return int(np.count_nonzero(self.after > self.before))


def is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def factors(rows: Sequence[Row]) -> dict[str, list[Any]]:
    """The parameters that take several values, the world among them, with these in order."""
    names = columns(rows)
    parameters = [name for name in names[: names.index("hash")] if name != "seed"]
    found = {}
    for name in parameters:
        levels: dict[str, Any] = {json.dumps(row.get(name)): row.get(name) for row in rows}
        if len(levels) > 1:
            found[name] = sorted(levels.values(), key=in_order)
    told = {(tuple(json.dumps(row.get(name)) for name in parameters), row["hash"]) for row in rows}
    if len(told) > len({levels for levels, _ in told}):
        found[VERSION] = sorted({row["hash"] for row in rows})
    return found


def level(row: Row, factor: str) -> Any:
    return row["hash"] if factor == VERSION else row.get(factor)


def shown(value: Any) -> str:
    """A level as a reader likes it."""
    if isinstance(value, float):
        return f"{value:g}"
    return value if isinstance(value, str) else json.dumps(value)


def short(factor: str, all_factors: Sequence[str]) -> str:
    """The end of a parameter's name, as long as it takes to tell it from the others."""
    parts = factor.split(".")
    for length in range(1, len(parts) + 1):
        end = parts[-length:]
        if sum(other.split(".")[-length:] == end for other in all_factors) == 1:
            return ".".join(end)
    return factor


def grouped(rows: Sequence[Row], found: Mapping[str, list[Any]]) -> list[Group]:
    """The rows by combination, in the order of the rows."""
    groups: dict[str, Group] = {}
    names = list(found)
    for row in rows:
        levels = {name: level(row, name) for name in names}
        key = json.dumps(list(levels.values()))
        if key not in groups:
            texts = [f"{short(name, names)} {shown(value)}" for name, value in levels.items()]
            groups[key] = Group(", ".join(texts) or str(row["world"]), levels, [])
        groups[key].rows.append(row)
    return list(groups.values())


def measures_of(
    rows: Sequence[Row], asked: Sequence[str], higher: Sequence[str], added: Sequence[str]
) -> list[Measure]:
    """What is compared: what was asked for, or else the columns that tell the runs apart.

    Added columns come first, then times, paint, what was reported and ways. Raises UsageError for
    a column that is not there or has no numbers.
    """
    done = [row for row in rows if row["outcome"] == "completed"]
    names = columns(rows)
    options = [("--measure", name) for name in asked] + [("--higher", name) for name in higher]
    for option, name in options:
        if name not in names or not any(is_number(row.get(name)) for row in rows):
            known = ", ".join(n for n in names if any(is_number(row.get(n)) for row in rows))
            raise UsageError(f"{option} {name}: is no column of numbers (there are {known})")
    chosen = list(asked)
    if not chosen:
        reported = [name for name in names if name.startswith("properties.")]
        ends = [name for name in reported if name.endswith(".max")]
        likely = [*added, "sim_time", "floor.coverage", *ends, "distance"]
        for name in likely:
            values = {row.get(name) for row in done if is_number(row.get(name))}
            if len(values) > 1 and name not in chosen:
                chosen.append(name)
        numbers = [name for name in likely if any(is_number(row.get(name)) for row in done)]
        chosen = chosen[:MOST_MEASURES] or numbers[:1] or ["sim_time"]
    return [
        Measure(name, name in higher or any(word in name.lower() for word in HIGHER))
        for name in chosen
    ]


def pairings(
    groups: Sequence[Group], measure: Measure, found: Mapping[str, list[Any]]
) -> list[Pairing]:
    """For every parameter, its first level against each of the others, by equal seeds."""
    done = []
    names = list(found)
    for factor, levels in found.items():
        if len(levels) > MOST_LEVELS:
            continue
        others = [name for name in names if name != factor]
        values: dict[str, dict[str, float]] = {}
        ran: dict[str, set[str]] = {}
        for group in groups:
            numbers, rows = group.values(measure)
            level = json.dumps(group.levels[factor])
            mine, every = values.setdefault(level, {}), ran.setdefault(level, set())
            rest = json.dumps([group.levels[name] for name in others])
            every |= {f"{rest} {row['seed']}" for row in group.rows}
            for number, row in zip(numbers, rows, strict=True):
                mine[f"{rest} {row['seed']}"] = float(number)
        first = json.dumps(levels[0])
        base, base_ran = values.get(first, {}), ran.get(first, set())
        for other in levels[1:]:
            there = values.get(json.dumps(other), {})
            both = [key for key in base if key in there]
            if not both:
                continue
            before = np.array([base[key] for key in both])
            after = np.array([there[key] for key in both])
            name = f"{measure.name} {factor} {json.dumps([levels[0], other])}"
            difference = middle(after - before, name)
            alone = [
                len((one.keys() - two.keys()) & ran_too)
                for one, two, ran_too in (
                    (base, there, ran.get(json.dumps(other), set())),
                    (there, base, base_ran),
                )
            ]
            done.append(Pairing(factor, levels[0], other, before, after, difference, *alone))
    return done
