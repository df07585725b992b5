"""Where two runs that should be the same part from each other."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from troupe.log import Log
from troupe.testing.evidence import Evidence


class Difference(NamedTuple):
    """The first difference of two runs: when (s), of which robot, and by how much (m, m, rad).

    Where one of them ends before the other, or has other robots, there is no robot and no amount.
    """

    time: float
    robot: str | None
    by: tuple[float, float, float] | None


def first_difference(
    one: Evidence | Log | str | Path, other: Evidence | Log | str | Path
) -> Difference | None:
    """Where two runs first differ in any bit of a pose; None where they are the same."""
    a, b = Evidence.of(one), Evidence.of(other)
    if a.names != b.names and a.names[: len(b.names)] != b.names[: len(a.names)]:
        return Difference(0.0, None, None)
    ticks, robots = min(len(a.times), len(b.times)), min(len(a.names), len(b.names))
    p, q = (np.ascontiguousarray(e.poses[:ticks, :robots]).view(np.int64) for e in (a, b))
    wrong = np.argwhere((p != q).any(axis=2))
    if len(wrong):
        tick, robot = wrong[0].tolist()
        x, y, yaw = (b.poses[tick, robot] - a.poses[tick, robot]).tolist()
        return Difference(float(a.times[tick]), a.names[robot], (x, y, yaw))
    if len(a.times) != len(b.times) or a.names != b.names:
        longer = a if len(a.times) > ticks else b
        return Difference(float(longer.times[min(ticks, len(longer.times) - 1)]), None, None)
    return None
