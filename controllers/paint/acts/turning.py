"""Turning where there is room, where to look by a side wall, and up or down while looking there."""

from __future__ import annotations

from ..brain import Brain, Command
from ..memory import Phase
from ..moves import look
from ..moves.room import free_travel, may_turn
from ..moves.twist import drive, looks_at, turn
from . import careful

NEAR = 0.05
"""A robot this near to a height (m) has arrived there."""

STALLED = 60.0
"""Who has come no nearer to its goal for so long (s) decides less often: what it sees as it turns
to step aside must not end the step, and no change of mind begins its patience anew. And it turns
where others may turn as well: see `careful`."""


def stalled(brain: Brain) -> bool:
    """Whether it goes to its goal and has come no nearer to it for long, whatever it did."""
    memory = brain.memory
    return memory.phase is Phase.GOING and brain.time - memory.nearer_at > STALLED


def turning(brain: Brain, command: Command, gaze: float) -> bool:
    """Begin or go on turning to a heading where there is room; false if there is nothing to do.

    A robot that moves comes to rest first.
    """
    memory = brain.memory
    if memory.careful_from is not None and careful.go_on(brain, command, gaze):
        return True
    if looks_at(brain.pose, gaze):
        return False
    if not may_turn(brain.region, brain.pose, memory.tracks.all, brain.time, brain.nearest):
        if not (stalled(brain) and careful.may_begin(brain)):
            return False
        memory.careful_from = brain.pose.yaw
        return careful.go_on(brain, command, gaze)
    if not brain.moving:
        command.motion = turn(brain.pose, gaze, brain.settings.limits)
    return True


def side_gaze(brain: Brain) -> float | None:
    """By a side wall the robot looks away from it: all there is, is on that side."""
    left, right = brain.region.left, brain.region.right
    if brain.pose.x - left < look.BY_WALL:
        return look.RIGHT
    if right - brain.pose.x < look.BY_WALL:
        return look.LEFT
    return None


def up_or_down(brain: Brain, command: Command, height: float) -> bool:
    """One reading's worth of the way to a height; false once it is there or can go no farther."""
    pose, tracks = brain.pose, brain.memory.tracks.all
    if abs(height - pose.y) <= NEAR:
        return False
    side = side_gaze(brain)
    gaze = side if side is not None else look.UP if height > pose.y else look.DOWN
    if turning(brain, command, gaze):
        return True
    target = (pose.x, height)
    travel = free_travel(brain.region, pose, target, tracks, brain.time)
    if travel <= NEAR:
        return False
    command.motion = drive(pose, target, travel, brain.settings.limits, 0.5)
    return True
