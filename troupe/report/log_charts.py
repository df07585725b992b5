"""The charts of a report on a log: driving, company, coverage, and what robots reported."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from troupe.log import Log
from troupe.report.charts import Band, Series, chart, color_of, escaped, number
from troupe.report.html import figure, table
from troupe.report.measures import Measures

EACH = 12
"""Robots up to which a curve is drawn for each."""
MOST_KEYS, MOST_CHARTED = 12, 8
"""Properties in the table, and drawn."""
SHORTEST = 9
"""Robots from which on a property that is a number is drawn."""
CURVE = "#0072b2"


def driving(log: Log, measures: Measures, result: dict[str, Any] | None) -> list[str]:
    """Distances and speeds."""
    names = log.robots
    if not names:
        return []
    x, few = measures.times, len(names) <= EACH
    speeds: list[Series] = []
    bands: list[Band] = []
    if few:
        speeds = [
            Series(name, color_of(robot), x, measures.speeds[:, robot], width=1.2)
            for robot, name in enumerate(names)
        ]
    else:
        nobody = np.isnan(measures.speeds).all(axis=1, keepdims=True)
        full = np.where(nobody, 0.0, measures.speeds)
        low, middle, high = np.nanpercentile(full, [5, 50, 95], axis=1)
        bands = [Band(CURVE, x, low, high)]
        speeds = [Series("", CURVE, x, middle)]
    total = (
        [
            Series(name, color_of(robot), x, measures.distances[:, robot], width=1.2)
            for robot, name in enumerate(names)
        ]
        if few
        else [Series("", CURVE, x, measures.distances.mean(axis=1))]
    )
    stretch = number(float(x[0])) if len(x) else "0"
    spread = "" if few else " Median of all robots, and where 90 % of them are."
    mean = "" if few else " Mean of all robots."
    told = {} if result is None else {one["name"]: one for one in result["robots"]}
    counts = log[float(log.times[-1]) :].contacts
    rows = []
    for robot, name in enumerate(names):
        one = told.get(name, {})
        distance = one.get("distance", float(measures.distances[-1, robot]))
        time = float(log.times[-1]) - log.entries[robot].time
        rows.append(
            (
                name,
                f"{distance:.2f}",
                f"{distance / time:.3f}" if time > 0 else "",
                f"{measures.top_speeds[robot]:.3f}",
                f"{measures.stalled[robot]:.1f}",
                str(int(counts[-1, robot])),
            )
        )
    return [
        "<h2>Driving</h2>",
        figure(
            chart(speeds, "Speeds", "time, s", "speed, m/s", bands=bands),
            f"Speed, the mean of every {stretch} s.{spread}",
        ),
        figure(chart(total, "Distances", "time, s", "distance, m"), f"Distance driven.{mean}"),
        table(
            ("robot", "distance, m", "mean speed, m/s", "top speed, m/s", "stalled, s", "contacts"),
            rows,
        ),
    ]


def company(log: Log, measures: Measures) -> list[str]:
    """How near robots came to each other."""
    if measures.closest is None:
        return []
    names, closest = log.robots, measures.closest
    one, other = (names[robot] for robot in closest.robots)
    series = [Series("", CURVE, measures.near_times, measures.nearest, width=1.2)]
    sampled = f" Looked at every {number(measures.sampled)} s." * (
        measures.sampled > 1.01 * log.interval
    )
    return [
        "<h2>Nearest robots</h2>",
        figure(
            chart(series, "Least distance between two robots", "time, s", "least distance, m"),
            f"The least distance between two robots, centre to centre.{sampled} Closest: "
            f"{escaped(one)} and {escaped(other)}, {closest.distance:.3f} m at "
            f"{closest.time:.1f} s.",
        ),
    ]


def painting(log: Log, result: dict[str, Any] | None) -> list[str]:
    """Coverage over time."""
    covered = log.coverage
    known = ~np.isnan(covered)
    if not known.any():
        return []
    series = [Series("", CURVE, log.times[known], 100 * covered[known])]
    floor = (result or {}).get("floor") or {}
    passes = f", {floor['passes']:.2f} passes" if "passes" in floor else ""
    times, share = log.times[known], covered[known]
    reached = [
        f"{percent} % at {times[int(np.argmax(share >= percent / 100))]:.1f} s"
        for percent in (50, 90, 99)
        if (share >= percent / 100).any()
    ]
    told = f" Reached {', '.join(reached)}." if reached else ""
    return [
        "<h2>Coverage</h2>",
        figure(
            chart(thin(series), "Coverage", "time, s", "painted, %"),
            f"Painted share of the floor; {100 * share[-1]:.2f} % at the end{passes}.{told}",
        ),
    ]


def thin(series: list[Series]) -> list[Series]:
    """Curves of at most a few hundred points, the last one among them."""
    found = []
    for one in series:
        step = max(1, len(one.x) // 400)
        keep = np.unique(np.r_[np.arange(0, len(one.x), step), len(one.x) - 1])
        found.append(Series(one.label, one.color, one.x[keep], one.y[keep]))
    return found


def reported(log: Log, measures: Measures) -> list[str]:
    """What robots reported about themselves: a table, and what are numbers as charts."""
    names = log.robots
    values: dict[str, dict[str, Any]] = {}
    for one in log.properties:
        values.setdefault(one.key, {})[one.robot] = one.value
    if not values:
        return []
    keys = list(values)[:MOST_KEYS]
    rows = [
        (name, *(shown(values[key].get(name)) for key in keys))
        for name in names
        if any(name in values[key] for key in keys)
    ]
    parts = ["<h2>What robots reported</h2>", table(("robot", *keys), rows)]
    numbers = {
        key: found
        for key in keys
        if len(found := {n: v for n, v in values[key].items() if is_number(v)}) >= SHORTEST
    }
    place = {name: robot for robot, name in enumerate(names)}
    for key, found in list(numbers.items())[:MOST_CHARTED]:
        which = np.array([place[name] for name in found if name in place])
        told = np.array([float(v) for n, v in found.items() if n in place])
        order = np.argsort(which)
        which, told = which[order], told[order]
        label = f"{key}: median {np.median(told):.4g}, {told.min():.4g} to {told.max():.4g}"
        dots = Series("", CURVE, which.astype(float) + 1, told, points=True, opacity=0.7)
        across = (0.0, len(names) + 1.0)
        where = "robot, in the order of entry"
        svg = chart([dots], key, where, key, x_range=across, whole=True)
        parts.append(figure(svg, f"{escaped(label)}, n = {len(told)}."))
        driven = measures.distances[-1, which]
        if len(told) >= SHORTEST and np.ptp(told) > 0 and np.ptp(driven) > 0.1:
            dots = Series("", CURVE, driven, told, points=True, opacity=0.7)
            svg = chart([dots], f"{key} against distance", "distance driven, m", key)
            parts.append(figure(svg, f"{escaped(key)} against the distance that each drove."))
    return parts


def is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and np.isfinite(value)


def shown(value: Any) -> str:
    """A property's value in a cell."""
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.5g}"
    return value if isinstance(value, str) else json.dumps(value)
