"""Reproduce the results of the paper on Paint: docs/results/paint.md, its tables and its pictures.

    scripts/paint_cases [--jobs N] [--folder DIR] [--worlds NAME ...] [--scenes N] [--no-pictures]

Sweeps, judged from the true poses of every tick: the paper's three cases as scripts/paint/cases.csv
has them (5 tests each, as in its section 5, at both speeds), every world once with painting and a
video, and the cases with odometry that drifts. Their folders are in build/paint: what is there is
not run again. Some twenty minutes on one core. The counts over many placements are those that
`scripts/paint_placements` left in docs/results/paint; the page's prose is in scripts/templates.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

import paint_figures as figures  # noqa: E402
from pages import RESULTS, keep, keep_about, write  # noqa: E402
from paint_perception import errors  # noqa: E402
from sweeps import JUDGE, runs, sweep  # noqa: E402

from sim.result import Result  # noqa: E402

KINDS = ("case_1", "case_2", "case_3", "line", "tall", "convex", "swarm_8", "swarm_12", "swarm_16")
NOISE = "models.painter.odometry_noise={slip: 0.02, turn: 0.02}"
"""What is set in the runs of scripts/paint/noise.csv, whose odometry drifts."""
TESTS = 5
"""Tests of a case, in scripts/paint/cases.csv."""

JUDGED = ("right", "contacts", "passings", "off_goal", "painted_outside")
COLUMNS = (
    *("robots", "outcome", *JUDGED, "goal_time", "done_time", "distance", "looks", "waits"),
    *("coverage", "passes", "touches"),
)
"""What the tables hold of a run besides what it was a run of."""


def last(result: Result, key: str) -> float | None:
    """The latest of a time that all robots report; None if one does not."""
    times = [robot.properties.get(key) for robot in result.robots]
    told = [time for time in times if time is not None]
    return max(told) if len(told) == len(times) else None


def total(result: Result, key: str) -> int:
    """The sum of a count over the robots."""
    return sum(robot.properties.get(key, 0) for robot in result.robots)


def kept(row: dict[str, Any], result: Result) -> list[Any]:
    """A run's values of COLUMNS."""
    judged = [row.get(f"judged.{name}") for name in JUDGED]
    return [
        len(result.robots),
        result.outcome,
        *judged,
        last(result, "goal_time"),
        last(result, "done_time"),
        round(sum(robot.distance for robot in result.robots), 3),
        total(result, "looks"),
        total(result, "waits"),
        round(result.floor.coverage, 6),
        round(result.floor.passes, 4),
        sum(robot.contacts for robot in result.robots),
    ]


def keep_cases(folder: Path, out: Path, *, pictures: bool) -> None:
    """The table of the three cases, and figures 5 and 6 and the phases at the lower speed."""
    rows: list[list[Any]] = []
    shown: dict[str, list[Result]] = {}
    timelines: dict[str, Result] = {}
    for row, result in runs(folder):
        assert result is not None, row
        speed = row["models.painter.drive.max_speed"]
        paint = row["controllers.paint.args.paint"]
        rows.append([row["world"], speed, paint, row["seed"], *kept(row, result)])
        name = {"1": "case I", "2": "case II", "3": "case III"}[row["world"][-1]]
        if speed == min(r[1] for r in rows) and not paint:
            shown.setdefault(name, []).append(result)
        elif speed == min(r[1] for r in rows):
            timelines[name] = result
    keep(out / "cases.csv", ["world", "speed", "paint", "seed", *COLUMNS], rows)
    if pictures:
        figures.starts_and_goals(shown, out / "starts_and_goals.png")
        figures.timelines(timelines, out / "timelines.png")


def keep_worlds(folder: Path, out: Path, kinds: Sequence[str], *, pictures: bool) -> None:
    """The table of one run of each world, and strips of pictures of their videos."""
    found = {}
    for row, result in runs(folder):
        assert result is not None, row
        found[row["world"]] = [row["world"], row["seed"], *kept(row, result)]
        video = folder / "videos" / f"{row['hash']}-s{row['seed']}.mp4"
        if pictures and video.exists():
            strip = out / f"{row['world'].removeprefix('paint_')}.png"
            figures.contact_sheet(video, strip)
    order = [f"paint_{kind}" for kind in kinds]
    rows = [found[name] for name in order if name in found]
    keep(out / "worlds.csv", ["world", "seed", *COLUMNS], rows)


def keep_noise(folder: Path, out: Path) -> None:
    """The table of the runs whose odometry drifts."""
    rows = [
        [row["world"], row["seed"], *kept(row, result), row["reason"]]
        for row, result in runs(folder)
        if result is not None
    ]
    keep(out / "noise.csv", ["world", "seed", *COLUMNS, "reason"], rows)


def keep_perception(scenes: int, out: Path) -> None:
    """How exactly robots are seen."""
    rows = []
    for what, tilted in (("standing along the axes", False), ("turned any way", True)):
        found = errors(scenes, tilted)
        plain = [f"{100 * found.quantile(share, plain=True):.1f}" for share in (0.5, 0.95)]
        seen = [f"{100 * found.quantile(share):.2f}" for share in (0.5, 0.95)]
        rows.append([what, len(found.distance), *seen, *plain, found.outside])
    heads = ["robots", "seen", "median_cm", "p95_cm", "plain_median_cm", "plain_p95_cm"]
    keep(out / "perception.csv", [*heads, "out_of_bounds"], rows)


def main() -> None:
    """Run what is missing, and write the tables and the page."""
    options = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    options.add_argument("--jobs", type=int, default=1, help="runs at a time")
    options.add_argument("--folder", type=Path, default=ROOT / "build" / "paint")
    options.add_argument("--scenes", type=int, default=1000, help="scenes for perception")
    options.add_argument(
        "--worlds", nargs="*", default=KINDS, choices=KINDS, help="those run whole, with painting"
    )
    options.add_argument("--pictures", action=argparse.BooleanOptionalAction, default=True)
    options.add_argument("--out", type=Path, default=RESULTS)
    given = options.parse_args()
    if given.jobs < 1 or given.scenes < 1:
        options.error("--jobs and --scenes have to be above 0")
    out = given.out / "paint"
    how = ("--jobs", str(given.jobs), "--judge", JUDGE)
    table = ROOT / "scripts" / "paint" / "cases.csv"
    sweep(given.folder / "cases", "--table", table, *how)
    keep_cases(given.folder / "cases", out, pictures=given.pictures)
    videos = ("--video-of", "first") if given.pictures else ()
    names = [f"paint_{kind}" for kind in given.worlds]
    if names:
        sweep(given.folder / "worlds", *names, *how, *videos)
        keep_worlds(given.folder / "worlds", out, given.worlds, pictures=given.pictures)
    noisy = ROOT / "scripts" / "paint" / "noise.csv"
    sweep(given.folder / "noise", "--table", noisy, "--set", NOISE, *how)
    keep_noise(given.folder / "noise", out)
    keep_perception(given.scenes, out)
    keep_about(out, {"tests": TESTS, "scenes": given.scenes})
    print(write("paint", given.out))


if __name__ == "__main__":
    main()
