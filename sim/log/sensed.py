"""The readings that a log keeps: which groups of sensors, and copies of what they sensed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sim.log.moment import Fans, SensorGroup

if TYPE_CHECKING:
    from sensors.suite import Group, Suite

ALL = "all"
NOUNS = {"scan": "scan", "intensities": "scan", "elements": "range", "blobs": "blobs"}
"""How the topics of readings end, by their kind."""
NO_RANGES = np.zeros((0, 0), np.float32)


class Sensed:
    """Copies readings, tick by tick. wanted: types of sensors, or `all`."""

    def __init__(self, wanted: frozenset[str]) -> None:
        self.wanted = wanted
        self.groups: dict[int, SensorGroup | None] = {}

    def wants(self, what: str) -> bool:
        return what in self.wanted or ALL in self.wanted

    def fans(self, suite: Suite, names: Sequence[str]) -> list[Fans]:
        """What was sensed in this tick, of the sensors that are to be logged."""
        found = []
        for group in suite.groups:
            source = self.source(group)
            if source is None or not group.rows.size:
                continue
            for row in range(len(source.members), len(group.robots)):
                source.members.append(self.member(suite, group, row, names[int(group.robots[row])]))
            found.append(COPIES[group.kind](source, group.rows, group.readings))
        return found

    def source(self, group: Group) -> SensorGroup | None:
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


def seen_blobs(source: SensorGroup, rows: NDArray[np.int64], readings: Any) -> Fans:
    """What cameras saw, of each as many blobs as there are."""
    counts = readings.counts[rows]
    columns = np.arange(counts.max())
    robots, numbers = (columns < counts[:, None]).nonzero()
    blobs = readings.blobs[rows[robots], numbers]
    return Fans(source, rows, NO_RANGES, None, blobs.tobytes(), counts)


def ranges_only(source: SensorGroup, rows: NDArray[np.int64], readings: Any) -> Fans:
    """What rays hit."""
    return Fans(source, rows, taken(readings.ranges, rows))


def intensities_too(source: SensorGroup, rows: NDArray[np.int64], readings: Any) -> Fans:
    """What rays hit, and what came back along them."""
    return Fans(source, rows, taken(readings.ranges, rows), taken(readings.intensities, rows))


COPIES: dict[str, Callable[[SensorGroup, NDArray[np.int64], Any], Fans]] = {
    "scan": ranges_only,
    "elements": ranges_only,
    "intensities": intensities_too,
    "blobs": seen_blobs,
}
"""How readings are copied, by their kind."""


def taken(values: NDArray[np.float64], rows: NDArray[np.int64]) -> NDArray[np.float32]:
    """Rows of readings as float32; copies."""
    part = values if len(rows) == len(values) else values[rows]
    return part.astype(np.float32)
