"""The robots of a world one by one: entries with `count` expanded, and their names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from math import radians

from sim.worldfile.mistakes import Mistake
from sim.worldfile.schema import Door, PlacementRule, Robots


@dataclass(frozen=True, slots=True)
class RobotSpec:
    """One robot that is there from the start: where, or by which rule it is placed."""

    name: str
    model: str
    controller: str | None
    entry: int  # index of its entry under `robots`, for messages and for `same_y`
    pose: tuple[float, float, float] | None  # m, m, radians; None: placed at random
    placement: PlacementRule | None
    headings: tuple[float, ...] | None  # radians; a set to draw from


def expanded(entries: Iterable[tuple[int, Robots]]) -> list[RobotSpec]:
    """Every robot of the entries (index in the file, entry), in their order.

    Robots without a name of their own are numbered model by model, from 1, through all
    entries; an entry with a name and a count numbers its own.
    """
    numbers: Counter[str] = Counter()
    specs: list[RobotSpec] = []
    for index, entry in entries:
        pose = None
        if entry.pose is not None:
            x, y, heading = entry.pose
            pose = (float(x), float(y), radians(heading))
        headings = None
        if entry.headings is not None:
            headings = tuple(radians(heading) for heading in entry.headings)
        alone = entry.name is not None and "count" not in entry.model_fields_set
        stem = entry.model if entry.name is None else entry.name
        first = numbers[stem] + 1 if entry.name is None else 1
        for number in range(first, first + entry.count):
            name = stem if alone else f"{stem}{number}"
            specs.append(
                RobotSpec(
                    name, entry.model, entry.controller, index, pose, entry.placement, headings
                )
            )
        if entry.name is None:
            numbers[stem] += entry.count
    return specs


MOST_ROBOTS = 100_000
"""In all entries together."""


def number_mistakes(entries: Iterable[tuple[int, Robots]]) -> list[Mistake]:
    """The entry with which there would be more robots than a world may have."""
    total = 0
    for index, entry in entries:
        total += entry.count
        if total > MOST_ROBOTS:
            what = f"with these there would be more than {MOST_ROBOTS} robots"
            return [Mistake(("robots", index), what, f"count: {entry.count}")]
    return []


def name_mistakes(specs: Iterable[RobotSpec], doors: Iterable[tuple[int, Door]]) -> list[Mistake]:
    """Names that two robots would have, also those that come through doors (`s1`, `s2`, ...)."""
    mistakes: list[Mistake] = []
    owner: dict[str, int] = {}
    told: set[tuple[int, int]] = set()
    for spec in specs:
        first = owner.setdefault(spec.name, spec.entry)
        if first != spec.entry and (first, spec.entry) not in told:
            told.add((first, spec.entry))
            mistakes.append(
                Mistake(
                    ("robots", spec.entry, "name"),
                    f"robots.{first} has a robot of this name too",
                    spec.name,
                    "another name",
                )
            )
    stems: dict[str, int] = {}
    for index, door in doors:
        where = ("doors", index, "name")
        if door.name in stems:
            mistakes.append(
                Mistake(where, f"doors.{stems[door.name]} has this name too", door.name)
            )
            continue
        stems[door.name] = index
        taken = [name for name in owner if numbered(name, door.name)]
        taken += [
            f"{other}1"
            for other in stems
            if other != door.name and numbered(f"{other}1", door.name)
        ]
        taken += [
            f"{door.name}1"
            for other in stems
            if other != door.name and numbered(f"{door.name}1", other)
        ]
        if taken:
            mistakes.append(
                Mistake(
                    where,
                    f"a robot from this door would be called as another, {taken[0]}",
                    door.name,
                    "a name that no other one begins with before a number",
                )
            )
    return mistakes


def numbered(name: str, stem: str) -> bool:
    """Whether `name` is the stem and a number without leading zeros."""
    number = name.removeprefix(stem)
    return name.startswith(stem) and number.isdecimal() and not number.startswith("0")
