"""Sprayers: which are on, where they are, and what they paint within a tick."""

from __future__ import annotations

import numpy as np

from sim.devices.device import Context
from sim.worldfile.schema import Sprayer

MOST_PER_ROBOT = 1 << 16
"""More than Player's indices of one interface."""


class Sprayers:
    """Every robot's sprayers, in the order of robots."""

    def __init__(self) -> None:
        self.mounts: dict[tuple[int, int], Sprayer] = {}
        self.were_on = False

    def add(self, robot: int, index: int, sprayer: Sprayer) -> None:
        self.mounts[(robot, index)] = sprayer

    def mark(self, context: Context) -> None:
        """Paint under the sprayers that are on."""
        on = sorted(key for key, is_on in context.spraying.items() if is_on)
        if not on and not self.were_on:
            return
        self.were_on = bool(on)
        floor = context.floor
        robots = np.array([robot for robot, _ in on], np.int64)
        floor.spray(
            np.array([MOST_PER_ROBOT * robot + index for robot, index in on], np.int64),
            robots,
            context.stage.poses[robots].reshape(-1, 3),
            np.array([self.mounts[key].size for key in on], float).reshape(-1, 2),
            np.array([self.mounts[key].offset for key in on], float).reshape(-1, 2),
        )

    def close(self, context: Context, robot: int) -> None:
        """Turn a robot's sprayers off."""
        for key in context.spraying:
            if key[0] == robot:
                context.spraying[key] = False
