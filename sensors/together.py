"""Groups that look from one place, of which the same rows are wanted: sensed in one go.

All that stays from tick to tick is gathered once. What is left for a tick is a few compiled calls:
one that mounts the sensors, one that casts the rays of all groups, and what each kind of sensor
makes of them.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

import numpy as np

from sensors.grid import Ints
from sensors.group import Group
from sensors.rays import cast_fans, fans_of
from sensors.scene import Scene
from sensors.view import Touching, View, mount_sensors

ENOUGH_FOR_THREADS = 256
"""Sensors of one group from which on it pays to share them out to threads."""


@cache
def threads() -> tuple[int, ThreadPoolExecutor | None]:
    """How many cores this process may use, and threads for all of them but one."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return (cores, ThreadPoolExecutor(cores - 1)) if cores and cores > 1 else (1, None)


class Part:
    """Some of the rows, sensed by one thread."""

    def __init__(self, scene: Scene, groups: Sequence[Group], rows: Ints) -> None:
        first = groups[0]
        self._groups = groups
        self._views = [
            View(
                scene, rows, group.robots, group.entities, group.origins, group.keys, 0, 0.0,
                group.eye, group.settings.z,
            )
            for group in groups
        ]  # fmt: skip
        marks = tuple([(group.origins, group.times) for group in groups])
        self._mounts = scene.poses, first.entities, rows, first.settings.mount, marks
        self._rays: tuple[Any, ...] = ()
        fans = [group.fan for group in groups if group.fan is not None]
        if fans:
            fov, far = fans[0].fov, fans[0].max_range
            self._rays = (
                self._views[0].seen, first.origins, first.entities, rows,
                *fans_of(fov, tuple([fan.ranges.shape[1] for fan in fans])), fov, far,
                tuple([(fan.ranges, fan.hits) for fan in fans]),
            )  # fmt: skip

    def sense(self, tick: int, time: float, touching: Touching) -> None:
        """Sense with these rows of all groups."""
        mount_sensors(*self._mounts, time)
        if self._rays:
            cast_fans(*self._rays)
        for group, view in zip(self._groups, self._views, strict=True):
            view.tick, view.time, view.touching = tick, time, touching
            group.type.sense(group.settings, view, group.readings)


class Together:
    """Groups of one mount that sense together; those with fans have one field of view and reach.

    Every sensor writes its own row and reads nobody else's, so the result does not depend on
    how many threads share them out.
    """

    def __init__(self, scene: Scene, groups: Sequence[Group]) -> None:
        rows = groups[0].rows
        cores, pool = threads()
        alone = len(rows) < ENOUGH_FOR_THREADS or not all(group.type.threads for group in groups)
        parts = [rows] if pool is None or alone else np.array_split(rows, cores)
        self._pool = pool
        self._parts = [Part(scene, groups, part) for part in parts]

    def sense(self, tick: int, time: float, touching: Touching) -> None:
        """Sense with the wanted rows of all groups."""
        first, *rest = self._parts
        if not rest or self._pool is None:
            first.sense(tick, time, touching)
            return
        others = [self._pool.submit(part.sense, tick, time, touching) for part in rest]
        first.sense(tick, time, touching)
        for other in others:
            other.result()
