"""Giving way: out of a line of nearly level robots, so that those on its ends see each other.

Who stands between two others at nearly its own height hides them from each other for good. If both
are below (or both above), it can leave the line on the other side without a change of order.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .clearance import reachable
from .compute import Other, Side
from .constants import APART, HALF
from .tracks import is_higher
from .turning import up_or_down

if TYPE_CHECKING:
    from .brain import Brain, Command

GIVE_WAY = 20.0
"""After waiting this long (s) for a level robot it looks whether it stands between two."""

WORTH = 1.0
"""Less than this (m) does not open the view."""


def give_way(brain: Brain, command: Command, blocker: Other | None, since: float) -> bool:
    """Begin or go on with leaving the line; false if there is nothing to do."""
    memory, pose = brain.memory, brain.pose
    if memory.giving_way is None:
        level = blocker is not None and blocker.side is Side.LEVEL
        if not level or brain.time - since < GIVE_WAY:
            return False
        memory.giving_way = _height(brain)
    if memory.giving_way is None:
        return False
    if up_or_down(brain, command, memory.giving_way):
        return True
    memory.giving_way = pose.y
    return False


def _height(brain: Brain) -> float | None:
    """The height to go to; None if it does not stand between two, or they are not on one side."""
    pose = brain.pose
    line = [t for t in brain.memory.tracks.sure if abs(t.centre[1] - pose.y) < HALF]
    beside = {track.centre[0] > pose.x for track in line}
    sides = {is_higher(pose.x, track) for track in line}
    if len(beside) < 2 or len(sides) > 1 or None in sides:
        return None
    away = -APART if True in sides else APART
    height = reachable(brain, pose.y + away)
    return height if abs(height - pose.y) > WORTH and math.isfinite(height) else None
