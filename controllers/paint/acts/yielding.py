"""Giving way: out of a line of nearly level robots, so that those on its ends see each other.

Who stands between two others at nearly its own height hides them from each other for good. If both
are below (or both above), it can leave the line on the other side without a change of order.

Likewise who waits for long for one that is nearly level may be what keeps that one from knowing its
rank: behind a body half a body higher nobody is hidden that is lower.
"""

from __future__ import annotations

from ..brain import Brain, Command
from ..compute import Other, Side, is_lower
from ..constants import APART, HALF
from ..moves import look
from ..moves.twist import looks_at
from .clearance import beside_limit, may_be_backed_into, others, reachable, unseen_limit
from .turning import NEAR, turning, up_or_down

GIVE_WAY = 20.0
"""After waiting this long (s) for a level robot it looks whether it stands between two."""

OPENS = 100.0
"""After waiting this long (s) for a robot that is nearly level it leaves that one's row."""

CLEARS = HALF + 0.1
"""So far above (below) the other (m) it hides nobody from it that is lower (higher)."""

LATELY = 0.3
"""Who can have gone farther than this (m) since it was seen may be at another height by now."""

WORTH = 1.0
"""Less than this (m) does not open the view."""

PEEK = 7.0
"""As long as it does not see the way free, it turns there for so long (s) now and then."""


def give_way(brain: Brain, command: Command, blocker: Other | None, since: float) -> bool:
    """Begin or go on with leaving the line; false if there is nothing to do."""
    memory, pose = brain.memory, brain.pose
    waited = brain.time - since
    if waited > OPENS and _opens(brain, command, blocker):
        return True
    if memory.giving_way is None:
        level = blocker is not None and blocker.side is Side.LEVEL
        away, certain = _away(brain) if level and waited > GIVE_WAY else (0.0, False)
        if away == 0.0:
            return False
        if not certain or abs(reachable(brain, pose.y + away) - pose.y) < WORTH:
            peeks = waited % (2.0 * GIVE_WAY) > 2.0 * GIVE_WAY - PEEK
            return peeks and _looks(brain, command, away > 0.0)
        memory.giving_way = pose.y + away
    if up_or_down(brain, command, reachable(brain, memory.giving_way)):
        return True
    memory.giving_way = pose.y
    return False


def _looks(brain: Brain, command: Command, upwards: bool) -> bool:
    """Turn to look up or down, and stay so; false if there is no room to turn."""
    gaze = look.UP if upwards else look.DOWN
    return turning(brain, command, gaze) or looks_at(brain.pose, gaze)


def _opens(brain: Brain, command: Command, blocker: Other | None) -> bool:
    """Begin or go on with leaving the row of a robot that is nearly level: it looks, then goes."""
    memory, pose = brain.memory, brain.pose
    if memory.opens_to is None:
        if blocker is None or blocker.side not in (Side.ABOVE, Side.BELOW):
            return False
        sign = 1.0 if blocker.side is Side.BELOW else -1.0
        if blocker.slack > LATELY or sign * (blocker.y - pose.y) + CLEARS < NEAR:
            return False
        if brain.time < memory.opened_at + GIVE_WAY or may_be_backed_into(brain, pose.x):
            return False
        memory.opens_to, memory.opened_at = blocker.y + sign * CLEARS, brain.time
    upwards = memory.opens_to > pose.y
    closest = min if upwards else max
    limits = beside_limit(brain, upwards), unseen_limit(brain, upwards)
    height = closest(memory.opens_to, *limits)
    if (height > pose.y) is upwards and up_or_down(brain, command, height):
        return True
    left = abs(memory.opens_to - pose.y)
    if left > NEAR and brain.time < memory.opened_at + PEEK and _looks(brain, command, upwards):
        return True
    memory.opens_to = None
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
