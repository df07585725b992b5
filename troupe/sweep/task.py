"""One run of a sweep, from what is asked for to its record; nothing of it raises."""

from __future__ import annotations

import contextlib
import os
import platform
import time
import traceback
from collections import OrderedDict, deque
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.build import LoadedWorld
from sim.engine import Settings
from sim.fleet.fleet import Fleet
from sim.run import run_world
from sim.worldfile import WorldError
from troupe.sweep.fingerprint import Fingerprint
from troupe.sweep.functions import Function, call, function_mark
from troupe.sweep.judging import Judging, judges_of
from troupe.sweep.plan import Run, as_settings, load_point
from troupe.sweep.versions import machine

if TYPE_CHECKING:
    from sim.result import Result

MOST_LINES = 40
"""Of what the controllers and the simulator said in a run that failed."""

MOST_WORLDS = 8
"""Worlds that are kept ready."""

Ready = tuple[LoadedWorld | Function, Fingerprint]


class Stale(Exception):
    """The world is not the one that was checked before the first run."""


def task_of(run: Run, tries: int = 1) -> dict[str, Any]:
    """What a worker is told about a run, as JSON."""
    point = run.point
    return {
        "name": run.name,
        "hash": point.hash,
        "world": point.world,
        "path": point.path,
        "settings": dict(point.settings),
        "seed": run.seed,
        "duration": point.duration,
        "judges": [vars(one) for one in point.judges],
        "tries": tries,
    }


class Worlds:
    """The worlds that were run last, read and checked, and the functions in a world's place."""

    def __init__(self) -> None:
        self.ready: OrderedDict[str, Ready] = OrderedDict()

    def get(self, task: Mapping[str, Any]) -> LoadedWorld | Function:
        """The task's world or function; raises Stale, WorldError or UsageError."""
        known = self.ready.get(task["hash"])
        if known is None or not known[1].holds():
            known = load(task)
            if known[1].hash != task["hash"]:
                shown = task["path"] if task["duration"] is not None else task["world"]
                raise Stale(f"{shown}: it, a file that it names or Troupe has been changed")
            self.ready[task["hash"]] = known
            if len(self.ready) > MOST_WORLDS:
                self.ready.popitem(last=False)
        self.ready.move_to_end(task["hash"])
        return known[0]

    def check(self, task: Mapping[str, Any]) -> None:
        """Raises Stale if a file was changed while the task's run went on."""
        known = self.ready[task["hash"]]
        if not known[1].holds():
            self.get(task)


def load(task: Mapping[str, Any]) -> Ready:
    """A task's world or function, and its name as the files are now."""
    if task["duration"] is None:
        function = Function(task["world"], task["path"])
        return function, function_mark(function, task["settings"])
    settings = as_settings(task["settings"])
    loaded, mark, _ = load_point(task["path"], settings, task["duration"], judges_of(task))
    return loaded, mark


def run_task(task: Mapping[str, Any], worlds: Worlds) -> dict[str, Any]:
    """The record of a run, or {"name": ..., "stale": why} where its world has been changed."""
    began = time.perf_counter()
    said: deque[str] = deque(maxlen=MOST_LINES)
    found: dict[str, Any] = {}
    try:
        found, outcome, reason = run(task, worlds, said)
        worlds.check(task)
    except Stale as error:
        return {"name": task["name"], "stale": str(error)}
    except WorldError as error:
        outcome, reason = "world_error", str(error.mistakes[0]) if error.mistakes else str(error)
    except MemoryError:
        outcome, reason = "out_of_memory", "there was no memory left"
    except (Exception, SystemExit) as error:
        outcome, reason = "error", f"{type(error).__name__}: {error}"
        said.extend(traceback.format_exc().splitlines())
    record = {
        **found,
        **ended(task, outcome, reason),
        "seconds": round(time.perf_counter() - began, 4),
        "machine": machine(),
    }
    if outcome != "completed" and said:
        record["output"] = list(said)
    return record


def ended(task: Mapping[str, Any], outcome: str, reason: str | None) -> dict[str, Any]:
    """What the record of every run has: which it is, and how it ended."""
    return {
        "name": task["name"],
        "outcome": outcome,
        "tries": task["tries"],
        "reason": reason,
        "world": task["world"],
        "seed": task["seed"],
        "hash": task["hash"],
        "parameters": dict(task["settings"]),
    }


def run(
    task: Mapping[str, Any], worlds: Worlds, said: deque[str]
) -> tuple[dict[str, Any], str, str | None]:
    """A run's result, its outcome, and why it is none that is complete."""
    loaded = worlds.get(task)
    if isinstance(loaded, Function):
        return call(loaded, task["settings"], task["seed"])
    if "video" in task or "log" in task:
        result = record_again(task, said)
    else:
        if loaded.world.player.port:  # several runs cannot share it, and it changes no result
            player = loaded.world.player.model_copy(update={"port": 0})
            world = loaded.world.model_copy(update={"player": player})
            loaded = replace(loaded, world=world)
        settings = Settings(seed=task["seed"], duration=task["duration"])
        fleet = Fleet(show=said.append, waits=True)
        judges = judges_of(task)
        judging = Judging(judges) if judges else None
        look = judging.each_tick if judging is not None else None
        result = run_world(loaded, settings, fleet=fleet, say=said.append, each_tick=look)
        if judging is not None and result.outcome != "interrupted":
            found = {**result.as_json(), "judged": judging.columns(result)}
            return found, result.outcome, reason_of(result)
    return result.as_json(), result.outcome, reason_of(result)


def record_again(task: Mapping[str, Any], said: deque[str]) -> Result:
    """The same run with a video or a log, which is written aside."""
    from troupe.running import run_file  # noqa: PLC0415 - the encoder, which few runs need

    path = Path(task.get("video") or task["log"])
    aside = path.with_name(f"{path.stem}.{platform.node()}-{os.getpid()}.tmp{path.suffix}")
    others = ["player.port=null", *(["log=null"] if "log" not in task else [])]
    try:
        done = run_file(
            task["path"],
            seed=task["seed"],
            duration=task["duration"],
            settings=[*as_settings(task["settings"]), *others],
            video=aside if "video" in task else None,
            log=aside if "log" in task else None,
            say=said.append,
        )
        if not done.broken and done.result.outcome != "interrupted":
            os.replace(aside, path)
        return done.result
    finally:
        with contextlib.suppress(OSError):
            aside.unlink()


def reason_of(result: Result) -> str | None:
    """Why a run is not complete, in a line; the same for runs that failed alike."""
    if result.outcome == "completed":
        return None
    if result.outcome == "controller_failed":
        for record in result.robots:
            if record.state in ("failed", "hung", "lost"):
                last = (record.error or "").strip().splitlines()[-1:] or [""]
                code = f" ({record.exit_code})" if record.exit_code is not None else ""
                return f"{record.state}{code}: {last[0]}".removesuffix(": ")
    if result.outcome == "time_limit":
        running = sum(record.state == "running" for record in result.robots)
        return f"{running} of {len(result.robots)} controllers were still running"
    return str(result.outcome)


def killed_from_outside(record: Mapping[str, Any]) -> bool:
    """Whether a controller was ended by SIGKILL, which no program does by itself."""
    robots = record.get("robots", ())
    return any(one["controller"]["exit_code"] == -9 for one in robots)
