"""How near robots come to each other, and to all else."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from troupe.log import Log
from troupe.testing.evidence import Evidence
from troupe.testing.outlines import Floats, Outline, radius_of, separation, within

Ticks = np.ndarray[tuple[int], np.dtype[np.intp]]


def distances(source: Evidence | Log | str | Path) -> Floats:
    """(t, n, n) metres between the robots' bodies, edge to edge; negative where they overlap.

    Infinite of a robot and itself, NaN where one has not entered yet: the least over the last two
    axes is how near any two came in each tick.
    """
    seen = Evidence.of(source)
    ticks, count, _ = seen.poses.shape
    found = np.full((ticks, count, count), np.inf)
    for i, j, where, gaps in robot_pairs(seen, np.inf):
        found[where, i, j] = found[where, j, i] = gaps
    missing = np.isnan(seen.poses[:, :, 0])
    found[missing[:, :, None] | missing[:, None, :]] = np.nan
    return found


def clearances(source: Evidence | Log | str | Path) -> Floats:
    """(t, n) metres from each robot's body to the nearest thing that is no robot.

    That is the boundary, the map, obstacles, and what can be pushed. Negative where they overlap,
    infinite where there is nothing, NaN where the robot has not entered yet.
    """
    seen = Evidence.of(source)
    found = np.full(seen.poses.shape[:2], np.inf)
    for i, _, where, gaps in other_pairs(seen, np.inf):
        found[where, i] = np.minimum(found[where, i], gaps)
    found[np.isnan(seen.poses[:, :, 0])] = np.nan
    return found


def robot_pairs(seen: Evidence, reach: float) -> Iterator[tuple[int, int, Ticks, Floats]]:
    """Pairs of robots with the ticks in which they may be nearer than `reach` m, and how near."""
    for i, outline in enumerate(seen.outlines):
        for j in range(i + 1, len(seen.outlines)):
            where, gaps = apart(
                outline, seen.poses[:, i], seen.outlines[j], seen.poses[:, j], reach
            )
            if len(where):
                yield i, j, where, gaps


def other_pairs(seen: Evidence, reach: float) -> Iterator[tuple[int, str, Ticks, Floats]]:
    """Likewise robots and the names of what is no robot."""
    for i, outline in enumerate(seen.outlines):
        poses = seen.poses[:, i]
        if seen.around.arena is not None:
            (where,) = np.nonzero(~np.isnan(poses[:, 0]))
            yield i, "boundary", where, within(outline, poses[where], seen.around.arena)
        for thing in seen.around.standing:
            there = np.broadcast_to(thing.pose, poses.shape)
            where, gaps = apart(outline, poses, thing.outline, there, reach)
            if len(where):
                yield i, thing.name, where, gaps
        for k, (name, other) in enumerate(seen.around.movables):
            where, gaps = apart(outline, poses, other, seen.movable_poses[:, k], reach)
            if len(where):
                yield i, name, where, gaps


def apart(
    one: Outline, poses: Floats, other: Outline, others: Floats, reach: float
) -> tuple[Ticks, Floats]:
    """The ticks (k,) in which two may be nearer than `reach` m, and how far apart they are (k,)."""
    centres = np.hypot(*(poses[:, :2] - others[:, :2]).T)
    (where,) = np.nonzero(centres <= reach + radius_of(one) + radius_of(other))
    return where, separation(one, poses[where], other, others[where])
