"""One call of `troupe sweep`: what is missing is run, and put into the folder."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from troupe.sweep.cluster import run_on_cluster
from troupe.sweep.folder import MANY, Keeper, done, line_of_run, open_folder, save_plan, sweep_up
from troupe.sweep.plan import Plan, Run
from troupe.sweep.pool import Record, Task, run_all
from troupe.sweep.progress import Progress
from troupe.sweep.task import task_of

FAILED = (
    "controller_failed", "timeout", "crashed", "out_of_memory", "world_error", "error",
)  # fmt: skip
"""Outcomes that may be others another time. Simulated time does not depend on the machine, and what
a function calls its outcome it would call so again."""


class Changed(Exception):
    """A world was changed while its sweep went on."""


@dataclass(frozen=True)
class How:
    """How a sweep is carried out: nothing of it changes a result."""

    jobs: int = 1
    shard: tuple[int, int] = (1, 1)
    timeout: float | None = None  # wall-clock seconds a run
    retry_failed: bool = False
    dask: str | None = None
    quiet: bool = False


@dataclass
class Session:
    """What a call has found and done: runs by outcome, in the folder before and run now."""

    asked: int = 0
    known: Counter[str] = field(default_factory=Counter)
    ran: Counter[str] = field(default_factory=Counter)

    @property
    def missing(self) -> int:
        return self.asked - self.known.total() - self.ran.total()


def sweep(plan: Plan, folder: Path, how: How, stop: Callable[[], bool] = lambda: False) -> Session:
    """Run what the folder lacks of a plan. When `stop()` is true it ends, and nothing is lost.

    Raises UsageError for a folder or cluster that cannot be used, Changed, OSError where nothing
    can be written, and pool.Broken.
    """
    open_folder(folder)
    sweep_up(folder)
    save_plan(folder, plan)
    session = Session()
    todo: list[tuple[Run, int]] = []
    known = done(folder)
    for run in plan.runs(how.shard):
        session.asked += 1
        outcome, tries = known.get(run.name, ("", 0))
        if not outcome or (how.retry_failed and outcome in FAILED):
            todo.append((run, tries))
        else:
            session.known[outcome] += 1
    short = any(point.function is not None for point in plan.points)
    keeper = Keeper(folder, batches=short or plan.size >= MANY)
    progress = Progress(len(todo), how.quiet)

    def tasks() -> Iterator[Task]:
        for run, tries in todo:
            other = line_of_run(folder, run.name) if tries == 0 else None
            if other is not None:  # by another sweep into this folder, meanwhile
                session.known[other.outcome] += 1
            else:
                yield task_of(run, tries + 1)

    try:
        for record in run_tasks(tasks(), how, min(how.jobs, max(len(todo), 1)), stop):
            if "stale" in record:
                raise Changed(record["stale"])
            keeper.put(record)
            session.ran[record["outcome"]] += 1
            progress.step(record["outcome"] == "completed")
    finally:
        progress.close()
        keeper.close()
    return session


def run_tasks(
    tasks: Iterator[Task], how: How, jobs: int, stop: Callable[[], bool]
) -> Iterator[Record]:
    """The records of tasks, run here or on a cluster."""
    if how.dask is not None:
        return run_on_cluster(tasks, how.dask, how.timeout, stop)
    return run_all(tasks, jobs, how.timeout, stop)
