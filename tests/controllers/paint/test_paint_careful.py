"""Turning beside a robot that may turn as well: every such turn has an end."""

from __future__ import annotations

import math

import pytest

from controllers.paint.acts.careful import FAR
from controllers.paint.acts.turning import turning
from controllers.paint.brain import Brain, Command, Settings
from controllers.paint.geometry import Pose, rectangle
from controllers.paint.memory import Phase
from controllers.paint.moves import look
from controllers.paint.moves.room import Near
from controllers.paint.moves.twist import looks_at


@pytest.mark.parametrize("off", [math.pi / 2, FAR + 0.01, FAR - 0.01, math.radians(2.0)])
def test_a_careful_turn_ends_where_it_was_to_go_however_short_it_is(off: float) -> None:
    brain = Brain(Settings(8), lambda: 0.5)
    brain.memory.region = rectangle(16.0, 21.0)
    brain.memory.phase = Phase.GOING
    brain.pose = Pose(8.0, 10.0, look.DOWN - off)
    brain.memory.careful_from = brain.pose.yaw  # it has begun; who was beside it goes away
    brain.nearest = Near(face=math.inf, turner=math.inf)
    for _ in range(200):
        command = Command()
        if not turning(brain, command, look.DOWN):
            break
        yaw = brain.pose.yaw + command.motion.turn * 0.1
        brain.pose = brain.pose._replace(yaw=yaw)
        brain.time += 0.1
    assert looks_at(brain.pose, look.DOWN)
    assert brain.memory.careful_from is None  # it does something else now
    assert turning(brain, Command(), look.UP)  # such as turning elsewhere
