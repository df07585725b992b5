"""Giving way: out of a line of nearly level robots, so that those on its ends see each other.

Who stands between two others at nearly its own height hides them from each other for good. If both
are below (or both above), it can leave the line on the other side without a change of order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import look
from .clearance import others, reachable
from .compute import Other, Side, is_lower
from .constants import APART, HALF
from .move import looks_at
from .turning import turning, up_or_down

if TYPE_CHECKING:
    from .brain import Brain, Command

GIVE_WAY = 20.0
"""After waiting this long (s) for a level robot it looks whether it stands between two."""

WORTH = 1.0
"""Less than this (m) does not open the view."""

PEEK = 7.0
"""As long as it does not see the way free, it turns there for so long (s) now and then."""


def give_way(brain: Brain, command: Command, blocker: Other | None, since: float) -> bool:
    """Begin or go on with leaving the line; false if there is nothing to do."""
    memory, pose = brain.memory, brain.pose
    if memory.giving_way is None:
        waited = brain.time - since
        level = blocker is not None and blocker.side is Side.LEVEL
        away, certain = _away(brain) if level and waited > GIVE_WAY else (0.0, False)
        if away == 0.0:
            return False
        if not certain or abs(reachable(brain, pose.y + away) - pose.y) < WORTH:
            gaze = look.UP if away > 0.0 else look.DOWN
            peeks = waited % (2.0 * GIVE_WAY) > 2.0 * GIVE_WAY - PEEK
            return peeks and (turning(brain, command, gaze) or looks_at(pose, gaze))
        memory.giving_way = pose.y + away
    if up_or_down(brain, command, reachable(brain, memory.giving_way)):
        return True
    memory.giving_way = pose.y
    return False


def _away(brain: Brain) -> tuple[float, bool]:
    """How far up or down to go, and whether the whole line is known to be on the other side.

    0 if it does not stand between two, or they are not on one side.
    """
    pose = brain.pose
    line = [other for other in others(brain) if abs(other.y - pose.y) < HALF]
    beside = {other.x > pose.x for other in line}
    lower = {is_lower(pose.x, other.side, other.x) for other in line}
    if len(beside) < 2 or lower >= {True, False} or lower == {None}:
        return 0.0, False
    return APART if True in lower else -APART, None not in lower
