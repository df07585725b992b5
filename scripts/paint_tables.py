"""The tables of the page on Paint, from what lies in docs/results/paint: heads and rows of each."""

from __future__ import annotations

import csv
import statistics
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

CASES = {
    "paint_case_1": ("I", "2:33"),
    "paint_case_2": ("II", "2:30"),
    "paint_case_3": ("III", "2:25"),
}
"""The paper's names of its cases, and its times."""

Row = dict[str, str]
Table = tuple[list[str], list[list[Any]]]


def read(path: Path) -> list[Row]:
    """The rows of a table; none if there is no such file."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(rows: Iterable[Row], key: str) -> list[float]:
    """A column's numbers, without those that are missing."""
    return [float(row[key]) for row in rows if row[key]]


def minutes(seconds: float) -> str:
    """Seconds as the paper writes times: 2:33."""
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"


def mean(values: Sequence[float]) -> str:
    """A mean and, of more than one value, the standard deviation of one."""
    if not values:
        return "-"
    spread = f" ± {statistics.stdev(values):.0f}" if len(values) > 1 else ""
    return f"{statistics.mean(values):.0f}{spread}"


def whole(value: str) -> str:
    """A number without its decimals, a dash where it is missing."""
    return f"{float(value):.0f}" if value else "-"


def cases(folder: Path, speed: float) -> Table:
    """The paper's three cases beside ours at one speed (m/s)."""
    found = [row for row in read(folder / "cases.csv") if float(row["speed"]) == speed]
    rows: list[list[Any]] = []
    for world, (name, paper) in CASES.items():
        goal = [r for r in found if r["world"] == world and r["paint"] == "False"]
        painted = [r for r in found if r["world"] == world and r["paint"] == "True"]
        times, work = numbers(goal, "goal_time"), numbers(painted, "done_time")
        rows.append(
            [
                name,
                paper,
                minutes(statistics.mean(times)) if times else "-",
                mean(times),
                f"{sum(r['right'] == r['robots'] for r in goal)} of {len(goal)}",
                sum(int(r["contacts"]) for r in goal),
                sum(int(r["passings"]) for r in goal),
                mean(numbers(goal, "distance")),
                mean(numbers(goal, "looks")),
                mean(numbers(goal, "waits")),
                f"{mean(work)} ({len(work)} of {len(painted)})",
                f"{min(numbers(painted, 'coverage')):.4f}",
                f"{max(numbers(painted, 'passes')):.2f}",
            ]
        )
    heads = ["case", "paper", "here", "seconds", "goals right", "contacts", "order changed"]
    heads += ["metres, all robots", "looks", "waits", "painted after, s"]
    return [*heads, "coverage, least", "passes, most"], rows


def worlds(folder: Path) -> Table:
    """One run of each world, with painting."""
    heads = ["world", "robots", "outcome", "at goals, s", "painted, s", "coverage", "passes"]
    rows = [
        [
            f"`{row['world']}`",
            row["robots"],
            row["outcome"].replace("_", " "),
            whole(row["goal_time"]),
            whole(row["done_time"]),
            f"{float(row['coverage']):.4f}",
            f"{float(row['passes']):.2f}",
            row["touches"],
        ]
        for row in read(folder / "worlds.csv")
    ]
    return [*heads, "contacts"], rows


def perception(folder: Path) -> Table:
    """How exactly robots are seen."""
    heads = ["robots", "seen", "median, cm", "95 %, cm", "plain mean: median", "95 %"]
    rows = [list(row.values()) for row in read(folder / "perception.csv")]
    return [*heads, "out of bounds"], rows


def placements(folder: Path) -> Table:
    """Many placements, summed up by world and by the length of cycles."""
    groups: dict[tuple[str, float], list[Row]] = {}
    for row in read(folder / "placements.csv"):
        groups.setdefault((row["world"], float(row["jitter"])), []).append(row)
    robots: Callable[[Any], int] = lambda item: int(item[1][0]["robots"])  # noqa: E731
    rows: list[list[Any]] = []
    for (world, jitter), runs in sorted(groups.items(), key=robots):
        times = sorted(float(row["seconds"]) for row in runs if row["right"] == row["robots"])
        rows.append(
            [
                f"`paint_{world}`",
                runs[0]["robots"],
                f"{jitter:g}",
                f"{len(times)} of {len(runs)}",
                f"{total(runs, 'right')} of {total(runs, 'robots')}",
                total(runs, "contacts"),
                total(runs, "swaps"),
                f"{statistics.median(times):.0f}" if times else "-",
                f"{times[max(0, round(0.95 * len(times)) - 1)]:.0f}" if times else "-",
                f"{times[-1]:.0f}" if times else "-",
            ]
        )
    heads = ["world", "robots", "cycles up to, s", "all goals right", "robots at their goals"]
    heads += ["contacts", "order changed", "seconds, median", "95 %", "most"]
    return heads, rows


def noise(folder: Path) -> Table:
    """Runs with painting whose odometry drifts, by world."""
    groups: dict[str, list[Row]] = {}
    for row in read(folder / "noise.csv"):
        groups.setdefault(row["world"], []).append(row)
    rows: list[list[Any]] = []
    for world, runs in groups.items():
        done = [row for row in runs if row["outcome"] == "completed"]
        off, outside = numbers(runs, "off_goal"), numbers(runs, "painted_outside")
        rows.append(
            [
                f"`{world}`",
                len(runs),
                f"{len(done)} of {len(runs)}",
                f"{total(runs, 'right')} of {total(runs, 'robots')}",
                f"{sum(row['contacts'] != '0' for row in runs)} of {len(runs)}",
                f"{sum(row['passings'] != '0' for row in runs)} of {len(runs)}",
                centimetres(off),
                centimetres(outside),
                f"{min(numbers(runs, 'coverage')):.4f}",
            ]
        )
    heads = ["world", "runs", "completed", "goals right", "runs with a contact"]
    heads += ["runs with the order changed", "off the goal, cm: median, most"]
    return [*heads, "painted outside, cm: median, most", "coverage, least"], rows


def centimetres(values: Sequence[float]) -> str:
    """The median and the largest of lengths in metres."""
    if not values:
        return "-"
    return f"{100 * statistics.median(values):.0f}, {100 * max(values):.0f}"


def total(rows: Iterable[Row], key: str) -> int:
    """The sum of a column of counts."""
    return sum(int(row[key]) for row in rows)
