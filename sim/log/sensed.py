"""The readings that a log keeps: of which groups of sensors, and where their arrays lie."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sensors.readings import BLOB
from sim.log.memory import is_plain
from sim.log.moment import Read, SensorGroup
from sim.log.tape import BLOBS, NARROW, Source

if TYPE_CHECKING:
    from sensors.suite import Group, Suite

ALL = "all"
NOUNS = {"scan": "scan", "intensities": "scan", "elements": "range", "blobs": "blobs"}
"""How the topics of readings end, by their kind."""
FIELDS = {
    "scan": ("ranges",),
    "elements": ("ranges",),
    "intensities": ("ranges", "intensities"),
    "blobs": ("blobs", "counts"),
}
"""The arrays of readings that are kept, by their kind."""
TYPES: dict[str, Any] = {
    "ranges": np.float64,
    "intensities": np.float64,
    "blobs": BLOB,
    "counts": np.int64,
}


class Sensed:
    """Knows where readings lie. wanted: types of sensors, or `all`."""

    def __init__(self, wanted: frozenset[str]) -> None:
        self.wanted = wanted
        self.groups: dict[int, SensorGroup | None] = {}
        self._known: list[Group] = []
        self._looked: list[tuple[Group, Any, Any, str, Any]] = []
        self._copies: list[tuple[Any, Any, str]] = []  # what is copied before it is noted
        self._restless: set[tuple[int, str]] = set()  # arrays that others take the place of

    def wants(self, what: str) -> bool:
        return what in self.wanted or ALL in self.wanted

    def look(self, suite: Suite, names: Sequence[str]) -> tuple[list[Source], list[Read]]:
        """The sources of all that is to be kept of what is sensed now, and whose they are."""
        self._looked, self._copies, self._known = [], [], list(suite.groups)
        sources: list[Source] = []
        found: list[Read] = []
        for number, group in enumerate(suite.groups):
            one = self.group(group)
            if one is None:
                continue
            for row in range(len(one.members), len(group.robots)):
                one.members.append(self.member(suite, group, row, names[int(group.robots[row])]))
            arrays = {}
            for field in FIELDS[group.kind]:
                array = getattr(group.readings, field)
                laid = as_laid(field, array)
                if (id(group), field) in self._restless or not is_plain(laid, TYPES[field]):
                    own: Any = np.array(laid, TYPES[field], order="C")
                    self._copies.append((own, group.readings, field))
                    self._looked.append((group, group.rows, group.readings, field, None))
                    laid = own
                else:
                    self._looked.append((group, group.rows, group.readings, field, array))
                arrays[field] = laid
            if not group.rows.size:
                continue
            everybody = len(group.rows) == len(group.robots)
            rows = None if everybody else group.rows
            if group.kind == "blobs":
                sources.append(Source(number, arrays["blobs"], BLOBS, rows, arrays["counts"]))
                named: dict[str, object] = {"blobs": number}
            else:
                named = {field: (number, field) for field in arrays}
                sources += [
                    Source((number, field), array, NARROW, rows) for field, array in arrays.items()
                ]
            found.append(Read(one, group.rows.tolist(), named))
        return sources, found

    def moved(self, suite: Suite) -> bool:
        """Whether what was looked for lies elsewhere now, or other sensors are read."""
        for group, rows, readings, field, array in self._looked:
            if group.rows is not rows or group.readings is not readings:
                return True
            if array is not None and getattr(readings, field) is not array:
                self._restless.add((id(group), field))
                return True
        for own, readings, field in self._copies:
            array = as_laid(field, getattr(readings, field))
            if array.shape != own.shape:
                return True
            np.copyto(own, array)
        return len(suite.groups) != len(self._known)

    def group(self, group: Group) -> SensorGroup | None:
        """What the log knows of a group; None if it is not to be logged."""
        if id(group) not in self.groups:
            readings, found = group.readings, None
            if self.wants(group.type.name) and group.kind in NOUNS:
                found = SensorGroup(
                    group.kind,
                    NOUNS[group.kind],
                    fov=getattr(readings, "fov", 0.0),
                    max_range=getattr(readings, "max_range", 0.0),
                    min_range=getattr(group.settings, "min_range", 0.0),
                    samples=readings.ranges.shape[1] if hasattr(readings, "ranges") else 0,
                    size=(getattr(readings, "width", 0), getattr(readings, "height", 0)),
                )
            self.groups[id(group)] = found
        return self.groups[id(group)]

    def member(self, suite: Suite, group: Group, row: int, name: str) -> tuple[str, str]:
        """Topic and frame of a sensor; the second and further ones of a robot have a number."""
        robot, slot = int(group.robots[row]), int(group.slots[row])
        first = suite.first_slot[robot]
        noun = NOUNS[group.kind]
        kinds = [suite.place(robot, index)[0].kind for index in range(slot - first)]
        before = sum(NOUNS.get(kind) == noun for kind in kinds)
        number = f"_{before}" if before else ""
        return f"/{name}/{noun}{number}", f"{name}/{noun}{number}"


def as_laid(field: str, array: NDArray[Any]) -> NDArray[Any]:
    """An array of readings as it lies in memory: of blobs all first ones come first."""
    return array.T if field == "blobs" else array
