"""Turning where there is room, and where to look by a side wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import look
from .move import looks_at, may_turn, turn

if TYPE_CHECKING:
    from .brain import Brain, Command


def turning(brain: Brain, command: Command, gaze: float) -> bool:
    """Begin or go on turning to a heading where there is room; false if there is nothing to do.

    A robot that moves comes to rest first.
    """
    if looks_at(brain.pose, gaze):
        return False
    if not may_turn(brain.region, brain.pose, brain.memory.tracks.all, brain.time, brain.nearest):
        return False
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
