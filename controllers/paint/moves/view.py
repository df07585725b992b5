"""Acting to see: where to step to, sideways, for the best view of the places in shadow.

A robot that does not know its rank yet keeps to its row, so that the order is kept, and goes along
it to where most of the places that it has to see into are in view past the robots it knows of.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..constants import HALF
from ..geometry import Floats

_SHADE = HALF + 0.05
"""Half the width of the shadow that a robot is taken to cast (m): it may be turning."""

WAY = 0.01
"""What share more a place must show to be worth each metre of the way there."""


def visible_share(eye: tuple[float, float], places: Floats, robots: Floats) -> float:
    """The share of places (n, 2) in view from `eye` past robots (m, 2), taken as discs."""
    if len(places) == 0:
        return 1.0
    if len(robots) == 0:
        return 1.0
    rays = places - eye
    lengths = np.hypot(rays[:, 0], rays[:, 1]) + 1e-9
    units = rays / lengths[:, None]
    to_robots = robots - eye
    along = units @ to_robots.T
    across = np.abs(units[:, :1] * to_robots[None, :, 1] - units[:, 1:] * to_robots[None, :, 0])
    hidden = (along > 0.0) & (along < lengths[:, None]) & (across < _SHADE)
    return float(1.0 - hidden.any(axis=1).mean())


def best_step(
    xs: Sequence[float], y: float, here: float, places: Floats, robots: Floats
) -> tuple[float, float]:
    """Of the positions `xs` on the row y, the one with the best view, and that view's share.

    From that share what the way from `here` costs is taken off.
    """
    shares = [(visible_share((x, y), places, robots) - WAY * abs(x - here), x) for x in xs]
    share, x = max(shares)
    return x, share
