"""All sensors of all robots: grouped by equal settings, each group sensed in one batch."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass
from typing import Protocol
from weakref import WeakSet

import numpy as np

from sensors.grid import Flags
from sensors.group import Group
from sensors.noise import stream_key
from sensors.readings import Readings
from sensors.registry import type_of
from sensors.scene import Scene
from sensors.settings import SensorSettings
from sensors.together import Together
from sensors.view import Contacts, Touching

__all__ = ["Group", "Reading", "Suite"]

Wanted = Flags | Callable[[], Flags]


class Kept(Protocol):
    """What shows readings as they are until they are written anew."""

    def keep(self) -> None:
        """Copy what is still to be shown."""


@dataclass(frozen=True)
class Reading:
    """One sensor's reading: `data` is of the group's kind of readings, with n = 1."""

    time: float
    """Simulated seconds; -1 before the first reading."""
    data: Readings


class Suite:
    """The sensors of all robots of a run.

    Robots may be added at any time; their sensors sense from the next `sense` on. Sensors are
    numbered in the order in which they were added: sensor i of robot r is slot
    `first_slot[r] + i`.
    """

    def __init__(self, scene: Scene, seed: int) -> None:
        self.scene = scene
        self.seed = seed
        self.groups: list[Group] = []
        """The batches, in the order in which their settings first came."""
        self.contacts: Touching = Contacts.none()
        """Where robots touch something, for the bumpers, or a function that tells it when asked."""
        self.first_slot: list[int] = []
        """(robots,) the slot of each robot's first sensor."""
        self.slots = 0
        """How many sensors there are in all."""
        self._groups: dict[SensorSettings, Group] = {}
        self._casts: list[tuple[Group, ...]] = []  # whose fans are cast together
        self._places: list[tuple[Group, int]] = []  # per slot: its group, its row
        self._told: bytes | None = None  # which sensors were wanted last
        self._alike: list[tuple[Group, ...]] = []  # those of them of which the same rows are wanted
        self._plan: list[Together] = []  # what is done in a tick
        self._version = -1  # of the scene for which that was made
        self._new: dict[int, list[tuple[int, int, int, np.uint64]]] = {}  # by id(group)
        self.given: WeakSet[Kept] = WeakSet()
        """Who looks at the readings as they are, and keeps them before they are written anew."""

    def add_robot(self, entity: int, name: str, settings: Sequence[SensorSettings]) -> int:
        """Add a robot with its sensors, in Player's order, and return the robot's index.

        Its name, with each sensor's index, makes the sensors' streams of noise.
        """
        robot = len(self.first_slot)
        self.first_slot.append(self.slots)
        for index, wanted in enumerate(settings):
            group = self._groups.get(wanted)
            if group is None:
                found = type_of(wanted)
                group = Group(found, wanted, found.readings(wanted, 0))
                self._groups[wanted] = group
                self.groups.append(group)
            new = self._new.setdefault(id(group), [])
            self._places.append((group, len(group.robots) + len(new)))
            new.append((robot, self.slots, entity, stream_key(self.seed, name, index)))
            self.slots += 1
        return robot

    def sense(self, tick: int, time: float, wanted: Wanted | None = None) -> None:
        """Sense with every sensor that is wanted, from what the scene was at its last refresh.

        Args:
            tick: the number of the tick: the noise of a tick is always the same.
            time: simulated seconds.
            wanted: (slots,) flags, or a function that gives them; all unless given. The readings
                of the others stay what they were.
        """
        while self.given:
            self.given.pop().keep()
        if self._new:
            self._admit()
        flags = wanted() if callable(wanted) else wanted
        if flags is not None and flags.shape != (self.slots,):
            raise ValueError(f"wanted needs a flag for each of {self.slots}, not {flags.shape}")
        told = b"" if flags is None else flags.tobytes()
        if told != self._told:
            self._choose(flags)
            self._told = told
        if self._version != self.scene.version:
            self._make_plan()
        for together in self._plan:
            together.sense(tick, time, self.contacts)

    def _choose(self, flags: Flags | None) -> None:
        """Find each group's wanted rows; the array stays the same one until others are wanted."""
        self._alike = []
        for groups in self._casts:
            for group in groups:
                group.rows = (
                    group.everybody if flags is None else np.flatnonzero(flags[group.slots])
                )
            alike = flags is None or all(np.array_equal(g.rows, groups[0].rows) for g in groups)
            self._alike += [groups] if alike else [(group,) for group in groups]
        self._version = -1

    def _make_plan(self) -> None:
        """Gather what is done in a tick, until other sensors are wanted or the scene is changed."""
        self._plan = []
        for groups in self._alike:
            first, *rest = [self.scene.seen(group.eye, group.settings.z) for group in groups]
            alike = all(seen is first for seen in rest)  # nothing is seen by some of them only
            for together in [groups] if alike else [(group,) for group in groups]:
                if together[0].rows.size:
                    self._plan.append(Together(self.scene, together))
        self._version = self.scene.version

    def slots_of(self, types: Container[str] | None) -> list[int]:
        """The slots of all sensors of some types, None: of all; of those that are new as well."""
        places = enumerate(self._places)
        return [slot for slot, (group, _) in places if types is None or group.type.name in types]

    def groups_of(self, name: str) -> list[Group]:
        """The groups of a type of sensors, with those that are new."""
        if self._new:
            self._admit()
        return [group for group in self.groups if group.type.name == name]

    def place(self, robot: int, sensor_index: int) -> tuple[Group, int]:
        """Where a sensor's readings stand from the next `sense` on: its group and its row."""
        first = self.first_slot[robot]
        last = self.first_slot[robot + 1] if robot + 1 < len(self.first_slot) else self.slots
        if not 0 <= sensor_index < last - first:
            raise IndexError(f"robot {robot} has {last - first} sensors, no sensor {sensor_index}")
        return self._places[first + sensor_index]

    def reading(self, robot: int, sensor_index: int) -> Reading:
        """The last reading of a sensor: views into the batch, which the next `sense` overwrites."""
        if self._new:
            self._admit()
        group, row = self.place(robot, sensor_index)
        return Reading(float(group.times[row]), group.readings.row(row))

    def _admit(self) -> None:
        """Give the sensors that were added since their rows in the groups' arrays."""
        for group in self.groups:
            new = self._new.get(id(group))
            if not new:
                continue
            robots, slots, entities, keys = zip(*new, strict=True)
            group.robots = np.append(group.robots, np.array(robots, np.int64))
            group.slots = np.append(group.slots, np.array(slots, np.int64))
            group.entities = np.append(group.entities, np.array(entities, np.int64))
            group.keys = np.append(group.keys, np.array(keys, np.uint64))
            n = len(group.robots)
            group.origins = np.concatenate([group.origins, np.zeros((len(new), 3))])
            group.times = np.append(group.times, np.full(len(new), -1.0))
            group.everybody = np.arange(n)
            group.readings = group.readings.resized(n)
        self._new.clear()
        self._told = None
        shared: dict[object, list[Group]] = {}
        for group in self.groups:
            group.fan = group.type.fan(group.settings, group.readings)
            key: object = id(group)
            if group.fan is not None:
                fov, far = group.fan.fov, group.fan.max_range
                key = group.settings.mount, fov, far, group.robots.tobytes()
            shared.setdefault(key, []).append(group)
        self._casts = [tuple(groups) for groups in shared.values()]
