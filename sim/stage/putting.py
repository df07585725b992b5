"""Where bodies may be put by hand: in the world, and in nothing that is there already."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sim.stage.fits import FreeSpace
from sim.stage.geometry import Floats, depth, reach
from sim.stage.layout import Layout
from sim.stage.limits import SLOP
from sim.stage.standing import Pose


class Places:
    """What stands in a layout, and whether bodies that move overlap it or each other.

    To touch is allowed, as deep as bodies that rest on each other lie (SLOP). What stands may
    overlap other things that stand, as in a world file, but no door.
    """

    def __init__(self, layout: Layout) -> None:
        owned = {one.group for one in layout.fixtures}
        built_in = tuple(solid for solid in layout.solids if solid.group not in owned)
        doors = replace(layout, solids=())
        self._room = FreeSpace(replace(layout, solids=built_in), doors=False, movable=False)
        self._doors = FreeSpace(doors, movable=False)
        self._levels = layout.levels
        self.stand(layout)

    def stand(self, layout: Layout) -> None:
        """Take over where the fixtures of the layout are."""
        solids = tuple(solid for one in layout.fixtures for solid in layout.solids[one.solids])
        self._fixtures = FreeSpace(replace(layout, solids=solids), doors=False, movable=False)

    def free(self, body: Any, pose: Pose, others: Sequence[Any], poses: Floats) -> bool:
        """Whether a body fits at a pose (x, y, yaw) among others at theirs, (n, 3)."""
        levels = self._levels.of(body)
        if any(room.hit_by(body, pose, SLOP, levels) is not None for room in self._standing):
            return False
        return self._clear(body, pose, others, poses)

    def free_for_fixture(self, body: Any, pose: Pose, others: Sequence[Any], poses: Floats) -> bool:
        """The same for what stands."""
        if self._doors.hit_by(body, pose, SLOP, self._levels.of(body)) is not None:
            return False
        return self._clear(body, pose, others, poses)

    @property
    def _standing(self) -> tuple[FreeSpace, FreeSpace]:
        return self._room, self._fixtures

    def _clear(self, body: Any, pose: Pose, others: Sequence[Any], poses: Floats) -> bool:
        """Whether a body at a pose is in the world, and in none of the others."""
        if not self._room.holds(np.array([pose[:2]])):
            return False
        levels, span = self._levels.of(body), reach(body)
        spans = np.array([reach(other) for other in others])
        apart = np.hypot(poses[:, 0] - pose[0], poses[:, 1] - pose[1])
        for near in np.nonzero(apart < span + spans)[0].tolist():
            if not self._levels.of(others[near]) & levels:
                continue
            if depth(body, pose, others[near], poses[near]) > SLOP:
                return False
        return True

    def fitting(
        self, goals: Mapping[int, Pose], bodies: Sequence[Any], poses: Floats
    ) -> dict[int, Pose]:
        """Those of the goals that bodies which are lifted all at once can be put down at.

        goals: pose by the index of a body. bodies (n) with poses (n, 3): all that move. Who finds
        no place stays, and then is in the way of the others.
        """
        staying: set[int] = set()
        while True:
            found: dict[int, Pose] = {}
            now = poses.copy()
            there = [k for k in range(len(bodies)) if k not in goals or k in staying]
            for index in goals:
                if index in staying:
                    continue
                if not self.free(
                    bodies[index], goals[index], [bodies[k] for k in there], now[there]
                ):
                    staying.add(index)
                    break
                now[index] = goals[index]
                found[index] = goals[index]
                there.append(index)
            else:
                return found
