"""Videos and logs of some runs of a sweep: when all are done, these are run once more for it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from pathlib import Path

from troupe.sweep.folder import done, sweep_up
from troupe.sweep.plan import Plan, Run
from troupe.sweep.pool import Task, run_all
from troupe.sweep.task import task_of
from troupe.usage import UsageError

ENDINGS = {"video": ".mp4", "log": ".mcap"}
"""What can be made of a run; those of a sweep are in the folder `videos` or `logs`."""

ALLOWED = "failed, first (of each combination), or a number of runs"


def check_words(plan: Plan | None, asked: Mapping[str, str]) -> None:
    """Raises UsageError for a word that says nothing, and for functions, which have neither.

    `asked`: of which runs there is to be a "video" or a "log". Of a plan that has mistakes, None,
    no more than the words is known.
    """
    mistakes = []
    points = () if plan is None else plan.points
    functions = [point.world for point in points if point.function is not None]
    for kind, which in asked.items():
        try:
            number_of(kind, which)
        except UsageError as error:
            mistakes.append(str(error))
        if functions:
            what = f"there is no {kind} of a function's run, as of {functions[0]}"
            mistakes.append(f"--{kind}-of: {what}")
    if mistakes:
        raise UsageError("\n".join(mistakes))


def chosen(plan: Plan, folder: Path, kind: str, which: str) -> list[Run]:
    """The runs of which there are to be videos or logs; raises UsageError for another word."""
    if which == "first":
        return [Run(point, point.seeds[0]) for point in plan.points]
    if which == "failed":
        found = done(folder)
        failed = {name for name, (outcome, _) in found.items() if outcome != "completed"}
        return [run for run in plan.runs() if run.name in failed]
    return list(islice(plan.runs(), number_of(kind, which)))


def number_of(kind: str, which: str) -> int:
    """The number in `--video-of`; raises UsageError for what is none of its words."""
    if which in ("first", "failed"):
        return 0
    if not which.isascii() or not which.isdecimal() or int(which) < 1:
        raise UsageError(f"--{kind}-of {which}: must be {ALLOWED}")
    return int(which)


def record_again(
    kind: str,
    runs: list[Run],
    folder: Path,
    jobs: int,
    timeout: float | None,
    stop: Callable[[], bool],
) -> tuple[list[Path], list[str]]:
    """Make those that are not there yet; they, and why others were not made."""
    place = folder / f"{kind}s"
    place.mkdir(exist_ok=True)
    files = {run.name: place.resolve() / f"{run.name}{ENDINGS[kind]}" for run in runs}

    def tasks() -> Iterator[Task]:
        for run in runs:
            if not files[run.name].exists():
                yield {**task_of(run), kind: str(files[run.name])}

    failed = []
    sweep_up(folder)
    for record in run_all(tasks(), jobs, timeout, stop):
        path = files[record["name"]]
        if not path.exists():
            why = record.get("stale") or record.get("reason") or f"the {kind} cannot be written"
            failed.append(f"{path}: {why}")
    sweep_up(folder)  # what was ended for its time has left half of it
    return [path for path in files.values() if path.exists()], failed
