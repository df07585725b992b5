"""What `Simulation.readings` gives: one sensor's readings of all robots that have it."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sensors.readings import Readings as Batch
from sensors.suite import Group, Suite


@dataclass(frozen=True)
class Readings:
    """One sensor's readings of k robots; row j belongs to robot `robots[j]`.

    What a kind of sensor reads stands in attributes of these names, as in `sensors.readings`:
    `ranges` and `bearings` of a laser, `blobs` and `counts` of a blobfinder, `fiducials` and
    `counts`, `bits` of a bumper, `values` of a sensor of one's own. Arrays are copies.
    """

    robots: NDArray[np.int64]
    """(k,) indices of the robots that have the sensor."""
    time: float
    """Simulated seconds."""
    data: Batch
    """The readings, n = k."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "data":
            raise AttributeError(name)
        return getattr(self.data, name)

    def __dir__(self) -> list[str]:
        return sorted({*object.__dir__(self), *dir(self.data)})

    def __len__(self) -> int:
        return len(self.robots)


@dataclass(frozen=True)
class Place:
    """Where a sensor's readings stand in the suite: robots (k,), their slots, groups and rows."""

    robots: NDArray[np.int64]
    slots: NDArray[np.int64]
    groups: tuple[Group, ...]
    rows: tuple[NDArray[np.int64], ...]  # per group
    order: NDArray[np.int64]  # of the rows of all groups, one behind the other, by robot


def find_sensor(suite: Suite, name: str) -> Place:
    """The robots that have sensor `name`: `laser`, `laser:1`, or a sensor file's own name.

    Raises ValueError where no robot has it, with what there is.
    """
    kind, _, number = name.partition(":")
    if number and not number.isdecimal():
        raise ValueError(f"{name!r} is no sensor: write it as laser, or laser:1")
    index = int(number or 0)
    found: list[tuple[int, int, Group, int]] = []
    known: dict[str, int] = {}
    for robot in range(len(suite.first_slot)):
        seen: dict[str, int] = {}
        last = suite.first_slot[robot + 1] if robot + 1 < len(suite.first_slot) else suite.slots
        for number_of_sensor in range(last - suite.first_slot[robot]):
            group, row = suite.place(robot, number_of_sensor)
            own = group.type.name
            if own == kind and seen.get(own, 0) == index:
                found.append((robot, suite.first_slot[robot] + number_of_sensor, group, row))
            seen[own] = seen.get(own, 0) + 1
            known[own] = max(known.get(own, 0), seen[own])
    if not found:
        there = ", ".join(f"{one}:{k}" for one, count in known.items() for k in range(count))
        raise ValueError(f"no robot has a sensor {name!r}; there are: {there or 'none'}")
    groups = tuple({id(group): group for _, _, group, _ in found}.values())
    members = [[j for j, one in enumerate(found) if one[2] is group] for group in groups]
    return Place(
        np.array([one[0] for one in found], np.int64),
        np.array([one[1] for one in found], np.int64),
        groups,
        tuple(np.array([found[j][3] for j in js], np.int64) for js in members),
        np.argsort(np.array([j for js in members for j in js], np.int64)),
    )


def readings_of(place: Place, name: str, time: float) -> Readings:
    """Copies of the readings that stand at `place`.

    Raises ValueError where robots' sensors differ so much that their readings are no one array.
    """
    batches = [
        taken(group.readings, rows) for group, rows in zip(place.groups, place.rows, strict=True)
    ]
    if len(batches) == 1:
        return Readings(place.robots, time, batches[0])
    try:
        joined = join(batches, place.order)
    except ValueError:
        raise ValueError(
            f"the robots' sensors {name!r} differ in their number of samples or elements, so "
            "their readings are no one array: give robots= of one model"
        ) from None
    return Readings(place.robots, time, joined)


def taken(batch: Any, rows: NDArray[np.int64]) -> Any:
    """A batch of some rows, copied."""
    n = len(next(value for value in vars(batch).values() if isinstance(value, np.ndarray)))
    changed = {
        one.name: value[rows]
        for one in fields(batch)
        if isinstance(value := getattr(batch, one.name), np.ndarray)
        and len(value) == n
        and one.name not in SHARED
    }
    return replace(batch, **changed)


SHARED = frozenset({"poses", "arcs"})
"""Arrays of a batch that belong to the sensor, not to a robot."""


def join(batches: list[Any], order: NDArray[np.int64]) -> Any:
    """Batches of one kind as one, its rows in the given order; ValueError if they differ."""
    first = batches[0]
    changed = {}
    for one in fields(first):
        parts = [getattr(batch, one.name) for batch in batches]
        if isinstance(parts[0], np.ndarray) and one.name not in SHARED:
            changed[one.name] = np.concatenate(parts)[order]
        elif (
            not all(np.array_equal(part, parts[0]) for part in parts[1:])
            and one.name != "max_range"
        ):
            raise ValueError(one.name)
    return replace(first, **changed)
