"""Where there is room: to turn, and to go without coming too near to anybody.

Bodies here may turn on the spot where they stand, so a robot that moves keeps far enough from
whoever has room to turn (TURN_KEEP, in both axes); one that stands by a wall it may pass at
STAND_KEEP. Who turns can then do so wherever it stands, as long as nobody known is near.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

from ..constants import EPSILON, HALF, TURNING, WALL_ROOM
from ..geometry import Pose, Region
from ..sight.tracks import Track

TURN_KEEP = 1.25
"""Half the width of the square around a body with room to turn that others stay out of (m)."""

STAND_KEEP = 1.07
"""The same for a body that cannot turn, between walls or painting."""

NEAR_FACE = TURNING + 0.03
"""No point of another body is nearer than this when a robot turns (m)."""

NEAR_TURNER = 2.0 * TURNING - HALF + 0.03
"""... or than this, if the other body may turn at the same time: its corners then come nearer."""

NEARBY = 1.5
"""Who is farther than this (m) keeps nobody from turning."""

BEGUN = TURNING + 0.01
"""... or than this, if it has begun to turn."""

BOTH_TURN_RADIUS = 2.0 * TURNING + 0.03
"""No centre of another body that has room to turn as well is nearer than this (m)."""

WALL_GAP = 0.03
"""Nobody drives nearer to a wall than this (m)."""


class Near(NamedTuple):
    """The range of the nearest laser point on a robot (m), and of the nearest on one with room to
    turn; a point on a robot without counts there as if it were farther, by what turning adds."""

    face: float
    turner: float


def can_turn(region: Region, x: float, y: float) -> bool:
    """Whether a body at (x, y) has room to turn between the walls."""
    return region.depth_at(x, y) > TURNING + 0.005


def may_turn(
    region: Region, pose: Pose, tracks: Iterable[Track], time: float, nearest: Near
) -> bool:
    """Whether this robot may turn here and now: walls and robots are far enough.

    Of robots in view the laser tells, `nearest`; the others are where they were last seen, as long
    as they are followed. A turn that was begun is finished as long as it hits nobody that stands.
    """
    begun = abs(math.remainder(pose.yaw, math.pi / 2)) > math.radians(2.0)
    if region.depth_at(pose.x, pose.y) < (TURNING if begun else WALL_ROOM - 0.005):
        return False
    if nearest.face < BEGUN if begun else nearest.turner < NEAR_TURNER:
        return False
    for track in tracks:
        if track.seen == time:
            continue  # the laser tells better
        away, face = _distances(track, pose.x, pose.y)
        both = can_turn(region, *track.centre) and not begun
        if away < BOTH_TURN_RADIUS if both else face < (BEGUN if begun else NEAR_FACE):
            return False
    return True


def room_to_turn(region: Region, x: float, y: float, track: Track) -> bool:
    """Whether a robot is far enough from a place to turn there, as `may_turn` takes it."""
    away, face = _distances(track, x, y)
    if can_turn(region, *track.centre):
        return away > BOTH_TURN_RADIUS and face > NEAR_TURNER
    return face > NEAR_FACE


def _distances(track: Track, x: float, y: float) -> tuple[float, float]:
    """How far from a place the centre of a robot is, and its body if it stands straight (m)."""
    dx, dy = abs(track.centre[0] - x), abs(track.centre[1] - y)
    return math.hypot(dx, dy), math.hypot(max(0.0, dx - HALF), max(0.0, dy - HALF))


def keep_of(region: Region, track: Track) -> float:
    """Half the width of the square around a robot that this one stays out of."""
    if not can_turn(region, *track.centre):
        return STAND_KEEP
    return TURN_KEEP


def to_walls(region: Region, pose: Pose, target: tuple[float, float]) -> float:
    """How far one may go towards a target before the body, as it is turned, is near a wall (m)."""
    dx, dy = target[0] - pose.x, target[1] - pose.y
    length = math.hypot(dx, dy)
    half = HALF * (abs(math.cos(pose.yaw)) + abs(math.sin(pose.yaw))) + WALL_GAP
    travel = length
    for (a, b), offset in zip(region.normals.tolist(), region.offsets.tolist(), strict=True):
        closing = -(a * dx + b * dy) / length if length else 0.0
        if closing > 1e-9:
            spread = half * (abs(a) + abs(b)) if half < HALF + 0.1 else half
            room = a * pose.x + b * pose.y - offset - spread
            travel = min(travel, max(0.0, room) / closing)
    return travel


def free_travel(
    region: Region,
    start: Pose,
    target: tuple[float, float],
    tracks: Iterable[Track],
    time: float,
    keep: float | None = None,
    recent: float = 3.0,
) -> float:
    """How far one may go on the straight way from start to target before coming too near (m).

    `keep` is half the width of the square around each robot that is not entered; it depends on
    whether that robot can turn unless given. A robot that is too near already does not hold up
    who moves away from it. Only robots seen within `recent` (s) count.
    """
    dx, dy = target[0] - start.x, target[1] - start.y
    length = math.hypot(dx, dy)
    if length == 0.0:
        return 0.0
    ux, uy = dx / length, dy / length
    travel = to_walls(region, start, target)
    for track in tracks:
        if time - track.seen > recent:
            continue
        x, y = track.centre[0] - start.x, track.centre[1] - start.y
        near = keep_of(region, track) if keep is None else keep
        if not track.confirmed:  # a sliver of a body: where it is seen is its face
            near -= HALF
        if abs(x) < near and abs(y) < near:
            along = ux * x if abs(x) > abs(y) else uy * y
            if along > 0.01:
                travel = 0.0
            continue
        enter, leave = 0.0, length
        for offset, direction in ((x, ux), (y, uy)):
            if abs(direction) < 1e-12:
                if abs(offset) >= near:
                    enter = math.inf
                continue
            a, b = (offset - near) / direction, (offset + near) / direction
            enter, leave = max(enter, min(a, b)), min(leave, max(a, b))
        if enter <= leave:
            travel = min(travel, enter)
    return travel


def passing_height(
    region: Region, goal_y: float, x: float, goal_x: float, tracks: Iterable[Track],
    strip: tuple[float, float],
) -> float:  # fmt: skip
    """The height at which to cross: the goal's, or a little off where someone could turn beside.

    A robot between EPSILON and TURN_KEEP off the row that has room to turn is given more berth,
    as far as the own strip allows.
    """
    height = goal_y
    towards = 1.0 if goal_x > x else -1.0
    for track in tracks:
        ox, oy = track.centre
        off = oy - goal_y
        near = EPSILON - 0.1 < abs(off) < TURN_KEEP + 0.02 and towards * (ox - x) > -TURN_KEEP - 0.3
        if near and abs(ox - goal_x) > TURN_KEEP and can_turn(region, ox, oy):
            wanted = oy + math.copysign(TURN_KEEP + 0.03, -off)
            if strip[0] + HALF < wanted < strip[1] - HALF and abs(wanted - goal_y) > abs(
                height - goal_y
            ):
                height = wanted
    return height
