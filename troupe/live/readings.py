"""What robots perceive, as a page shows it: of all where there are few, and all of who is selected.

Of the others what somebody reads is shown as it was sensed. Who is selected shows all its sensors:
those that nobody reads are sensed here, aside, with the very noise that their reader would get.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sensors.readings import Bits, Blobs, Elements, Fiducials, Intensities, Scalars, Scans
from sensors.suite import Group, Suite
from sim.view.moment import Cones, Fan, Marks, Pose, Sight, Switches
from troupe.live.scene import MOST_FANS

if TYPE_CHECKING:
    from sim.engine import Engine


@dataclass
class Shown:
    """The readings of one moment. `sensors`: by selected robot, what each sensor is."""

    fans: list[Fan] = field(default_factory=list)
    cones: list[Cones] = field(default_factory=list)
    sights: list[Sight] = field(default_factory=list)
    marks: list[Marks] = field(default_factory=list)
    switches: list[Switches] = field(default_factory=list)
    sensors: dict[int, list[dict[str, Any]]] = field(default_factory=dict)

    def add(self, group: Group, row: int, sensor: int) -> None:
        """Add one sensor's reading, if it is of a kind that can be drawn."""
        readings, robot = group.readings, int(group.robots[row])
        x, y, yaw = group.origins[row].tolist()
        pose: Pose = (x, y, yaw)
        if isinstance(readings, Scans | Intensities):
            ranges = np.minimum(readings.ranges[row], 1e5).astype(np.float32)
            self.fans.append(Fan(robot, sensor, pose, readings.fov, ranges))
        elif isinstance(readings, Elements):
            self.cones.append(Cones(robot, sensor, readings.fov, placed(readings, row, pose)))
        elif isinstance(readings, Blobs):
            fov = math.radians(getattr(group.settings, "fov", 0.0))
            width, height = readings.width, readings.height
            blobs = seen_blobs(readings, row)
            self.sights.append(Sight(robot, sensor, pose, fov, width, height, blobs))
        elif isinstance(readings, Fiducials):
            seen = readings.seen(row)
            columns = [seen[name].astype(np.float32) for name in ("id", "x", "y", "yaw")]
            self.marks.append(Marks(robot, sensor, pose, np.stack(columns, axis=1)))
        elif isinstance(readings, Bits):
            bits = readings.bits[row]
            arcs = np.zeros((len(bits), 2)) if readings.arcs is None else readings.arcs
            parts = np.column_stack([bits, arcs]).astype(np.float32)
            self.switches.append(Switches(robot, sensor, pose, parts))


class Eyes:
    """Looks at a run's sensors."""

    def __init__(self, engine: Engine) -> None:
        # A suite of its own over the same scene: the run's own readings stay what they are.
        self._suite = Suite(engine.scenery.scene, engine.settings.seed)
        self._robots = 0

    def look(self, engine: Engine, settled: NDArray[np.bool_], selected: frozenset[int]) -> Shown:
        """The readings of now. `settled` (n,): whose controller has ended, so that nobody reads."""
        shown = Shown()
        suite = engine.scenery.suite
        if len(settled) <= MOST_FANS:
            for group in suite.groups:
                for row in group.rows[~settled[group.robots[group.rows]]].tolist():
                    if int(group.robots[row]) not in selected:
                        sensor = int(group.slots[row]) - suite.first_slot[int(group.robots[row])]
                        shown.add(group, row, sensor)
        chosen = sorted(robot for robot in selected if robot < len(settled))
        if chosen:
            self._sense(engine, chosen)
            for robot in chosen:
                shown.sensors[robot] = []
                for sensor in range(self._count(robot)):
                    group, row = self._suite.place(robot, sensor)
                    shown.add(group, row, sensor)
                    shown.sensors[robot].append(described(group, row))
        return shown

    def _count(self, robot: int) -> int:
        first = self._suite.first_slot
        return (first[robot + 1] if robot + 1 < len(first) else self._suite.slots) - first[robot]

    def _sense(self, engine: Engine, chosen: list[int]) -> None:
        """Sense with all sensors of these robots, from what the scene was at the last tick."""
        suite, scenery = self._suite, engine.scenery
        for robot in range(self._robots, scenery.stage.count):
            one = engine.robots[robot]
            suite.add_robot(one.entity, one.name, one.model.sensors)
        self._robots = scenery.stage.count
        suite.contacts = scenery.suite.contacts
        wanted = np.zeros(suite.slots, bool)
        for robot in chosen:
            first = suite.first_slot[robot]
            wanted[first : first + self._count(robot)] = True
        suite.sense(engine.ticks, engine.time, wanted)


def placed(readings: Elements, row: int, pose: Pose) -> NDArray[np.float32]:
    """A ring's elements (k, 4) in the world: x, y, heading, range."""
    x, y, yaw = pose
    cos, sin = math.cos(yaw), math.sin(yaw)
    at = readings.poses
    columns = (
        x + cos * at[:, 0] - sin * at[:, 1],
        y + sin * at[:, 0] + cos * at[:, 1],
        yaw + at[:, 2],
        np.minimum(readings.ranges[row], 1e5),
    )
    return np.stack(columns, axis=1).astype(np.float32)


def seen_blobs(readings: Blobs, row: int) -> NDArray[np.uint32]:
    """A camera's blobs (k, 6): colour, left, right, top, bottom, range in millimetres."""
    blobs = readings.seen(row)
    found = np.empty((len(blobs), 6), np.uint32)
    for column, name in enumerate(("color", "left", "right", "top", "bottom")):
        found[:, column] = blobs[name]
    found[:, 5] = np.minimum(1000.0 * blobs["range"], 4e9)
    return found


def described(group: Group, row: int) -> dict[str, Any]:
    """What a sensor is, for a robot's card; numbers that cannot be drawn stand here."""
    found: dict[str, Any] = {"type": group.type.name, "kind": group.kind}
    readings = group.readings
    if isinstance(readings, Scans | Elements | Intensities | Fiducials):
        found["range"] = readings.max_range
    if isinstance(readings, Scalars):
        found["values"] = list(values(readings, row))
    return found


def values(readings: Scalars, row: int) -> Iterator[tuple[str, float, str]]:
    """Name, number and unit."""
    numbers = readings.values[row].tolist()
    yield from zip(readings.names, numbers, readings.units, strict=True)
