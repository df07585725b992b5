"""The centre of a square robot from the laser points on it.

The points lie on the one or two faces that look at the laser. Robots stand straight (along the
axes) unless they are turning, so that is tried first: a face then gives one coordinate of the
centre exactly, and the other is bounded by the points, and by the rays beside them that passed by.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..constants import BODY, HALF
from ..geometry import Floats

TOLERANCE = 0.03
"""How far a point may be off the face that it is said to be on (m): 3 times a noise of 0.01 m."""

EXACT = 0.002
"""A face whose points are all this near to it (m) is known as exactly as the laser measures."""

_SPAN = 0.25  # m: a shorter piece of a face does not tell how it is turned
_TILT = 0.04  # rad: up to here a body is fitted as straight, turned a little
_LEANING = 0.01  # rad: up to here that falsifies its centre by no more than EXACT
_UPRIGHT = 0.001  # rad: up to here its faces are taken as along the axes
_TWO = 0.21  # m: by how much two points on a line bound a centre less well than three

_STEP = math.radians(2.0)
_TILTS = np.arange(0.0, math.pi / 2, _STEP)
_MARGIN = 0.02  # m: what half a step of tilt moves a centre that is half a body from the points


@dataclass(frozen=True)
class Square:
    """A square seen: the bounds of its centre (m), whether it stands straight, and the misfit.

    `x` and `y` are intervals that hold the centre. `certain` is false where the points could be
    on any face. `aside` is how far along its only face in view the centre is from that face's
    middle (m): a body that leans a little.
    """

    x: tuple[float, float]
    y: tuple[float, float]
    straight: bool
    certain: bool
    misfit: float
    aside: float = 0.0

    @property
    def centre(self) -> tuple[float, float]:
        """The middle of the bounds."""
        return 0.5 * (self.x[0] + self.x[1]), 0.5 * (self.y[0] + self.y[1])

    @property
    def error(self) -> float:
        """The farthest that the centre can be from the middle (m)."""
        return 0.5 * math.hypot(self.x[1] - self.x[0], self.y[1] - self.y[0])


def may_be_one(one: Square, other: Square) -> bool:
    """Whether two squares seen may be pieces of one and the same."""
    return all(
        max(a[0], b[0]) <= min(a[1], b[1]) + TOLERANCE
        for a, b in ((one.x, other.x), (one.y, other.y))
    )


def any_of(squares: Sequence[Square]) -> Square | None:
    """One square of which it is open which of these it is, within the bounds of them all; or None.

    It is certain only if all of them are.
    """
    if len(squares) < 2:
        return squares[0] if squares else None
    x = min(square.x[0] for square in squares), max(square.x[1] for square in squares)
    y = min(square.y[0] for square in squares), max(square.y[1] for square in squares)
    return Square(
        x,
        y,
        all(square.straight for square in squares),
        all(square.certain for square in squares),
        max(square.misfit for square in squares),
    )


def fit_square(
    points: Floats, eye: tuple[float, float], passes: tuple[Floats | None, Floats | None]
) -> Square | None:
    """The square whose faces the points (n, 2) are on, seen from `eye`; None if it is not one.

    `passes` are the directions (2,) of the rays just right and just left of the points, where
    these passed the square by; None where something nearer hides what is there.
    """
    straight = _straight(points, eye, passes)
    if straight is not None and (straight.certain or len(points) == 1):
        return straight
    tilted = _tilted(points, eye)
    return any_of([square for square in (straight, tilted) if square is not None])


def _straight(
    points: Floats, eye: tuple[float, float], passes: tuple[Floats | None, Floats | None]
) -> Square | None:
    low, high = points.min(axis=0), points.max(axis=0)
    if (high - low > BODY + TOLERANCE).any():
        return None
    middle = 0.5 * (low + high)
    towards = [1.0 if middle[k] > eye[k] else -1.0 for k in (0, 1)]
    face = [low[k] if towards[k] > 0.0 else high[k] for k in (0, 1)]
    off = np.abs(points - np.array(face))
    on_x, on_y = off[:, 0] <= TOLERANCE, off[:, 1] <= TOLERANCE
    if len(points) == 1:
        return _single(points[0])
    centre = [face[k] + towards[k] * HALF for k in (0, 1)]
    bounds = [(high[k] - HALF, low[k] + HALF) for k in (0, 1)]
    if on_x.all() or on_y.all():
        axis = 0 if on_x.all() else 1
        if on_x.all() and on_y.all():
            return None
        return _one_face(points, axis, towards[axis], bounds[1 - axis], eye, passes)
    if (on_x | on_y).all() and all(towards[k] * (centre[k] - eye[k]) > HALF for k in (0, 1)):
        exactly = off <= min(EXACT, _UPRIGHT * float((high - low).max()))
        # Two points and a corner fit some square that is turning, three points on a face do not.
        if exactly.any(axis=1).all() and exactly.sum(axis=0).max() > 2:
            x, y = float(centre[0]), float(centre[1])
            return Square((x, x), (y, y), True, True, float(off.min(axis=1).max()))
    return None


def _one_face(
    points: Floats,
    axis: int,
    towards: float,
    bounds: tuple[float, float],
    eye: tuple[float, float],
    passes: tuple[Floats | None, Floats | None],
) -> Square | None:
    """A square of which the face across `axis` is seen, `towards` it from the eye.

    A tilt of a degree or two shows in the points' line, and is taken into account: the face's
    middle then is aside of the square's by half a body times the tilt.
    """
    along = 1 - axis
    span = float(points[:, along].max() - points[:, along].min())
    certain = len(points) > 2 and span > _SPAN
    middle = points.mean(axis=0)
    off = points - middle
    tilt = 0.0
    if certain:
        tilt = float(off[:, axis] @ off[:, along] / max(off[:, along] @ off[:, along], 1e-9))
        if abs(tilt) > _TILT:
            return None
    misfit = float(np.abs(off[:, axis] - tilt * off[:, along]).max())
    face = float(middle[axis])
    aside = -towards * HALF * tilt
    left, right = _narrowed(bounds, (face, towards), axis, (tilt, aside), eye, passes)
    if left > right:
        return None
    face += tilt * (0.5 * (left + right) - float(middle[along]))
    exact = face + towards * HALF
    upright = certain and misfit <= EXACT * span and abs(tilt) < _LEANING
    slack = 0.0 if certain else _TWO  # two points may be on any face of a body that is turning
    pair = [(exact - slack, exact + slack)] * 2
    pair[along] = (left + aside - slack, right + aside + slack)
    return Square(pair[0], pair[1], upright, certain, misfit, aside)


def _narrowed(
    bounds: tuple[float, float],
    face: tuple[float, float],
    axis: int,
    turned: tuple[float, float],
    eye: tuple[float, float],
    passes: tuple[Floats | None, Floats | None],
) -> tuple[float, float]:
    """Bounds of a face's middle, cut by the rays that passed the square by on either side.

    `face` is where the face lies across `axis`, and towards which side the body is; `turned` the
    tilt, and how far that moves the square's centre along the face.
    """
    (front, towards), (tilt, aside) = face, turned
    low, high = float(bounds[0]), float(bounds[1])
    middle = 0.5 * (low + high)
    along = 1 - axis
    for ray in passes:
        if ray is None or abs(ray[axis]) < 1e-6:
            continue
        slope = float(ray[along] / ray[axis])
        near = eye[along] + slope * (front + towards * HALF - eye[axis])
        corner = math.copysign(HALF, near - middle)  # the corners that this ray can pass
        crossings = [  # at the front corner and at the back one, which is aside twice
            eye[along]
            + slope * (front + back * towards * BODY + tilt * corner - eye[axis])
            - 2.0 * back * aside
            for back in (0.0, 1.0)
        ]
        if min(crossings) > middle:
            high = min(high, min(crossings) - HALF)
        elif max(crossings) < middle:
            low = max(low, max(crossings) + HALF)
    return low, high


def _single(point: Floats) -> Square:
    """One point: on whichever face, however turned, the centre is within half a diagonal."""
    x, y = (float(v) for v in point)
    reach = BODY / math.sqrt(2.0)
    return Square((x - reach, x + reach), (y - reach, y + reach), False, False, 0.0)


def _tilted(points: Floats, eye: tuple[float, float]) -> Square | None:
    """A square that may be turned any way: bounds that hold its centre for every tilt that fits.

    Along a face's normal the centre is known where a point is on that face alone, else it is
    bounded by how far the points reach.
    """
    if len(points) < 2:
        return None
    cos, sin = np.cos(_TILTS), np.sin(_TILTS)
    turn = np.stack([np.stack([cos, sin], axis=1), np.stack([-sin, cos], axis=1)], axis=1)
    local = turn @ points.T  # (tilts, 2, points)
    seen_from = turn @ np.array(eye)
    low, high = local.min(axis=2), local.max(axis=2)
    towards = np.where(0.5 * (low + high) > seen_from, 1.0, -1.0)
    face = np.where(towards > 0.0, low, high)
    off = np.abs(local - face[:, :, None])
    misfits = off.min(axis=1).max(axis=1)
    misfits[(high - low > BODY + TOLERANCE).any(axis=1)] = math.inf
    fits = misfits <= TOLERANCE
    if not fits.any():
        return None
    alone = (off <= TOLERANCE) & (off[:, ::-1, :] > TOLERANCE)
    known = alone.sum(axis=2) >= 2
    centre = np.where(known, face + towards * HALF, 0.5 * (low + high))
    reach = np.where(known, 0.0, 0.5 * (BODY - (high - low)).clip(0.0)) + _MARGIN
    middle = np.einsum("tki,tk->ti", turn, centre)[fits]
    around = np.einsum("tki,tk->ti", np.abs(turn), reach)[fits]
    lowest, highest = (middle - around).min(axis=0), (middle + around).max(axis=0)
    certain = len(points) > 2 and bool((highest - lowest < BODY).all())
    x, y = ((float(a), float(b)) for a, b in zip(lowest, highest, strict=True))
    return Square(x, y, False, certain, float(misfits.min()))
