"""The commands in force, as changes: what robots do from a tick on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

NUMBERS = (
    "vx", "vy", "wz", "curvature", "goal_x", "goal_y", "goal_yaw", "speed_limit", "turn_limit",
)  # fmt: skip
"""The fields of the stage's records that make a command, besides `mode` and `motors`."""
WIDTH = len(NUMBERS) + 2
POSITION, HEADING = 2, 3
MODE, MOTORS, GOAL, SPEED_LIMIT = 9, 10, slice(4, 6), 7


def table(movers: NDArray[Any]) -> NDArray[np.float64]:
    """Commands (..., 11) of the stage's records (...): NUMBERS, mode, motors."""
    found = np.empty((*movers.shape, WIDTH))
    for index, name in enumerate((*NUMBERS, "mode", "motors")):
        found[..., index] = movers[name]
    return found


def changes(
    before: NDArray[np.float64], after: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Robots (k,) that were told something new, and their commands (k, 11), as they were given.

    before, after: (n, 11) at the ends of a tick and of the next. A robot that has come to the
    pose it was sent to holds its heading there: that is no new command, and where it was sent
    and came in the same tick, the sending is.
    """
    differs = (before != after).any(axis=1)
    if not differs.any():
        return np.zeros(0, np.intp), after[:0]
    robots = np.flatnonzero(differs)
    told, was = after[robots].copy(), before[robots]
    sent = (told[:, GOAL] != was[:, GOAL]).any(axis=1) | (
        told[:, SPEED_LIMIT] != was[:, SPEED_LIMIT]
    )
    told[(told[:, MODE] == HEADING) & sent, MODE] = POSITION
    arrived = was.copy()
    arrived[:, MODE], arrived[:, 0] = HEADING, 0.0
    came = (was[:, MODE] == POSITION) & (told == arrived).all(axis=1)
    return robots[~came], told[~came]


def obey(record: Any, command: NDArray[np.float64]) -> None:
    """Write a command (11,) into one of the stage's records."""
    for index, name in enumerate(NUMBERS):
        record[name] = command[index]
    record["mode"], record["motors"] = int(command[MODE]), bool(command[MOTORS])
