"""What is known to be free: how far up or down nobody is near, seen or unseen, and on the row."""

from __future__ import annotations

import math

from ..brain import Brain
from ..compute import Other, Side, is_lower, vertical_leg
from ..constants import APART, EPSILON, FINAL_TURN, HALF, HALT, INSET
from ..moves.room import TURN_KEEP, can_turn
from ..sight.tracks import is_higher

BESIDE = APART
"""Who is farther off than this along the row (m) is not in the way up or down."""

ORDERLY = 0.3
"""Nearer in height than this (m) nobody comes to who is beside it."""

BACKING = INSET + max(FINAL_TURN) + TURN_KEEP
"""Nearer to a side wall than this (m) somebody may be backing to its goal without looking."""

VAGUE = 0.15
"""Bounds this wide either way (m) are taken at their middle: nearer by, they get narrower."""


def others(brain: Brain) -> list[Other]:
    """The robots followed, as the compute step takes them.

    Where all that are above are told apart already, who is nearly level is below, and the other
    way round.
    """
    x, bounds = brain.pose.x, brain.memory.bounds
    counted = {True: 0, False: 0}
    for track in brain.memory.tracks.sure:
        higher = is_higher(x, track)
        if higher is not None:
            counted[higher] += 1
    unsure = Side.UNSURE
    if bounds.above[0] == bounds.above[1] == counted[True]:
        unsure = Side.BELOW
    elif bounds.below[0] == bounds.below[1] == counted[False]:
        unsure = Side.ABOVE
    found = []
    for track in brain.memory.tracks.all:
        ox, oy = track.centre
        roomy = can_turn(brain.region, ox, oy) and abs(ox - x) < TURN_KEEP + track.reach + 0.1
        keep = TURN_KEEP if roomy else EPSILON
        slack = track.reach + max(0.0, 0.5 * (track.y[1] - track.y[0]) - VAGUE)
        side = unsure if track.side is Side.UNSURE else track.side
        found.append(Other(ox, oy, side, keep, HALT, slack))
    return found


def unseen_limit(brain: Brain, upwards: bool) -> float:
    """The height up (down) to which no unseen robot can be nearer than EPSILON; infinite if none.

    If all robots above (below) are followed, who is unseen is on the other side.
    """
    bounds = brain.memory.bounds
    tracks = brain.memory.tracks.sure
    count = sum(is_higher(brain.pose.x, track) == upwards for track in tracks)
    total = bounds.above[1] if upwards else bounds.below[1]
    if count >= total:
        return math.inf if upwards else -math.inf
    nearest = brain.shadows.nearest_height(brain.pose.y, upwards)
    return nearest - EPSILON if upwards else nearest + EPSILON


def beside_limit(brain: Brain, upwards: bool) -> float:
    """The height up (down) to which nobody followed is passed or neared; infinite if none is there.

    Who is level, and by x is above (below), is not left behind: neither is whose side is open.
    Farther than `vertical_leg` goes: it comes near the heights of those that stand well beside it,
    so it is not for where somebody may back towards it (`may_be_backed_into`).
    """
    pose, sign = brain.pose, 1.0 if upwards else -1.0
    limit = math.inf
    for other in others(brain):
        if is_lower(pose.x, other.side, other.x) is not upwards:
            beside = abs(other.x - pose.x) > BESIDE + other.slack
            keep = (ORDERLY if beside else EPSILON) + other.slack
            limit = min(limit, sign * other.y - keep)
    return sign * limit


def may_be_backed_into(brain: Brain, x: float) -> bool:
    """Whether a place on its row is so near to a side wall that EPSILON has to be kept there."""
    y = brain.pose.y
    rooms = [brain.region.standing_room(y + off, 0.0) for off in (-EPSILON, 0.0, EPSILON)]
    return any(
        room is not None and not BACKING < x - room[0] < room[1] - room[0] - BACKING
        for room in rooms
    )


def reachable(brain: Brain, height: float) -> float:
    """How far up or down towards a height the way is free, by all that is known."""
    pose = brain.pose
    upwards = height > pose.y
    leg = vertical_leg(pose.x, pose.y, height, others(brain))
    limit = unseen_limit(brain, upwards)
    return max(pose.y, min(limit, leg.height)) if upwards else min(pose.y, max(limit, leg.height))


def hidden_on_row(brain: Brain, left: float) -> bool:
    """Whether an unseen robot could be in the way from here to the left as far as `left`."""
    return hidden_between(brain, left, brain.pose.x)


def hidden_between(brain: Brain, left: float, right: float) -> bool:
    """Whether an unseen robot could be on the own row between two places."""
    y = brain.pose.y
    return brain.unseen > 0 and brain.shadows.any_in(left, right, y - 2 * HALF, y + 2 * HALF)
