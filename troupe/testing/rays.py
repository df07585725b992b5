"""What sensors should read, by another method: every ray against every edge, in plain numpy.

    things = things_at(evidence, tick=-1)
    answer = scan(things, (x, y, heading), robot, bearings, max_range)
    check_scan(answer, ranges, hits, max_range)

Nothing of the sensors is used: shapes are placed by complex multiplication, rays are intersected
in the world's frame by Cramer's rule, circles by the quadratic formula. All is as high as need be:
who looks over low things leaves them out. Metres and radians.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from troupe.testing.evidence import Evidence
    from troupe.testing.outlines import Outline

Floats = npt.NDArray[np.float64]

CORNER = 1e-9
"""Radians: a ray this near to a corner (or to a circle's tangent) may take either answer."""
ON = 1e-9
"""Metres: a sensor this near to an edge stands on it and reads 0."""


@dataclass
class Things:
    """What can be seen: edges as complex a and b, circles as centre and radius, and their owners.

    An owner is a number of one's own for one thing; a sensor does not see what its own robot is.
    """

    a: list[complex] = field(default_factory=list)
    b: list[complex] = field(default_factory=list)
    edge_owner: list[int] = field(default_factory=list)
    centre: list[complex] = field(default_factory=list)
    radius: list[float] = field(default_factory=list)
    circle_owner: list[int] = field(default_factory=list)
    solid: list[tuple[int, npt.NDArray[np.complex128], bool]] = field(default_factory=list)
    """Owner, corners, and whether all but what lies within them is solid."""

    def polygon(self, owner: int, pose: Floats, vertices: Floats) -> None:
        """A solid body: convex corners (k, 2) in its frame, counter-clockwise, at x, y, yaw."""
        corners = placed(pose, vertices)
        self.solid.append((owner, corners, False))
        self.a += list(corners)
        self.b += list(np.roll(corners, -1))
        self.edge_owner += [owner] * len(corners)

    def segments(self, owner: int, pose: Floats, segments: Floats) -> None:
        """Thin walls (k, 4): x, y of one end and of the other."""
        self.a += list(placed(pose, segments[:, :2]))
        self.b += list(placed(pose, segments[:, 2:]))
        self.edge_owner += [owner] * len(segments)

    def inside(self, owner: int, pose: Floats, vertices: Floats, hollow: bool) -> None:
        """What lies within walls (or, if hollow, without), whose faces are segments."""
        self.solid.append((owner, placed(pose, vertices), hollow))

    def within(self, here: complex, own: int) -> int:
        """The owner of something solid in which a point lies, or on whose edge; -1 for none.

        A point lies in a polygon if the corners, seen from it, go all the way round.
        """
        for owner, corners, hollow in self.solid:
            toward = corners - here
            edge = np.roll(corners, -1) - corners
            part = np.clip(-_dot(toward, edge) / np.abs(edge) ** 2, 0.0, 1.0)
            if owner != own and (np.abs(toward + part * edge) <= ON).any():
                return owner
            if owner != own:
                turns = np.angle(np.roll(toward, -1) / toward).sum() / (2 * np.pi)
                if (abs(turns) > 0.5) != hollow:
                    return owner
        for owner, centre, radius in zip(self.circle_owner, self.centre, self.radius, strict=True):
            if owner != own and abs(centre - here) <= radius + ON:
                return owner
        return -1

    def circle(self, owner: int, pose: Floats, radius: float) -> None:
        """A solid disc."""
        self.centre.append(complex(pose[0], pose[1]))
        self.radius.append(radius)
        self.circle_owner.append(owner)


def things_at(evidence: Evidence, tick: int = -1) -> Things:
    """All that can be seen at the end of a tick (an index of `evidence.times`).

    Owners are the robots' indices; after them the obstacles that can be pushed, then what stands,
    one by one, and last the boundary.
    """
    things, around = Things(), evidence.around
    bodies = list(zip(evidence.outlines, evidence.poses[tick], strict=True))
    if around.movables:
        outlines = [outline for _, outline in around.movables]
        bodies += zip(outlines, evidence.movable_poses[tick], strict=True)
    bodies += [(thing.outline, thing.pose) for thing in around.standing]
    for owner, (outline, pose) in enumerate(bodies):
        if not np.isnan(pose[0]):
            _add(things, owner, outline, pose)
    if around.arena is not None:
        ring, nowhere = around.arena, np.zeros(3)
        things.segments(len(bodies), nowhere, np.hstack([ring, np.roll(ring, -1, axis=0)]))
        things.inside(len(bodies), nowhere, ring, True)
    return things


def _add(things: Things, owner: int, outline: Outline, pose: Floats) -> None:
    if isinstance(outline, float):
        things.circle(owner, pose, outline)
    else:
        things.polygon(owner, pose, outline)


def placed(pose: Floats, points: Floats) -> npt.NDArray[np.complex128]:
    """Points (k, 2) of a body's frame in the world, as complex numbers."""
    turned = np.exp(1j * pose[2]) * (points[:, 0] + 1j * points[:, 1])
    return np.asarray(turned + complex(pose[0], pose[1]))


@dataclass
class Answer:
    """Per ray the nearest hit if edges are a little too long (`low`) and too short (`high`).

    Away from corners both are the same, and `owner` is what was hit. `sensitivity` is how many
    metres the range changes per metre by which the edge that was hit is moved: 1 / sin of the
    angle between ray and edge. `lead` is how much nearer that is than any other thing.
    """

    low: Floats
    high: Floats
    owner: npt.NDArray[np.int64]
    sensitivity: Floats
    lead: Floats


def scan(things: Things, origin: Floats, own: int, bearings: Floats, max_range: float) -> Answer:
    """One sensor's scan: `origin` is x, y, heading in the things."""
    here = complex(origin[0], origin[1])
    ray = np.exp(1j * (origin[2] + bearings))
    solid = things.within(here, own)
    if solid >= 0:
        return _zero(solid, len(bearings))
    low_t, high_t, sensitive, owners = [], [], [], []
    a, b = np.array(things.a), np.array(things.b)
    mine = np.array(things.edge_owner, int) != own
    if mine.any():
        owner = np.array(things.edge_owner, int)[mine]
        start, edge = (a - here)[mine], (b - a)[mine]
        nearest = np.clip(-_dot(start, edge) / np.abs(edge) ** 2, 0.0, 1.0)
        touching = np.abs(start + nearest * edge) <= ON
        if touching.any():
            return _zero(int(owner[touching.argmax()]), len(bearings))
        with np.errstate(divide="ignore", invalid="ignore"):
            across = _cross(ray[None], edge[:, None])
            t = _cross(start, edge)[:, None] / across
            part = _cross(start[:, None], ray[None]) / across
        to_a, to_b = start[:, None] / ray[None], (start + edge)[:, None] / ray[None]
        at_corner = (np.abs(np.angle(to_a)) <= CORNER) | (np.abs(np.angle(to_b)) <= CORNER)
        hit = (across != 0) & (t >= 0) & (part >= 0) & (part <= 1)
        # Where a corner is hit, the hit lies at the corner, however the line goes on behind it.
        corner_t = np.where(np.abs(np.angle(to_a)) <= CORNER, np.abs(to_a), np.inf)
        corner_t = np.minimum(
            corner_t, np.where(np.abs(np.angle(to_b)) <= CORNER, np.abs(to_b), np.inf)
        )
        low_t.append(np.minimum(np.where(hit, t, np.inf), corner_t))
        high_t.append(np.where(hit & ~at_corner, t, np.inf))
        with np.errstate(divide="ignore"):
            sensitive.append(np.abs(edge)[:, None] / np.abs(across))
        owners.append(owner)
    circles = np.array(things.circle_owner, int) != own
    if circles.any():
        owner = np.array(things.circle_owner, int)[circles]
        centre = np.array(things.centre)[circles] - here
        radius = np.array(things.radius)[circles]
        half_b = _dot(centre[:, None], ray[None])
        root = half_b**2 - (np.abs(centre) ** 2 - radius**2)[:, None]
        with np.errstate(invalid="ignore"):
            t = half_b - np.sqrt(root)
        hit = (root >= 0) & (t >= 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            tangent = np.arcsin(np.minimum(radius / np.abs(centre), 1.0))[:, None]
        off = np.abs(np.angle(centre[:, None] / ray[None]))
        grazing = np.abs(off - tangent) <= CORNER
        # A ray turned by CORNER into the circle hits this much before the tangent's point.
        deeper = half_b - np.sqrt(2 * CORNER * radius * np.abs(centre))[:, None]
        low_t.append(np.where(grazing, deeper, np.where(hit, t, np.inf)))
        high_t.append(np.where(hit & ~grazing, t, np.inf))
        with np.errstate(divide="ignore", invalid="ignore"):
            sensitive.append(radius[:, None] / np.sqrt(np.maximum(root, 0.0)))
        owners.append(owner)
    if not low_t:
        full = np.full(len(bearings), max_range)
        return Answer(full, full.copy(), np.full(len(bearings), -1), full / full, full * 0)
    low, high = np.concatenate(low_t), np.concatenate(high_t)
    winner = low.argmin(axis=0)
    columns = np.arange(len(bearings))
    found = low[winner, columns] <= max_range
    owner = np.concatenate(owners)
    rival = np.where(owner[:, None] == owner[winner], max_range, low).min(axis=0)
    return Answer(
        np.minimum(low.min(axis=0), max_range),
        np.minimum(high.min(axis=0), max_range),
        np.where(found, owner[winner], -1),
        np.where(found, np.concatenate(sensitive)[winner, columns], 1.0),
        np.minimum(rival, max_range) - np.minimum(low.min(axis=0), max_range),
    )


def cone(
    things: Things, origin: Floats | Sequence[float], own: int, fov: float, max_range: float
) -> tuple[float, float]:
    """The nearest point in a cone, if the cone is CORNER wider and narrower: (low, high).

    Of each edge the nearest point is an end, the perpendicular's foot, or where a side of the cone
    crosses it; of each circle it is on the line through its centre, or on a side of the cone. All
    those points are collected, and those outside of the cone are left out.
    """
    turn = np.exp(1j * origin[2])
    here = complex(origin[0], origin[1])
    sides = np.exp(np.array([0.5j, -0.5j]) * fov)
    if things.within(here, own) >= 0:
        return 0.0, 0.0
    free: list[complex] = []  # points that may lie in the cone
    crossing: list[complex] = []  # points that lie on a side of it
    for a, b, owner in zip(things.a, things.b, things.edge_owner, strict=True):
        if owner == own:
            continue
        start, edge = (a - here) / turn, (b - a) / turn
        foot = start - edge * min(max(_dot(start, edge) / abs(edge) ** 2, -1.0), 0.0)
        if abs(foot) <= ON:
            return 0.0, 0.0
        free += [start, start + edge, foot]
        for side in sides:
            across = _cross(side, edge)
            if across != 0 and 0 <= _cross(start, side) / across <= 1:
                crossing.append(side * (_cross(start, edge) / across))
    for centre, radius, owner in zip(
        things.centre, things.radius, things.circle_owner, strict=True
    ):
        if owner == own:
            continue
        c = (centre - here) / turn
        free += [c - radius * c / abs(c), c + radius * c / abs(c)]
        for side in sides:
            root = _dot(c, side) ** 2 - abs(c) ** 2 + radius**2
            if root >= 0:
                crossing += [side * (_dot(c, side) + sign * np.sqrt(root)) for sign in (-1, 1)]
    on_side = [abs(p) for p in crossing if abs(p) > 0 and min(abs(p / abs(p) - sides)) < 1e-6]
    low = [abs(p) for p in free if abs(np.angle(p)) <= fov / 2 + CORNER]
    high = [abs(p) for p in free if abs(np.angle(p)) <= fov / 2 - CORNER]
    return min([*low, *on_side, max_range]), min([*high, *on_side, max_range])


def _dot(a: npt.NDArray[np.complex128], b: npt.NDArray[np.complex128]) -> Floats:
    return np.asarray(a.real * b.real + a.imag * b.imag)


def _cross(a: npt.NDArray[np.complex128], b: npt.NDArray[np.complex128]) -> Floats:
    return np.asarray(a.real * b.imag - a.imag * b.real)


def _zero(owner: int, samples: int) -> Answer:
    zero = np.zeros(samples)
    return Answer(zero, zero, np.full(samples, owner), np.ones(samples), zero)


def check_scan(
    answer: Answer, ranges: Floats, hits: npt.NDArray[np.int32], max_range: float
) -> None:
    """Fail unless a scan is what brute force says, to 1e-9 m.

    Where a ray grazes what it hits, both methods lose digits: a placement that is off by one
    rounding (2e-14 m: 100 m times 2**-52) shifts the hit by that times the sensitivity.
    """
    tolerance = np.maximum(1e-9, 2e-14 * np.minimum(answer.sensitivity, 1e9))
    assert (ranges >= answer.low - tolerance).all(), (ranges - answer.low).min()
    assert (ranges <= answer.high + tolerance).all(), (ranges - answer.high).max()
    # Where two things lie at one range, or a corner is hit, either may be named.
    certain = (answer.high - answer.low <= tolerance) & (answer.lead > 2 * tolerance)
    assert (hits[certain] == answer.owner[certain]).all()
    nothing = answer.low > max_range - 1e-9
    assert (ranges[nothing] >= max_range - 1e-9).all()
