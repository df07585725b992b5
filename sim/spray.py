"""Sprayers: which are on, where they are, and what they paint within a tick."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.devices.device import Context
from sim.worldfile.schema import Sprayer

MOST_PER_ROBOT = 1 << 16
"""More than Player's indices of one interface."""


class Sprayers:
    """Every robot's sprayers, in the order of robots."""

    def __init__(self) -> None:
        self.mounts: dict[tuple[int, int], Sprayer] = {}
        self.on: list[tuple[int, int]] = []
        self.were_on = False

    def add(self, robot: int, index: int, sprayer: Sprayer) -> None:
        self.mounts[(robot, index)] = sprayer

    def carriers(self, context: Context) -> NDArray[np.int64]:
        """(k,) The robots whose sprayers are on in the coming tick, one per sprayer."""
        self.on = sorted(key for key, is_on in context.spraying.items() if is_on)
        return np.array([robot for robot, _ in self.on], np.int64)

    def mark(self, context: Context, ways: NDArray[np.float64]) -> None:
        """Paint under the sprayers that are on, on the ways (k, m, 3) of their carriers."""
        on = self.on
        if not on and not self.were_on:
            return
        self.were_on = bool(on)
        context.floor.spray(
            np.array([MOST_PER_ROBOT * robot + index for robot, index in on], np.int64),
            np.array([robot for robot, _ in on], np.int64),
            ways,
            np.array([self.mounts[key].size for key in on], float).reshape(-1, 2),
            np.array([self.mounts[key].offset for key in on], float).reshape(-1, 2),
        )

    def close(self, context: Context, robot: int) -> None:
        """Turn a robot's sprayers off."""
        for key in context.spraying:
            if key[0] == robot:
                context.spraying[key] = False
