"""The centre of a square robot from the laser points on it.

The points lie on the one or two faces that look at the laser. Robots stand straight (along the
axes) unless they are turning, so that is tried first: a face then gives one coordinate of the
centre exactly, and the other is bounded by the points, and by the rays beside them that passed by.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .constants import BODY, HALF
from .geometry import Floats

TOLERANCE = 0.03
"""How far a point may be off the face that it is said to be on (m): 3 times a noise of 0.01 m."""

_TWO = 0.21  # m: by how much two points on a line bound a centre less well than three

_TILTS = np.radians(np.arange(2.0, 90.0, 4.0))


@dataclass(frozen=True)
class Square:
    """A square seen: the bounds of its centre (m), whether it stands straight, and the misfit.

    `x` and `y` are intervals that hold the centre. `certain` is false where a single point, or
    two, could be on any face.
    """

    x: tuple[float, float]
    y: tuple[float, float]
    straight: bool
    certain: bool
    misfit: float

    @property
    def centre(self) -> tuple[float, float]:
        """The middle of the bounds."""
        return 0.5 * (self.x[0] + self.x[1]), 0.5 * (self.y[0] + self.y[1])

    @property
    def error(self) -> float:
        """The farthest that the centre can be from the middle (m)."""
        return 0.5 * math.hypot(self.x[1] - self.x[0], self.y[1] - self.y[0])


def fit_square(
    points: Floats, eye: tuple[float, float], passes: tuple[Floats | None, Floats | None]
) -> Square | None:
    """The square whose faces the points (n, 2) are on, seen from `eye`; None if it is not one.

    `passes` are the directions (2,) of the rays just right and just left of the points, where
    these passed the square by; None where something nearer hides what is there.
    """
    return _straight(points, eye, passes) or _tilted(points, eye)


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
        misfit = float(np.minimum(off[:, 0], off[:, 1]).max())
        x, y = centre
        return Square((x, x), (y, y), True, len(points) > 2, misfit)
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
    certain = len(points) > 2
    middle = points.mean(axis=0)
    off = points - middle
    tilt = 0.0
    if certain:
        tilt = float(off[:, axis] @ off[:, along] / max(off[:, along] @ off[:, along], 1e-9))
    misfit = float(np.abs(off[:, axis] - tilt * off[:, along]).max())
    face = float(middle[axis])
    left, right = _narrowed(bounds, face + towards * HALF, axis, tilt, eye, passes)
    if left > right:
        return None
    face += tilt * (0.5 * (left + right) - float(middle[along]))
    exact = face + towards * HALF
    aside = -towards * HALF * tilt
    slack = 0.0 if certain else _TWO  # two points may be on any face of a body that is turning
    pair = [(exact - slack, exact + slack)] * 2
    pair[along] = (left + aside - slack, right + aside + slack)
    return Square(pair[0], pair[1], certain, certain, misfit)


def _narrowed(
    bounds: tuple[float, float],
    exact: float,
    axis: int,
    tilt: float,
    eye: tuple[float, float],
    passes: tuple[Floats | None, Floats | None],
) -> tuple[float, float]:
    """Bounds along a face, cut by the rays that passed the square by on either side."""
    low, high = float(bounds[0]), float(bounds[1])
    middle = 0.5 * (low + high)
    along = 1 - axis
    for ray in passes:
        if ray is None or abs(ray[axis]) < 1e-6:
            continue
        slope = float(ray[along] / ray[axis])
        near = eye[along] + slope * (exact - eye[axis])
        corner = math.copysign(HALF, near - middle)  # the corners that this ray can pass
        crossings = [
            eye[along] + slope * (exact + side + tilt * corner - eye[axis])
            for side in (-HALF, HALF)
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
    """A square that is turning: the tilt whose two faces the points fit best."""
    if len(points) < 2:
        return None
    coarse = float(_TILTS[int(np.argmin(_misfits(points, eye, _TILTS)))])
    tilts = coarse + np.radians(np.linspace(-4.0, 4.0, 17))
    misfits = _misfits(points, eye, tilts)
    k = int(np.argmin(misfits))
    misfit, tilt = float(misfits[k]), float(tilts[k])
    if misfit > TOLERANCE:
        return None
    cos, sin = math.cos(tilt), math.sin(tilt)
    turn = np.array([[cos, -sin], [sin, cos]])
    local = points @ turn
    seen_from = np.array(eye) @ turn
    low, high = local.min(axis=0), local.max(axis=0)
    towards = np.where(0.5 * (low + high) > seen_from, 1.0, -1.0)
    face = np.where(towards > 0.0, low, high)
    off = np.abs(local - face)
    centre = face + towards * HALF
    slack, corner = 0.05, True
    for k in (0, 1):
        alone = (off[:, k] <= TOLERANCE) & (off[:, 1 - k] > TOLERANCE)
        if alone.sum() < 2:  # not seen for certain: only bounded by how far the points reach
            centre[k] = 0.5 * (low[k] + high[k])
            slack, corner = max(slack, 0.05 + 0.5 * float(BODY - (high[k] - low[k]))), False
    x, y = turn @ centre
    return Square(
        (x - slack, x + slack), (y - slack, y + slack), False, corner and len(points) > 4, misfit
    )


def _misfits(points: Floats, eye: tuple[float, float], tilts: Floats) -> Floats:
    cos, sin = np.cos(tilts)[:, None], np.sin(tilts)[:, None]
    worst = []
    spans = []
    for a, b in ((cos, sin), (-sin, cos)):
        local = points[:, 0] * a + points[:, 1] * b
        seen_from = eye[0] * a[:, 0] + eye[1] * b[:, 0]
        low, high = local.min(axis=1), local.max(axis=1)
        face = np.where(0.5 * (low + high) > seen_from, low, high)
        worst.append(np.abs(local - face[:, None]))
        spans.append(high - low)
    misfits: Floats = np.minimum(worst[0], worst[1]).max(axis=1)
    too_wide = (spans[0] > BODY + TOLERANCE) | (spans[1] > BODY + TOLERANCE)
    misfits[too_wide] = math.inf
    return misfits
