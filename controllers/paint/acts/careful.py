"""Turning beside a robot that may turn as well: slowly at first, and back if that one does too.

Two bodies that are less than 2 TURNING apart must not turn at the same time, so neither does as
long as the other has room to: they can stand like that for ever. Who has stood so for long and has
the other in view begins slowly. As long as it has not turned far, it sees the other begin in time:
both turn back, and try again after a while, each after one of its own.
"""

from __future__ import annotations

import math

from controllers.motion import wrap

from ..brain import Brain, Command
from ..moves.room import NEARBY, may_turn
from ..moves.twist import looks_at, turn

SLOWLY = math.radians(20.0)
"""The turn rate as long as it may have to turn back (rad/s)."""

FAR = math.radians(10.0)
"""Up to here it turns back. Two bodies turned by this need centres 1.17 m apart, and who has begun
later, by the two readings that it takes to see it, is not as far yet."""

AGAIN = 10.0
"""After turning back it tries again in up to so long (s)."""


def may_begin(brain: Brain) -> bool:
    """Whether it could turn if nobody else did, and all that are near are seen to stand so."""
    memory = brain.memory
    if brain.moving or brain.time < memory.careful_again or not _all_stand(brain):
        return False
    alone = brain.nearest._replace(turner=math.inf)
    return may_turn(brain.region, brain.pose, memory.tracks.all, brain.time, alone)


def go_on(brain: Brain, command: Command, gaze: float) -> bool:
    """One reading's worth of a turn begun carefully; false past turning back, or when done."""
    memory, pose = brain.memory, brain.pose
    assert memory.careful_from is not None
    far = abs(wrap(pose.yaw - memory.careful_from)) > FAR
    if not memory.gives_up and (far or looks_at(pose, gaze)):
        memory.careful_from = None
        return False
    memory.gives_up = memory.gives_up or not _all_stand(brain)
    if memory.gives_up and looks_at(pose, memory.careful_from):
        memory.careful_from, memory.gives_up = None, False
        memory.careful_again = brain.time + AGAIN * brain.draw()
        return True
    limits = brain.settings.limits
    slow = limits._replace(turn_rate=min(SLOWLY, limits.turn_rate))
    command.motion = turn(pose, memory.careful_from if memory.gives_up else gaze, slow)
    return True


def _all_stand(brain: Brain) -> bool:
    """Whether all robots that are near are in view and stand straight."""
    x, y = brain.pose.x, brain.pose.y
    near = [
        track
        for track in brain.memory.tracks.all
        if math.hypot(track.centre[0] - x, track.centre[1] - y) - track.reach < NEARBY
    ]
    return all(track.seen == brain.time and track.confirmed and track.sharp for track in near)
