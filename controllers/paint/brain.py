"""A painting robot's mind: from reading to command, without sockets or clocks of its own.

Each reading is perceived (observe); at the beginning of each cycle it is decided what to do
(compute); between cycles that is carried out, and held up where somebody comes too near (move).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from . import act
from .compute import Task
from .constants import ARENA, BODY, HALF, SPRAYER, TURNING
from .geometry import Floats, Pose, Region, rectangle
from .hidden import Shadows, refuted
from .lined import hidden_on_line
from .localize import drift, locate
from .memory import Memory, Phase
from .move import LIMITS, NEARBY, REST, Limits, Motion, Near, can_turn
from .observe import CLEAR_OF_WALL, Patch, Scan, red_points, see_robots, take_scan, wall_points
from .ranking import RankBounds
from .squares import Square
from .tracks import Tracks, is_higher

CORRECTION = 0.5
"""Odometry is compared with the walls this often (s)."""


FAR = Near(math.inf, math.inf)

SURE = 8
"""When all robots are in view at once, each seen in this many scans, nobody is in the shadows."""


PATIENCE = 1700.0
"""For so long (s) a robot tries to come to paint before it says that it cannot."""


@dataclass(frozen=True)
class Settings:
    """What a robot is told: how many there are, the region's shape, and its own limits."""

    robots: int
    paint: bool = True
    shape: Region = field(default_factory=lambda: rectangle(*ARENA))
    jitter: float = 0.0  # s: the longest cycle; 0: every reading begins one
    limits: Limits = LIMITS
    sprayer: tuple[float, float] = SPRAYER
    patience: float = PATIENCE  # s until it gives up if it is not painting yet


@dataclass(frozen=True)
class Reading:
    """What the devices say: odometry, the laser's ranges and bearings (n,), and blobs."""

    time: float
    pose: Pose
    ranges: Floats
    bearings: Floats
    max_range: float
    blobs: Iterable[Patch]
    image_width: int


@dataclass
class Command:
    """What to do until the next reading, and what to tell."""

    motion: Motion = REST
    spray: bool = False
    say: str | None = None
    report: dict[str, Any] = field(default_factory=dict)
    finished: bool = False
    failure: str | None = None


class Brain:
    """One robot's mind. `draw` gives random numbers in [0, 1) for the cycles' lengths."""

    def __init__(self, settings: Settings, draw: Any) -> None:
        self.settings = settings
        self.draw = draw
        self.memory = Memory(Tracks(settings.limits.speed), RankBounds.unknown(settings.robots))
        self.pose = Pose(0.0, 0.0, 0.0)
        self.time = 0.0
        self.moving = False
        self.nearest = FAR
        self.spacing = math.radians(1.0)  # rad between the laser's rays

    @property
    def region(self) -> Region:
        """The region in the own frame, once it is found."""
        assert self.memory.region is not None
        return self.memory.region

    @property
    def shadows(self) -> Shadows:
        """Where unseen robots could be, once the region is found."""
        assert self.memory.shadows is not None
        return self.memory.shadows

    @property
    def task(self) -> Task:
        """Strip and goal, once the rank is known."""
        assert self.memory.task is not None
        return self.memory.task

    @property
    def unseen(self) -> int:
        """How many robots there must be besides those that are followed."""
        return self.settings.robots - 1 - len(self.memory.tracks.sure)

    def step(self, reading: Reading) -> Command:
        """Take in one reading and say what to do."""
        command = Command()
        memory = self.memory
        if math.isinf(memory.began):
            memory.began = reading.time
        self.time = reading.time
        self.spacing = float(reading.bearings[1] - reading.bearings[0])
        scan = self._perceive(reading)
        if memory.region is None:
            act.search_walls(self, scan, command)
            return command
        if memory.phase is not Phase.DONE:
            act.carry_on(self, command)
        return command

    def _perceive(self, reading: Reading) -> Scan:
        """The observe step: correct odometry, follow robots, clear shadows, narrow the rank."""
        memory = self.memory
        before = self.pose
        cos, sin = math.cos(memory.turn), math.sin(memory.turn)
        x, y, yaw = (float(v) for v in reading.pose)
        self.pose = Pose(
            cos * x - sin * y + float(memory.shift[0]),
            sin * x + cos * y + float(memory.shift[1]),
            yaw + memory.turn,
        )
        self.moving = math.dist(before[:2], self.pose[:2]) > 0.004
        scan = take_scan(
            self.pose,
            reading.ranges,
            reading.bearings,
            reading.max_range,
            reading.blobs,
            reading.image_width,
        )
        if memory.region is None:
            self._find_region(scan)
            if memory.region is None:
                return scan
        depth = self.region.depth(scan.points)
        self._correct(wall_points(scan, depth))
        self._follow(scan, see_robots(scan, depth))
        self._find_nearest(scan, depth)
        return scan

    def _find_region(self, scan: Scan) -> None:
        memory = self.memory
        memory.wall_points.append(red_points(scan))
        points = np.concatenate(memory.wall_points[-40:])
        fit = locate(points[:: max(1, len(points) // 400)], self.settings.shape)
        if fit is not None:
            memory.region = fit.region
            memory.wall_points = []
            memory.shadows = Shadows(fit.region, self.settings.limits.speed, memory.began)
            memory.shadows.spread(self.time)
            memory.phase = Phase.OBSERVING

    def _correct(self, points: Floats) -> None:
        """Pull odometry towards the walls by a fifth of what it is off; exact odometry is not."""
        memory = self.memory
        if self.time < memory.next_correction:
            return
        memory.next_correction = self.time + CORRECTION
        shift, turn = drift(points, self.region, (self.pose.x, self.pose.y))
        if max(abs(float(shift[0])), abs(float(shift[1])), abs(turn)) < 1e-6:
            return
        turn *= 0.2
        cos, sin = math.cos(turn), math.sin(turn)
        # The correction turns about the robot, so its place in the own frame stays but for shift.
        back = np.array([self.pose.x, self.pose.y]) - memory.shift
        turned = np.array([cos * back[0] - sin * back[1], sin * back[0] + cos * back[1]])
        memory.shift = memory.shift + 0.2 * shift + back - turned
        memory.turn += turn

    def _follow(self, scan: Scan, seen: list[Square]) -> None:
        memory = self.memory
        tracks, shadows = memory.tracks, self.shadows
        lost = tracks.update(seen, self.time, self.pose.y)
        for track in lost:
            shadows.admit(*track.centre, track.slack, is_higher(self.pose.x, track))
        out_of_view = [track for track in tracks.all if track.seen < self.time]
        if out_of_view:
            places = np.array([track.centre for track in out_of_view])
            radii = np.array([track.slack for track in out_of_view])
            for i in np.flatnonzero(refuted(scan, self.region, places, radii)):
                track = out_of_view[i]
                tracks.drop(track)
                shadows.admit(*track.centre, track.slack, is_higher(self.pose.x, track))
        tracks.tell_apart()
        shadows.spread(self.time)
        shadows.look(scan)
        followed = tracks.sure
        for track, square in tracks.sightings:
            if square.certain and track.confirmed:
                shadows.exclude(*square.centre, BODY - square.error)
        unseen = self.unseen
        if unseen <= 0 and all(t.seen == self.time and t.looks >= SURE for t in followed):
            shadows.clear()
        self._narrow(unseen)

    def _find_nearest(self, scan: Scan, depth: Floats) -> None:
        """The ranges of the nearest points on robots, as `may_turn` takes them."""
        rays = np.flatnonzero((depth > CLEAR_OF_WALL) & (scan.ranges < NEARBY))
        if rays.size == 0:
            self.nearest = FAR
            return
        ranges = scan.ranges[rays]
        adds = np.zeros(len(rays))
        near = [t.centre for t in self.memory.tracks.all if t.seen == self.time]
        if near:
            away = np.hypot(*(scan.points[rays, None, :] - np.array(near)[None]).transpose(2, 0, 1))
            stands = np.array([not can_turn(self.region, x, y) for x, y in near])
            adds = np.where(stands[away.argmin(axis=1)], TURNING - HALF, 0.0)
        self.nearest = Near(float(ranges.min()), float((ranges + adds).min()))

    def _narrow(self, unseen: int) -> None:
        """Narrow the bounds on the rank by what is followed and what is in shadow."""
        memory = self.memory
        above = below = unsure = 0
        for track in memory.tracks.sure:
            higher = is_higher(self.pose.x, track)
            above += higher is True
            below += higher is False
            unsure += higher is None
        sides = [is_higher(self.pose.x, track) for track in memory.tracks.doubtful]
        maybe_above, maybe_below = len(sides) - sides.count(False), len(sides) - sides.count(True)
        memory.most = max(memory.most[0], above), max(memory.most[1], below)
        y = self.pose.y
        room_above = self.shadows.room_above(y) + maybe_above if unseen > 0 else 0
        room_below = self.shadows.room_below(y) + maybe_below if unseen > 0 else 0
        hidden = hidden_on_line(self) if unseen > 0 else None
        if hidden is not None:
            room_above, room_below = (unseen, 0) if hidden else (0, unseen)
        doubt = memory.bounds.narrow(above, below, unsure, room_above, room_below)
        if doubt is None:
            memory.doubt_since = None
        elif memory.doubt_since is None:
            memory.doubt_since = self.time
        memory.doubt = doubt or memory.doubt
