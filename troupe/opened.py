"""The logs of a simulation, and how the run behind it ends in order, whoever drops it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from sim.engine import Engine, Settings
from troupe.running import log_of, open_log_of

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.log.recorder import Recorder


@dataclass
class Kept:
    """The logs of a simulation: the first run's, then those of the runs after a reset."""

    log: str | Path | None
    sensors: Sequence[str] | None
    settings: Sequence[str]
    runs: int = 0

    def open(
        self, loaded: LoadedWorld, told: Settings, say: Callable[[str], None]
    ) -> Recorder | None:
        """The next one; None where none is wanted. Raises LogError."""
        path, sensors = log_of(loaded, self.log, self.sensors)
        self.runs += 1
        if path is None:
            return None
        if self.runs > 1:
            path = path.with_name(f"{path.stem}-{self.runs}{path.suffix}")
        recorder = open_log_of(loaded, told, path, sensors, self.settings)
        if recorder is not None:
            recorder.complain = say
        return recorder


def ended(engine: Engine, recorder: Recorder | None) -> None:
    """End a run's processes, and complete its log."""
    try:
        result = None
        if recorder is not None:
            outcome = engine.ended or engine.outcome() or "interrupted"
            result = engine.result(outcome, perf_counter() - engine.began)
        engine.crew.dismiss()
    finally:
        if recorder is not None:
            recorder.finish(engine, result)


def both(one: Callable[[str], None], other: Callable[[str], None]) -> Callable[[str], None]:
    """Lines go to both."""

    def say(line: str) -> None:
        one(line)
        other(line)

    return say


def nothing(engine: Engine, recorder: Recorder | None) -> None:
    """The run goes on by itself, and so it ends."""
