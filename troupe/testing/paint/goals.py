"""The goals that the paper on Paint gives to robots, from where they truly start."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from controllers.paint.constants import LEVEL
from troupe.testing.ranks import ranked

INSET = 0.6
"""How far a goal lies within its strip's corner, in both axes (m)."""
SAME_HEIGHT = 0.01
"""Robots that start level may exchange heights by less (m): the odometry's rounding, the drive's
last centimetre, and which of them is told first to go."""


def expected_goals(
    starts: NDArray[np.float64], low: Sequence[float], high: Sequence[float]
) -> NDArray[np.float64]:
    """The goals (n, 2) in a rectangle from `low` to `high` that the paper gives, from true starts.

    P: its strip's lower left corner, N: the upper right one, each INSET further in, in both axes.
    x decides between heights that no robot can tell apart, which differ by less than LEVEL.
    """
    height = (high[1] - low[1]) / len(starts)
    goals = np.zeros((len(starts), 2))
    for place, i in enumerate(ranked(starts, level=LEVEL)[0]):
        if math.cos(starts[i, 2]) > 0.0:
            goals[i] = low[0] + INSET, low[1] + place * height + INSET
        else:
            goals[i] = high[0] - INSET, low[1] + (place + 1) * height - INSET
    return goals
