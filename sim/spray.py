"""Sprayers: which are on, where they are, and what they paint within a tick."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sim.robot import MountedSprayer, Robot
from sim.stage.floor import FloorPaint
from sim.stage.moving import NOBODY

MOST_PER_ROBOT = 1 << 16
"""More than Player's indices of one interface."""


class Spraying:
    """The painting of a run, in the order of robots and of each one's sprayers."""

    def __init__(self, floor: FloorPaint) -> None:
        self.floor = floor
        self.painters: list[Robot] = []  # robots that have sprayers
        self.on: list[tuple[Robot, int, MountedSprayer]] = []  # in the tick that goes by
        self.were_on = False

    def admit(self, robot: Robot) -> None:
        """A robot has entered."""
        if robot.sprayers:
            self.painters.append(robot)

    def carriers(self) -> NDArray[np.int64]:
        """(k,) The robots whose sprayers are on in the coming tick, one per sprayer."""
        if not self.painters:
            return NOBODY
        self.on = [
            (robot, number, sprayer)
            for robot in self.painters
            for number, sprayer in enumerate(robot.sprayers)
            if sprayer.on
        ]
        return np.array([robot.index for robot, _, _ in self.on], np.int64)

    def mark(self, ways: NDArray[np.float64]) -> None:
        """Paint under the sprayers that are on, on the ways (k, m, 3) of their carriers."""
        on = self.on
        if not on and not self.were_on:
            return
        self.were_on = bool(on)
        self.floor.spray(
            np.array([MOST_PER_ROBOT * robot.index + number for robot, number, _ in on], np.int64),
            np.array([robot.index for robot, _, _ in on], np.int64),
            ways,
            np.array([sprayer.mount.size for _, _, sprayer in on], float).reshape(-1, 2),
            np.array([sprayer.mount.offset for _, _, sprayer in on], float).reshape(-1, 2),
        )


def close(robot: Robot) -> None:
    """Turn a robot's sprayers off."""
    for sprayer in robot.sprayers:
        sprayer.on = False
