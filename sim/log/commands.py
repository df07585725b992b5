"""The commands in force, as changes: what robots do from a tick on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log.compiled import compiled

NUMBERS = (
    "vx", "vy", "wz", "curvature", "goal_x", "goal_y", "goal_yaw", "speed_limit", "turn_limit",
)  # fmt: skip
"""The fields of the stage's records that make a command, besides `mode` and `motors`."""
WIDTH = len(NUMBERS) + 2
POSITION, HEADING = 2, 3
GOAL_X, GOAL_Y, SPEED_LIMIT, MODE, MOTORS = 4, 5, 7, 9, 10


def fresh(robots: int) -> NDArray[np.float64]:
    """(n, 11) what robots do that have just entered: NUMBERS, mode, motors."""
    found = np.zeros((robots, WIDTH))
    found[:, MOTORS] = 1.0
    return found


@compiled
def is_told(was: NDArray[np.float64], now: NDArray[np.float64]) -> bool:
    """Whether a robot was told something, as its commands (11,) differ; `now` is made what it was.

    A robot that has come to the pose it was sent to holds its heading there: that is no new
    command, and where it was sent and came in the same tick, the sending is.
    """
    sent = now[GOAL_X] != was[GOAL_X] or now[GOAL_Y] != was[GOAL_Y]
    if now[MODE] == HEADING and (sent or now[SPEED_LIMIT] != was[SPEED_LIMIT]):
        now[MODE] = POSITION
    if was[MODE] != POSITION or now[MODE] != HEADING or now[0] != 0.0:
        return True
    same = True
    for k in range(1, WIDTH):
        same = same and (k == MODE or now[k] == was[k])
    return not same


def obey(record: Any, command: NDArray[np.float64]) -> None:
    """Write a command (11,) into one of the stage's records."""
    for index, name in enumerate(NUMBERS):
        record[name] = command[index]
    record["mode"], record["motors"] = int(command[MODE]), bool(command[MOTORS])
