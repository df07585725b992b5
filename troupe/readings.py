"""What `Simulation.readings` gives: one sensor's readings of all robots that have it."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cache
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from sensors.readings import Readings as Batch
from sensors.suite import Group, Suite

Rows = NDArray[np.int64] | None
"""Rows of a batch (k,), or None for all of them."""


class Readings:
    """One sensor's readings of k robots; row j belongs to robot `robots[j]`.

    What a kind of sensor reads stands in attributes of these names, as in `sensors.readings`:
    `ranges` and `bearings` of a laser, `blobs` and `counts` of a blobfinder, `fiducials` and
    `counts`, `bits` of a bumper, `values` of a sensor of one's own. Arrays are copies, each made
    when it is asked for; what has not been by the time the sensors read anew is copied then.
    """

    def __init__(self, robots: NDArray[np.int64], time: float, batch: Batch, rows: Rows) -> None:
        self.robots = robots
        """(k,) indices of the robots that have the sensor."""
        self.time = time
        """Simulated seconds."""
        self._batch, self._rows = batch, rows
        self._data: Batch | None = None
        self._copies: dict[str, NDArray[Any]] = {}

    @property
    def data(self) -> Batch:
        """The readings, n = k."""
        if self._data is None:
            names = arrays_by_robot(self._batch)
            self._data = replace(
                cast(Any, self._batch), **{name: self._copy(name) for name in names}
            )
            del self._batch, self._rows
        return self._data

    def keep(self) -> None:
        """Copy what may change: the sensors are about to read anew."""
        self.data  # noqa: B018 - it is made

    def _copy(self, name: str) -> NDArray[Any]:
        """The rows of an array of the batch, copied once."""
        if name not in self._copies:
            value = getattr(self._batch, name)
            self._copies[name] = value.copy() if self._rows is None else value[self._rows]
        return self._copies[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        if self._data is None and name in arrays_by_robot(self._batch):
            return self._copy(name)
        return getattr(self.data, name)

    def __dir__(self) -> list[str]:
        return sorted({*object.__dir__(self), *dir(self.data)})

    def __len__(self) -> int:
        return len(self.robots)

    def __repr__(self) -> str:
        return f"Readings(robots={self.robots!r}, time={self.time!r}, data={self.data!r})"

    def __getstate__(self) -> dict[str, Any]:
        """What is pickled or copied: nothing of the run."""
        self.keep()
        return vars(self).copy()


@dataclass(frozen=True)
class Place:
    """Where a sensor's readings stand in the suite: robots (k,), their slots, groups and rows."""

    robots: NDArray[np.int64]
    slots: NDArray[np.int64]
    groups: tuple[Group, ...]
    rows: tuple[Rows, ...]  # per group
    order: NDArray[np.int64]  # of the rows of all groups, one behind the other, by robot


def find_sensor(suite: Suite, name: str) -> Place:
    """The robots that have sensor `name`: `laser`, `laser:1`, or a sensor file's own name.

    Raises ValueError where no robot has it, with what there is.
    """
    kind, _, number = name.partition(":") if isinstance(name, str) else ("", "", "?")
    if number and not number.isdecimal():
        raise ValueError(f"{name!r} is no sensor: write it as laser, or laser:1")
    groups = suite.groups_of(kind)
    robots, slots, numbers, rows = (
        np.concatenate([np.zeros(0, np.int64), *parts])
        for parts in (
            [group.robots for group in groups],
            [group.slots for group in groups],
            [np.full(len(group.robots), number) for number, group in enumerate(groups)],
            [np.arange(len(group.robots)) for group in groups],
        )
    )
    order = np.argsort(slots)  # robot by robot, and of each in the order of its sensors
    chosen = order[places_among_equals(robots[order]) == int(number or 0)]
    if not len(chosen):
        there = ", ".join(f"{one}:{k}" for one, count in counts(suite) for k in range(count))
        raise ValueError(f"no robot has a sensor {name!r}; there are: {there or 'none'}")
    known, first = np.unique(numbers[chosen], return_index=True)
    known = known[np.argsort(first)]
    members = [np.flatnonzero(numbers[chosen] == number) for number in known]
    return Place(
        robots[chosen],
        slots[chosen],
        tuple(groups[number] for number in known),
        tuple(
            rows_of(rows[chosen[member]], groups[number])
            for member, number in zip(members, known, strict=True)
        ),
        np.argsort(np.concatenate(members)),
    )


def places_among_equals(values: NDArray[np.int64]) -> NDArray[np.int64]:
    """Of values (n,) in which equals stand side by side, the place of each among its equals.

    >>> places_among_equals(np.array([4, 4, 4, 7, 9, 9])).tolist()
    [0, 1, 2, 0, 0, 1]
    """
    places = np.arange(len(values))
    begins = np.append(True, values[1:] != values[:-1])[: len(values)]
    return places - np.maximum.accumulate(np.where(begins, places, 0))


def counts(suite: Suite) -> list[tuple[str, int]]:
    """The types of sensors that there are, and how many of each a robot has at the most."""
    found = []
    for name in dict.fromkeys(group.type.name for group in suite.groups):
        robots = np.concatenate([group.robots for group in suite.groups_of(name)])
        found.append((name, int(np.bincount(robots).max(initial=0))))
    return found


def rows_of(rows: NDArray[np.int64], group: Group) -> Rows:
    """Rows of a group's readings; None where these are all of them, in their order."""
    return None if np.array_equal(rows, np.arange(len(group.robots))) else rows


def readings_of(place: Place, name: str, time: float) -> Readings:
    """The readings that stand at `place`; they `keep` what may change when they are told to.

    Raises ValueError where robots' sensors differ so much that their readings are no one array.
    """
    if len(place.groups) == 1:
        (group,), (rows,) = place.groups, place.rows
        return Readings(place.robots, time, group.readings, rows)
    batches = [
        Readings(place.robots, time, group.readings, rows).data
        for group, rows in zip(place.groups, place.rows, strict=True)
    ]
    try:
        joined = join(batches, place.order)
    except ValueError:
        raise ValueError(
            f"the robots' sensors {name!r} differ in their number of samples or elements, so "
            "their readings are no one array: give robots= of one model"
        ) from None
    return Readings(place.robots, time, joined, None)


SHARED = frozenset({"poses", "arcs"})
"""Arrays of a batch that belong to the sensor, not to a robot."""


@cache
def _array_names(kind: type[Batch]) -> tuple[str, ...]:
    return tuple(one.name for one in fields(cast(Any, kind)) if one.name not in SHARED)


def arrays_by_robot(batch: Batch) -> list[str]:
    """Names of the arrays of a batch that have a row for each robot."""
    found = [
        (name, value)
        for name in _array_names(type(batch))
        if isinstance(value := getattr(batch, name), np.ndarray) and value.ndim > 0
    ]
    return [name for name, value in found if len(value) == len(found[0][1])]


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
