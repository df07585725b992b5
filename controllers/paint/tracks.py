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

from .compute import Side
from .constants import LEVEL
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

_GATE = 0.15  # m: how far a sighting may be off what the bounds and the speed allow


@dataclass
class Track:
    """One robot: bounds of its centre when last seen (own frame, m), and its side for good."""

    x: tuple[float, float]
    y: tuple[float, float]
    seen: float  # time of the last sighting, s
    since: float  # time since when it has stood there, s
    looks: int = 1
    side: Side = Side.UNSURE
    sharp: bool = False  # whether the bounds are from sightings that were exact
    reach: float = 0.0  # how far it may have driven since it was seen, m

    @property
    def centre(self) -> tuple[float, float]:
        """The middle of its bounds when last seen."""
        return 0.5 * (self.x[0] + self.x[1]), 0.5 * (self.y[0] + self.y[1])

    @property
    def confirmed(self) -> bool:
        """Whether it has been seen often enough to count."""
        return self.looks >= CONFIRMED

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
    """All robots that are being followed. `speed` is the most that a robot drives, m/s."""

    def __init__(self, speed: float) -> None:
        self.all: list[Track] = []
        self.speed = speed

    def update(self, squares: Sequence[Square], time: float, x: float, y: float) -> list[Track]:
        """Take in a scan's sightings, made at (x, y); returns the tracks given up, if any."""
        for track in self.all:
            track.reach = (time - track.seen) * self.speed
        pairs = self._pairing(squares, y)
        for j, square in enumerate(squares):
            if j in pairs:
                track = self.all[pairs[j]]
                if track.reach > SAME and track.side is not Side.LEVEL:
                    track.side = Side.UNSURE
                _renew(track, square, time)
            else:
                self.all.append(Track(square.x, square.y, time, time, sharp=_is_sharp(square)))
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

    def drop(self, track: Track) -> None:
        """Stop following a robot that turned out not to be where it could be."""
        self.all = [other for other in self.all if other is not track]

    def confirmed(self) -> list[Track]:
        """The robots that count."""
        return [track for track in self.all if track.confirmed]

    def _pairing(self, squares: Sequence[Square], y: float) -> dict[int, int]:
        """Sighting to track, so that as many as possible are paired; near pairs first."""
        options: list[list[int]] = []
        for square in squares:
            gaps = []
            cx, cy = square.centre
            for i, track in enumerate(self.all):
                gap = track.distance(cx, cy) - square.error - _GATE - LAG
                wrong_side = (track.side is Side.ABOVE and square.y[1] < y - _GATE) or (
                    track.side is Side.BELOW and square.y[0] > y + _GATE
                )
                if gap <= 0.0 and not wrong_side:
                    tx, ty = track.centre
                    gaps.append((math.hypot(tx - cx, ty - cy), i))
            options.append([i for _, i in sorted(gaps)])
        owner: dict[int, int] = {}

        def place(j: int, tried: set[int]) -> bool:
            for i in options[j]:
                if i not in tried:
                    tried.add(i)
                    if i not in owner or place(owner[i], tried):
                        owner[i] = j
                        return True
            return False

        for j in sorted(range(len(squares)), key=lambda j: len(options[j])):
            place(j, set())
        return {j: i for i, j in owner.items()}


def is_higher(x: float, track: Track) -> bool | None:
    """Whether a robot has a higher rank than one at `x`; None if that is open."""
    if track.side is Side.UNSURE:
        return None
    if track.side is Side.LEVEL:
        return bool(track.centre[0] > x)
    return track.side is Side.ABOVE


def _renew(track: Track, square: Square, time: float) -> None:
    """Take a new sighting into a track's bounds."""
    x = max(track.x[0], square.x[0]), min(track.x[1], square.x[1])
    y = max(track.y[0], square.y[0]), min(track.y[1], square.y[1])
    consistent = all(
        low <= high + (_SHARP if old[1] - old[0] < _SHARP else 0.1 * _SHARP)
        for (low, high), old in ((x, track.x), (y, track.y))
    )
    sharp = _is_sharp(square)
    if consistent and (sharp and track.sharp):
        track.x, track.y = (min(x), max(x)), (min(y), max(y))
    else:
        far = track.reach + (0.0 if consistent else _GATE)  # how far beyond its old bounds it is
        track.x, track.y = _clipped(square.x, track.x, far), _clipped(square.y, track.y, far)
        track.since, track.sharp = time, sharp
    track.seen, track.reach = time, 0.0
    if square.certain:
        track.looks += 1


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
    if track.side is Side.LEVEL and fresh is Side.UNSURE:
        return Side.LEVEL  # nobody leaves the row without that it shows
    if track.side in (Side.ABOVE, Side.BELOW) and (fresh is Side.UNSURE or not track.sharp):
        return track.side
    return fresh


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
