"""What can be measured in a log in one pass over its ticks: ways, speeds, how near robots came."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from troupe.log import Log

Floats = NDArray[np.float64]

POINTS = 300
"""Of a curve over the whole run."""
WAY_POINTS, MOST_WAY_POINTS = 2000, 2_000_000
"""Of one robot's way, and of all ways."""
MOST_PAIRS = 100_000_000
"""Distances between two robots that are looked at; of more, not every tick is."""
PART = 4096
"""Ticks that are read at a time."""


@dataclass
class Approach:
    """The closest that two robots came: centre to centre, in m, and when (s)."""

    distance: float
    time: float
    robots: tuple[int, int]


@dataclass
class Measures:
    """Arrays over robots, n, and over `times` (k,) in s, the ends of equal stretches of the run."""

    times: Floats
    speeds: Floats
    """(k, n) m/s, the mean of each stretch; NaN before a robot entered."""
    distances: Floats
    """(k, n) metres driven so far."""
    ways: list[Floats]
    """By robot: (p, 2) places in m, from its entry to the end."""
    stalled: Floats
    """(n,) seconds in which it was kept from what it wanted to do."""
    top_speeds: Floats
    """(n,) m/s, within any tick."""
    near_times: Floats
    nearest: Floats
    """At these times the least distance between two robots' centres, m; empty for one robot."""
    sampled: float
    """Seconds between two of them."""
    closest: Approach | None


def measure(log: Log) -> Measures:
    """Measure a log."""
    n, ticks = len(log.robots), len(log)
    stretch = max(1, -(-ticks // POINTS))
    step = max(1, ticks // max(1, min(WAY_POINTS, MOST_WAY_POINTS // max(n, 1))))
    seldom = max(1, -(-ticks * n * n // MOST_PAIRS))
    way: list[Floats] = []
    driven = np.zeros((-(-ticks // stretch), n))
    entered = np.zeros(driven.shape, bool)
    stalled, top = np.zeros(n), np.zeros(n)
    near_times: list[float] = []
    nearest: list[float] = []
    closest: Approach | None = None
    before = np.full((1, n, 2), np.nan)
    for first, times, poses, stalls in parts(log):
        numbers = first + np.arange(len(times))
        places = np.concatenate([before, poses[:, :, :2]])
        before = places[-1:]
        moved = np.hypot(*np.moveaxis(np.diff(places, axis=0), 2, 0))
        here = ~np.isnan(places[1:, :, 0])
        moved[np.isnan(moved)] = 0.0
        np.add.at(driven, numbers // stretch, moved)
        np.logical_or.at(entered, numbers // stretch, here)
        if n:
            top = np.maximum(top, moved.max(axis=0) / log.interval)
        stalled += stalls.sum(axis=0) * log.interval
        way.append(poses[(numbers % step == 0) | (numbers == ticks - 1), :, :2])
        if n > 1:
            for k in np.flatnonzero(numbers % seldom == 0).tolist():
                found = nearest_pair(poses[k, :, :2])
                if found is None:
                    continue
                distance, pair = found
                near_times.append(float(times[k]))
                nearest.append(distance)
                if closest is None or distance < closest.distance:
                    closest = Approach(distance, float(times[k]), pair)
    lengths = np.full(len(driven), stretch * log.interval)
    if len(lengths):
        lengths[-1] = (ticks - (len(driven) - 1) * stretch) * log.interval
    speeds = driven / lengths[:, None]
    speeds[~entered] = np.nan
    ends = np.minimum((np.arange(len(driven)) + 1) * stretch, ticks) - 1
    ways = np.concatenate([np.zeros((0, n, 2)), *way])
    return Measures(
        log.times[ends] if ticks else np.zeros(0),
        speeds,
        np.cumsum(driven, axis=0),
        [one[~np.isnan(one[:, 0])] for one in np.moveaxis(ways, 1, 0)],
        stalled,
        top,
        np.array(near_times),
        np.array(nearest),
        seldom * log.interval,
        closest,
    )


def parts(log: Log) -> Iterator[tuple[int, Floats, Floats, NDArray[np.bool_]]]:
    """Part by part: the number of its first tick, times (t,), poses (t, n, 3), stalls (t, n)."""
    times = log.times
    for first in range(0, len(times), PART):
        last = min(first + PART, len(times))
        until = None if last == len(times) else float(times[last])
        part = log[float(times[first]) : until]
        yield first, times[first:last], part.poses, part.stalls


def nearest_pair(places: Floats) -> tuple[float, tuple[int, int]] | None:
    """The least distance between two of (n, 2) places and whose they are; NaN is nowhere."""
    there = np.flatnonzero(~np.isnan(places[:, 0]))
    if len(there) < 2:
        return None
    x, y = places[there].T
    gaps = (x[:, None] - x) ** 2 + (y[:, None] - y) ** 2
    np.fill_diagonal(gaps, np.inf)
    one, other = divmod(int(gaps.argmin()), len(there))
    pair = sorted((int(there[one]), int(there[other])))
    return float(np.sqrt(gaps[one, other])), (pair[0], pair[1])
