"""Robots followed from scan to scan: who is the same, where each may be now, and on which side.

A robot that is out of view may be anywhere that it could have driven to since. Two sightings are
counted as two robots only if no pairing of sightings with robots seen before makes them one, so
the count never exceeds the truth. Bounds of a robot that stands still are narrowed with every
look: as the laser turns, its rays pass the body's corners at other places.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ..compute import Side, is_lower
from ..constants import BODY, LEVEL
from .pairing import paired, swapped
from .squares import EXACT, Square

CONFIRMED = 3
"""A robot counts once it has been seen in this many scans."""

FORGET = 4.0
"""A robot that may have driven this far (m) since it was seen is followed no longer."""

SAME = 0.3
"""Whoever could have driven farther than this (m) while out of view may be another robot now: its
side has to be seen anew."""

_SHARP = EXACT
"""Bounds are narrowed only by sightings whose points are on their faces this exactly (m): a
body that is turned by a fraction of a degree would falsify them."""

_BLUNT = 0.1
"""Inexact bounds must be this far off the own height (m) to say which side the robot is on."""

LAG = 0.3
"""Narrowed bounds may be off by up to this (m) when the robot has begun to move: a face seen at a
slant bounds its place along the face only loosely, and a look that fits the bounds narrows them."""

LEFT_ROW = 0.01
"""A level robot that is no farther off the row than this (m) has not left it: who steps aside along
its row strays from it by a millimetre or two."""

STRAYED = 0.1
"""A robot that is seen farther off than this (m) has moved."""

STANDING = 3.0
"""A robot that has not moved for this long (s) stands."""

_GATE = 0.15  # m: how far a sighting may be off what the bounds and the speed allow

_TWO = BODY - _GATE
"""Two tracks whose robots may be nearer to each other (m) may be of one and the same."""


_UNSEEN = 0.5
"""For no more than this (m) is the way that a robot may have driven unseen a reason to doubt."""


@dataclass
class Track:
    """One robot: bounds of its centre when last seen (own frame, m), and its side for good."""

    x: tuple[float, float]
    y: tuple[float, float]
    seen: float  # time of the last sighting, s
    looks: int = 1
    side: Side = Side.UNSURE
    sharp: bool = False  # whether the bounds are from sightings that were exact
    anchor: tuple[float, float] | None = None  # where it was when it last moved, m
    moved_at: float = -math.inf  # when it was first seen there, s
    moved_across: bool = False  # whether it came there along its row, not up or down
    reach: float = 0.0  # how far it may have driven since it was seen, m
    aside: float = 0.0  # how far its face's middle in view is from its centre, m (see Square)

    @property
    def centre(self) -> tuple[float, float]:
        """The middle of its bounds when last seen."""
        return 0.5 * (self.x[0] + self.x[1]), 0.5 * (self.y[0] + self.y[1])

    @property
    def confirmed(self) -> bool:
        """Whether it has been seen often enough to count."""
        return self.looks >= CONFIRMED

    def crosses(self, time: float) -> bool:
        """Whether it is on its way along its row."""
        return self.moved_across and time - self.moved_at < STANDING

    @property
    def slack(self) -> float:
        """How far its centre may be from `centre` (m)."""
        return 0.5 * math.hypot(self.x[1] - self.x[0], self.y[1] - self.y[0]) + self.reach + LAG

    def distance(self, x: float, y: float) -> float:
        """The least distance that its centre can have from a point (m)."""
        dx = max(self.x[0] - x, x - self.x[1], 0.0)
        dy = max(self.y[0] - y, y - self.y[1], 0.0)
        return max(0.0, math.hypot(dx, dy) - self.reach)


class Tracks:
    """All robots that are being followed. `speed` is the most that a robot drives, m/s.

    `sure` are those seen often enough that are certainly different robots, `doubtful` those that
    may be one of them: `tell_apart` parts them. `sightings` are the last scan's, with their tracks.
    """

    def __init__(self, speed: float) -> None:
        self.all: list[Track] = []
        self.sure: list[Track] = []
        self.doubtful: list[Track] = []
        self.sightings: list[tuple[Track, Square]] = []
        self.speed = speed

    def update(self, squares: Sequence[Square], time: float, y: float) -> list[Track]:
        """Take in a scan's sightings, made at the height y; returns the tracks given up, if any."""
        for track in self.all:
            track.reach = (time - track.seen) * self.speed
        options = [_options(square, self.all, y) for square in squares]
        pairs = paired(options, [square.certain for square in squares])
        self._confuse(options, pairs)
        self.sightings = []
        for j, square in enumerate(squares):
            if j in pairs:
                track = self.all[pairs[j]]
                if track.reach > SAME and track.side is not Side.LEVEL:
                    track.side = Side.UNSURE
                _renew(track, square, time)
                self.sightings.append((track, square))
            else:
                self.all.append(Track(square.x, square.y, time, sharp=_is_sharp(square)))
        for track in self.all:
            if track.seen == time:
                track.side = _side(track, y)
        kept: list[Track] = []
        lost: list[Track] = []
        for track in self.all:
            too_far = track.reach > (FORGET if track.confirmed else 0.5)
            (lost if too_far else kept).append(track)
        self.all = kept
        return [track for track in lost if track.confirmed]

    def _confuse(self, options: Sequence[Sequence[int]], pairs: dict[int, int]) -> None:
        """Who was left unpaired may be the one that was paired in its place: be as vague as that.

        That holds only among those that were out of view: who was just seen is where it was.
        """
        away = {i for i, track in enumerate(self.all) if track.reach > SAME}
        before = [(track.x, track.y, track.side, track.reach) for track in self.all]
        for k in away.difference(pairs.values()):
            track = self.all[k]
            for i in swapped(k, options, pairs) & away:
                x, y, side, reach = before[i]
                track.x = min(track.x[0], x[0]), max(track.x[1], x[1])
                track.y = min(track.y[0], y[0]), max(track.y[1], y[1])
                track.reach = max(track.reach, reach)
                track.seen = min(track.seen, self.all[i].seen)
                track.sharp = False
                if side is not track.side or side is Side.LEVEL:
                    track.side = Side.UNSURE

    def drop(self, track: Track) -> None:
        """Stop following a robot that turned out not to be where it could be."""
        self.all = [other for other in self.all if other is not track]

    def tell_apart(self) -> None:
        """Part the robots that count from those that may be one of them: the exact ones count.

        The number of robots that count is at most the true one.
        """
        self.sure, self.doubtful = [], []
        for track in sorted((t for t in self.all if t.confirmed), key=lambda t: t.slack):
            apart = all(_gap(track, other) >= _TWO for other in self.sure)
            (self.sure if apart else self.doubtful).append(track)


def _options(square: Square, tracks: Sequence[Track], y: float) -> list[int]:
    """Which tracks' robot a sighting made at the height y may be, the nearest first."""
    near = []
    cx, cy = square.centre
    for i, track in enumerate(tracks):
        gap = track.distance(cx, cy) - square.error - _GATE - LAG
        wrong_side = (track.side is Side.ABOVE and square.y[1] < y - _GATE) or (
            track.side is Side.BELOW and square.y[0] > y + _GATE
        )
        if gap <= 0.0 and not wrong_side:
            tx, ty = track.centre
            near.append((math.hypot(tx - cx, ty - cy), i))
    return [i for _, i in sorted(near)]


def _gap(one: Track, other: Track) -> float:
    """The least distance that two robots can have from each other (m).

    Who was out of view for long is told apart by the pairing, so that is not taken into account.
    """
    dx = max(one.x[0] - other.x[1], other.x[0] - one.x[1], 0.0)
    dy = max(one.y[0] - other.y[1], other.y[0] - one.y[1], 0.0)
    return math.hypot(dx, dy) - min(one.reach, _UNSEEN) - min(other.reach, _UNSEEN)


def is_higher(x: float, track: Track) -> bool | None:
    """Whether a robot has a higher rank than one at `x`; None if that is open."""
    lower = is_lower(x, track.side, track.centre[0])
    return None if lower is None else not lower


def _renew(track: Track, square: Square, time: float) -> None:
    """Take a new sighting into a track's bounds."""
    x = max(track.x[0], square.x[0]), min(track.x[1], square.x[1])
    y = max(track.y[0], square.y[0]), min(track.y[1], square.y[1])
    consistent = all(
        low <= high + (_SHARP if old[1] - old[0] < _SHARP else 0.1 * _SHARP)
        for (low, high), old in ((x, track.x), (y, track.y))
    )
    if not (consistent or square.certain):
        return  # a sliver elsewhere may be anybody's
    sharp = _is_sharp(square)
    if consistent and (sharp and track.sharp):
        track.x, track.y = (min(x), max(x)), (min(y), max(y))
    else:
        far = track.reach + (0.0 if consistent else _GATE)  # how far beyond its old bounds it is
        track.x, track.y = _clipped(square.x, track.x, far), _clipped(square.y, track.y, far)
        track.sharp = sharp
    _note_motion(track, square.error, time)
    track.seen, track.reach, track.aside = time, 0.0, square.aside
    if square.certain:
        track.looks += 1


def _note_motion(track: Track, error: float, time: float) -> None:
    """Note when a robot has moved, and which way."""
    if track.anchor is None:
        track.anchor = track.centre
    dx, dy = (new - old for new, old in zip(track.centre, track.anchor, strict=True))
    if math.hypot(dx, dy) > STRAYED + error:
        track.anchor, track.moved_at = track.centre, time
        track.moved_across = abs(dx) > 2.0 * abs(dy)


def _clipped(new: tuple[float, float], old: tuple[float, float], far: float) -> tuple[float, float]:
    """New bounds, less what is farther than `far` from the old ones."""
    low, high = max(new[0], old[0] - far), min(new[1], old[1] + far)
    return (low, high) if low <= high else new


def _is_sharp(square: Square) -> bool:
    return square.straight and square.misfit < _SHARP


def _side(track: Track, y: float) -> Side:
    """The track's side now.

    Once a robot is above or below it stays so, because all keep the order; unless exact bounds
    say otherwise: then this is not the robot that it was taken for.
    """
    fresh = _side_by_bounds(track, y)
    if track.side is Side.LEVEL and (fresh is Side.UNSURE or _still_on_row(track, y)):
        return Side.LEVEL  # nobody leaves the row without that it shows
    if track.side in (Side.ABOVE, Side.BELOW) and (fresh is Side.UNSURE or not track.sharp):
        return track.side
    return fresh


def _still_on_row(track: Track, y: float) -> bool:
    return track.y[0] - y < LEFT_ROW and y - track.y[1] < LEFT_ROW


def _side_by_bounds(track: Track, y: float) -> Side:
    low, high = track.y[0] - y, track.y[1] - y
    sure = LEVEL if track.sharp else _BLUNT
    if low > sure:
        return Side.ABOVE
    if high < -sure:
        return Side.BELOW
    if not track.sharp:
        return Side.UNSURE
    if low >= -LEVEL and high <= LEVEL:
        return Side.LEVEL
    if high - low >= LEVEL:
        return Side.UNSURE
    if abs(low + high) <= 2.0 * LEVEL:
        return Side.LEVEL
    return Side.ABOVE if low + high > 0.0 else Side.BELOW
