"""How much of the floor robots have come by."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from troupe.log import Log
from troupe.testing.evidence import Evidence
from troupe.testing.outlines import Floats


def covered(
    source: Evidence | Log | str | Path, radius: float, *, resolution: float = 0.1
) -> Floats:
    """(t,) the share of the free floor of which some robot's centre has been within `radius` m.

    The floor is looked at in points that are `resolution` m apart; those in walls and in what
    stands do not count. It never falls.
    """
    if not (radius > 0.0 and resolution > 0.0):
        raise ValueError(f"covered: radius and resolution must be above 0 ({radius}, {resolution})")
    seen = Evidence.of(source)
    width, height = seen.around.size
    x = np.arange(resolution / 2, width, resolution)
    y = np.arange(resolution / 2, height, resolution)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    free = seen.around.free(points.reshape(-1, 2)).reshape(len(x), len(y))
    first = np.full(free.shape, len(seen.times))  # the tick in which each was reached
    for robot in range(seen.poses.shape[1]):
        for tick, (px, py) in enumerate(seen.poses[:, robot, :2].tolist()):
            if px != px:  # noqa: PLR0124 - NaN: it has not entered yet
                continue
            near_x = slice(*np.searchsorted(x, (px - radius, px + radius)))
            near_y = slice(*np.searchsorted(y, (py - radius, py + radius)))
            part = first[near_x, near_y]
            off = (x[near_x, None] - px) ** 2 + (y[near_y] - py) ** 2
            part[off <= radius**2] = np.minimum(part[off <= radius**2], tick)
    reached = np.bincount(first[free], minlength=len(seen.times) + 1)[:-1]
    return np.cumsum(reached) / max(1, int(free.sum()))
