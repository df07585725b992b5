"""Paint's mind without physics: exact lasers, bodies that move as told, a judge of squares."""

from __future__ import annotations

import math

import numpy as np
import pytest

from controllers.paint.brain import Settings
from controllers.paint.geometry import rectangle
from troupe.testing.paint.bench import random_starts, run
from troupe.testing.paint.goals import expected_goals

SIZE = (16.0, 21.0)

# Placements in which robots hide each other or stand nearly level: hard ones. Others do as well.
HARD = [(4, 2, 5, 0.0), (4, 2, 192, 1.0), (4, 0, 31, 1.0), (2, 0, 1, 0.0), (8, 0, 24, 0.0)]


@pytest.mark.parametrize(("robots", "level", "seed", "jitter"), HARD)
def test_goals_are_right_and_nobody_is_touched_or_passed(
    robots: int, level: int, seed: int, jitter: float
) -> None:
    starts = random_starts(
        np.random.default_rng([seed, robots]), robots, SIZE, 0.5, (0.0, math.pi), level
    )
    settings = Settings(robots, paint=False, jitter=jitter)
    outcome = run(starts, lambda i: settings, rectangle(*SIZE).corners, seed=seed, duration=600.0)
    assert outcome.failures == [None] * robots
    assert all(outcome.finished)
    assert outcome.contacts == 0
    assert outcome.swaps == 0
    reached = outcome.poses[:, :2]
    assert reached == pytest.approx(
        expected_goals(starts, (0.0, 0.0), SIZE), abs=0.02
    )  # AT_GOAL and braking
