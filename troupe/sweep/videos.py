"""Videos of some runs of a sweep, made when all runs are done: they are run once more for it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path

from troupe.sweep.folder import done
from troupe.sweep.plan import Plan, Run
from troupe.sweep.pool import Task, run_all
from troupe.sweep.task import task_of
from troupe.usage import UsageError

ALLOWED = "failed, first (of each combination), or a number of runs"


def chosen(plan: Plan, folder: Path, which: str) -> list[Run]:
    """The runs of which there are to be videos; raises UsageError for a word that says nothing."""
    if which == "first":
        return [Run(point, point.seeds[0]) for point in plan.points]
    if which == "failed":
        found = done(folder)
        failed = {name for name, (outcome, _) in found.items() if outcome != "completed"}
        return [run for run in plan.runs() if run.name in failed]
    return list(islice(plan.runs(), number_of(which)))


def number_of(which: str) -> int:
    """The number in `--video-of`; raises UsageError for what is none of its words."""
    if which in ("first", "failed"):
        return 0
    if not which.isascii() or not which.isdecimal() or int(which) < 1:
        raise UsageError(f"--video-of {which}: must be {ALLOWED}")
    return int(which)


def make_videos(
    runs: list[Run],
    folder: Path,
    jobs: int,
    timeout: float | None,
    stop: Callable[[], bool],
) -> tuple[list[Path], list[str]]:
    """Make those that are not there yet, in `videos/`; they, and why others were not made."""
    place = folder / "videos"
    place.mkdir(exist_ok=True)
    videos = {run.name: place.resolve() / f"{run.name}.mp4" for run in runs}

    def tasks() -> Iterator[Task]:
        for run in runs:
            if not videos[run.name].exists():
                yield {**task_of(run), "video": str(videos[run.name])}

    failed = []
    for record in run_all(tasks(), jobs, timeout, stop):
        path = videos[record["name"]]
        if not path.exists():
            why = record.get("stale") or record.get("reason") or "the video could not be written"
            failed.append(f"{path}: {why}")
    return [path for path in videos.values() if path.exists()], failed
