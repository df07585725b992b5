"""Doors: at which ticks a robot enters, by the rule of steps.

A door's period cuts time into steps: step n ends at n times the period. At the end of step n the
next robot enters if no body overlapped the door's cell at the beginning of step n; where nobody
lingers, robots enter at the steps 1, 3, 5, ...
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.stage.geometry import Floats, pieces, placed, reach, separation

if TYPE_CHECKING:
    from sim.stage.layout import Layout
    from sim.stage.stage import Stage
    from sim.stage.standing import DoorCell
    from sim.worldfile.schema import Model

TOUCH = 1e-6
"""Metres: bodies that only touch the edge of a door's cell do not overlap it."""


class Doors:
    """All doors of a world. `steps[d]` lists the steps at whose end a robot entered by door d."""

    def __init__(self, layout: Layout, models: Mapping[str, Model], interval: float) -> None:
        self.doors = layout.doors
        self._movables = [movable.body for movable in layout.movables]
        self._levels = layout.levels
        self.steps: list[list[int]] = [[] for _ in self.doors]
        self._most_reach = max((reach(model.body) for model in models.values()), default=0.0)
        self._ticks = 0
        self._periods = [max(1, round(door.period / interval)) for door in layout.doors]
        self._free = [True] * len(self.doors)
        self._stale = list(range(len(self.doors)))  # doors whose step begins now

    def advance(self) -> list[int]:
        """One tick has gone by: the doors at which a robot is to enter now, in their order.

        The robots must have entered before the next tick: where they stand counts for the step
        that begins.
        """
        self._ticks += 1
        due = [d for d, period in enumerate(self._periods) if self._ticks % period == 0]
        entering = [d for d in due if self._free[d]]
        for d in entering:
            self.steps[d].append(self._ticks // self._periods[d])
        self._stale = due
        return entering

    def begin(self, stage: Stage) -> None:
        """Look which doors are free where a step begins; after all have entered, before a tick."""
        for d in self._stale:
            self._free[d] = not self._occupied(self.doors[d], stage)
        self._stale = []

    def _occupied(self, door: DoorCell, stage: Stage) -> bool:
        """Whether any robot's or movable obstacle's body overlaps a door's cell."""
        corners = door.rectangle
        entering = self._levels.of(stage.models[door.model].body)
        away = np.hypot(*(stage.poses[:, :2] - door.centre).T)
        half = 0.5 * float(np.hypot(*door.size))
        for robot in np.flatnonzero(away < half + self._most_reach).tolist():
            body = stage.model(robot).body
            if not self._levels.of(body) & entering:
                continue
            if away[robot] < half + reach(body) and fills(body, stage.poses[robot], corners):
                return True
        return any(
            fills(body, pose, corners)
            for body, pose in zip(self._movables, stage.movable_poses, strict=True)
            if self._levels.of(body) & entering
        )

    def filled(self, stage: Stage, ended: Collection[int]) -> bool:
        """Whether every door's cell holds (the centre of) one of the given robots."""
        if not self.doors:
            return True
        positions = stage.poses[np.array(sorted(ended), np.int64), :2].reshape(-1, 2)
        for door in self.doors:
            low, high = door.rectangle.min(axis=0), door.rectangle.max(axis=0)
            if not np.any(np.all((positions >= low) & (positions <= high), axis=1)):
                return False
        return True


def fills(body: Any, pose: Floats, cell: Floats) -> bool:
    """Whether a body of the schema at a pose overlaps a cell (4, 2) by more than a touch."""
    return any(separation(placed(vertices, pose), cell) < -TOUCH for vertices, _ in pieces(body))
