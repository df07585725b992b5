"""Looking: which way to turn the field of view of 180 degrees, and when to step aside to see."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from controllers.motion import wrap

from ..compute import Side
from ..constants import APART, EPSILON, HALF, LEVEL, WALL_ROOM
from ..geometry import Pose, Region
from ..sight.shadows import Shadows
from ..sight.tracks import Track
from .view import best_step

DWELL = 0.4
"""A look in one direction lasts this long (s): CONFIRMED scans and one more."""

PLAIN_LOOKS = 3
"""After so many looks straight up and down, each is off by up to half the rays' spacing: what one
ray just misses, another will hit."""

LOOKING = 4.0
"""How long (s) a robot that has painted looks to one side."""

LEFT, RIGHT, UP, DOWN = math.pi, 0.0, math.pi / 2, -math.pi / 2

BY_WALL = 0.94
"""A robot this near to a side wall looks away from it and sees all (m).

No body fits behind, and what is beside it reaches into view far enough for `Shadows` to tell.
"""

_STRIDE = 0.5  # m between places to step to


def fine_gaze(pose: Pose, track: Track, spacing: float, odd: bool) -> float | None:
    """A heading at which a ray parts what is open about a nearly level robot's height.

    Its upright face is seen; a ray through the middle of where its upper (or, at odd looks,
    lower) corner may be tells on which side of it the corner is. It is within half the rays'
    spacing of looking straight along the row. None if there is no such face.
    """
    if track.x[1] - track.x[0] > LEVEL:
        return None
    x, y = track.centre
    face = x - math.copysign(HALF, x - pose.x)
    corner = y - track.aside + (-HALF if odd else HALF)
    base = RIGHT if x > pose.x else LEFT
    bearing = wrap(math.atan2(corner - pose.y, face - pose.x) - base)
    ray = (bearing + math.pi / 2) / spacing
    return base + (ray - round(ray)) * spacing


def row_places(region: Region, pose: Pose, tracks: list[Track], time: float) -> list[float]:
    """The places (x) on the own row that can be stepped to without passing or nearing anybody.

    Whether somebody unseen is on the way shows when the robot looks along it, before it goes.
    """
    room = region.standing_room(pose.y, WALL_ROOM)
    if room is None:
        room = region.standing_room(pose.y, HALF + 0.05)
    if room is None:
        return [pose.x]
    places = [pose.x]
    for direction in (-1.0, 1.0):
        x = pose.x
        while x > room[0] if direction < 0.0 else x < room[1]:
            x = min(max(x + direction * _STRIDE, room[0]), room[1])
            if any(_in_way(track, x, pose, time) for track in tracks):
                break
            places.append(x)
    return places


def _in_way(track: Track, x: float, pose: Pose, time: float) -> bool:
    """Whether a robot is too near to a place on the row; not if one leaves it on the way there."""
    ox, oy = track.centre
    off = abs(oy - pose.y)
    near = APART + 0.05 + (track.reach if time > track.seen else 0.0)
    if max(abs(ox - x), off) >= near:
        return False
    leaving = abs(ox - x) > abs(ox - pose.x) or off > EPSILON
    return not (leaving and max(abs(ox - pose.x), off) < near)


def step_for_view(
    pose: Pose,
    xs: Sequence[float],
    tracks: list[Track],
    shadows: Shadows,
    undecided: tuple[bool, bool],
    chance: float,
) -> float | None:
    """Which of the places `xs` on the row to step to, to see more; None to stay.

    `undecided` says whether the places above, and those below, have to be seen into: those are
    judged of which fewer are left, because either number of robots gives the rank. `chance`, a
    number in [0, 1), picks a place where no view is clearly better, so that robots that hide each
    other do not for ever.
    """
    if len(xs) == 1:
        return None
    places = shadows.places()
    parts = [places[places[:, 1] > pose.y], places[places[:, 1] < pose.y]]
    sides = [part for part, open_ in zip(parts, undecided, strict=True) if open_ and len(part)]
    robots = np.array([track.centre for track in tracks]).reshape(-1, 2)
    here_best = (-1.0, pose.x)
    for part in sides:
        x, share = best_step(xs, pose.y, pose.x, part, robots)
        here_best = max(here_best, (share / (1 + 0.02 * len(part)), x))
    if abs(here_best[1] - pose.x) > _STRIDE:
        return here_best[1]
    x = sorted(xs)[int(chance * len(xs))]
    return x if abs(x - pose.x) > _STRIDE else None


def nearly_level(tracks: list[Track], time: float) -> Track | None:
    """A robot in view of which it is open whether it is higher or lower."""
    for track in tracks:
        if track.side is Side.UNSURE and track.confirmed and track.seen == time:
            return track
    return None
