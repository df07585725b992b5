"""The observe step: what a reading shows, put into the robot's mind.

It corrects odometry, follows robots, clears the places where unseen ones may be, narrows the rank.
"""

from __future__ import annotations

import math

import numpy as np

from .brain import FAR, Brain, Reading
from .constants import BODY, HALF, TURNING
from .geometry import Floats, Pose
from .lined import hidden_on_line
from .memory import Phase
from .moves.room import NEARBY, Near, can_turn
from .sight.localize import drift, locate
from .sight.scan import CLEAR_OF_WALL, Scan, red_points, see_robots, take_scan, wall_points
from .sight.shadows import Shadows, refuted
from .sight.squares import Square
from .sight.tracks import is_higher

CORRECTION = 0.5
"""Odometry is compared with the walls this often (s)."""

SURE = 8
"""When all robots are in view at once, each seen in this many scans, nobody is in the shadows."""


def observe(brain: Brain, reading: Reading) -> Scan:
    """The observe step: correct odometry, follow robots, clear shadows, narrow the rank."""
    memory = brain.memory
    brain.time = reading.time
    brain.spacing = float(reading.bearings[1] - reading.bearings[0])
    before = brain.pose
    cos, sin = math.cos(memory.turn), math.sin(memory.turn)
    x, y, yaw = (float(v) for v in reading.pose)
    brain.pose = Pose(
        cos * x - sin * y + float(memory.shift[0]),
        sin * x + cos * y + float(memory.shift[1]),
        yaw + memory.turn,
    )
    brain.moving = math.dist(before[:2], brain.pose[:2]) > 0.004
    scan = take_scan(
        brain.pose,
        reading.ranges,
        reading.bearings,
        reading.max_range,
        reading.blobs,
        reading.image_width,
    )
    if memory.region is None:
        _find_region(brain, scan)
        if memory.region is None:
            return scan
    depth = brain.region.depth(scan.points)
    _correct(brain, wall_points(scan, depth))
    _follow(brain, scan, see_robots(scan, depth))
    _find_nearest(brain, scan, depth)
    return scan


def _find_region(brain: Brain, scan: Scan) -> None:
    memory = brain.memory
    memory.wall_points.append(red_points(scan))
    points = np.concatenate(memory.wall_points[-40:])
    fit = locate(points[:: max(1, len(points) // 400)], brain.settings.shape)
    if fit is not None:
        memory.region = fit.region
        memory.wall_points = []
        memory.shadows = Shadows(fit.region, brain.settings.limits.speed, memory.began)
        memory.shadows.spread(brain.time)
        memory.phase = Phase.OBSERVING


def _correct(brain: Brain, points: Floats) -> None:
    """Pull odometry towards the walls by a fifth of what it is off; exact odometry is not."""
    memory = brain.memory
    if brain.time < memory.next_correction:
        return
    memory.next_correction = brain.time + CORRECTION
    shift, turn = drift(points, brain.region, (brain.pose.x, brain.pose.y))
    if max(abs(float(shift[0])), abs(float(shift[1])), abs(turn)) < 1e-6:
        return
    turn *= 0.2
    cos, sin = math.cos(turn), math.sin(turn)
    # The correction turns about the robot, so its place in the own frame stays but for shift.
    back = np.array([brain.pose.x, brain.pose.y]) - memory.shift
    turned = np.array([cos * back[0] - sin * back[1], sin * back[0] + cos * back[1]])
    memory.shift = memory.shift + 0.2 * shift + back - turned
    memory.turn += turn


def _follow(brain: Brain, scan: Scan, seen: list[Square]) -> None:
    memory = brain.memory
    tracks, shadows = memory.tracks, brain.shadows
    lost = tracks.update(seen, brain.time, brain.pose.y)
    for track in lost:
        shadows.admit(*track.centre, track.slack, is_higher(brain.pose.x, track))
    out_of_view = [track for track in tracks.all if track.seen < brain.time]
    if out_of_view:
        places = np.array([track.centre for track in out_of_view])
        radii = np.array([track.slack for track in out_of_view])
        for i in np.flatnonzero(refuted(scan, brain.region, places, radii)):
            track = out_of_view[i]
            tracks.drop(track)
            shadows.admit(*track.centre, track.slack, is_higher(brain.pose.x, track))
    tracks.tell_apart()
    shadows.spread(brain.time)
    shadows.look(scan)
    followed = tracks.sure
    for track, square in tracks.sightings:
        if square.certain and track.confirmed:
            shadows.exclude(*square.centre, BODY - square.error)
    unseen = brain.unseen
    if unseen <= 0 and all(t.seen == brain.time and t.looks >= SURE for t in followed):
        shadows.clear()
    _narrow(brain, unseen)


def _find_nearest(brain: Brain, scan: Scan, depth: Floats) -> None:
    """The ranges of the nearest points on robots, as `may_turn` takes them."""
    rays = np.flatnonzero((depth > CLEAR_OF_WALL) & (scan.ranges < NEARBY))
    if rays.size == 0:
        brain.nearest = FAR
        return
    ranges = scan.ranges[rays]
    adds = np.zeros(len(rays))
    near = [t.centre for t in brain.memory.tracks.all if t.seen == brain.time]
    if near:
        away = np.hypot(*(scan.points[rays, None, :] - np.array(near)[None]).transpose(2, 0, 1))
        stands = np.array([not can_turn(brain.region, x, y) for x, y in near])
        adds = np.where(stands[away.argmin(axis=1)], TURNING - HALF, 0.0)
    brain.nearest = Near(float(ranges.min()), float((ranges + adds).min()))


def _narrow(brain: Brain, unseen: int) -> None:
    """Narrow the bounds on the rank by what is followed and what is in shadow."""
    memory = brain.memory
    above = below = unsure = 0
    for track in memory.tracks.sure:
        higher = is_higher(brain.pose.x, track)
        above += higher is True
        below += higher is False
        unsure += higher is None
    sides = [is_higher(brain.pose.x, track) for track in memory.tracks.doubtful]
    maybe_above, maybe_below = len(sides) - sides.count(False), len(sides) - sides.count(True)
    memory.most = max(memory.most[0], above), max(memory.most[1], below)
    y = brain.pose.y
    room_above = brain.shadows.room_above(y) + maybe_above if unseen > 0 else 0
    room_below = brain.shadows.room_below(y) + maybe_below if unseen > 0 else 0
    hidden = hidden_on_line(brain) if unseen > 0 else None
    if hidden is not None:
        room_above, room_below = (unseen, 0) if hidden else (0, unseen)
    doubt = memory.bounds.narrow(above, below, unsure, room_above, room_below)
    if doubt is None:
        memory.doubt_since = None
    elif memory.doubt_since is None:
        memory.doubt_since = brain.time
    memory.doubt = doubt or memory.doubt
