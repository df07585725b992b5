"""Nearing: up or down while the rank is open, as far as every rank that it may be leads.

A robot whose rank is still open between two or three goes towards the nearest of their goals'
heights where all of them are on one side. It keeps the order as on any vertical leg, so no bound on
the rank expires; and a crowd that spreads over the region hides less.
"""

from __future__ import annotations

from ..brain import Brain, Command
from ..task import task_of
from .clearance import reachable
from .turning import up_or_down

WORTH = 0.3
"""Less than this (m) is not worth going."""

LOOKED = 6
"""So many looks are taken first: mostly they tell the rank. Later it is thought of in every third
one, and in the others of a side-step."""


def begin(brain: Brain) -> bool:
    """Whether to go now."""
    memory = brain.memory
    due = memory.looks >= LOOKED and memory.looks % 3 == 1
    memory.nearing = due and _gain(brain) > WORTH
    return memory.nearing


def go_on(brain: Brain, command: Command) -> None:
    """One reading's worth of the way; it ends at rest."""
    memory, pose = brain.memory, brain.pose
    memory.row = pose.y
    brain.shadows.move_row(pose.y)
    height = _height(brain)
    if height is not None and up_or_down(brain, command, height):
        return
    if not brain.moving:
        memory.nearing = False
        memory.gaze = pose.yaw


def _gain(brain: Brain) -> float:
    height = _height(brain)
    return 0.0 if height is None else abs(height - brain.pose.y)


def _height(brain: Brain) -> float | None:
    """The height to go to; None where the goals of the ranks that it may have are on both sides."""
    least, most = brain.memory.bounds.below
    low, high = (_goal_height(brain, rank) for rank in (least + 1, most + 1))
    if low is not None and low > brain.pose.y:
        return reachable(brain, low)
    if high is not None and high < brain.pose.y:
        return reachable(brain, high)
    return None


def _goal_height(brain: Brain, rank: int) -> float | None:
    settings = brain.settings
    try:
        return task_of(brain.region, rank, settings.robots, settings.sprayer[1]).goal[1]
    except ValueError:  # no body fits into that strip
        return None
