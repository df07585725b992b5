"""Judges of a sweep's runs: what they are shown of a run while it goes on, and what they say."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from troupe.sweep.results import Judge, columns_of
from troupe.usage import UsageError

if TYPE_CHECKING:
    from sim.engine import Engine
    from sim.result import Result


def judges_of(task: Mapping[str, Any]) -> list[Judge]:
    """Who looks at the run of a task."""
    return [Judge(**one) for one in task.get("judges", ())]


class Judging:
    """A run before its judges. Raises UsageError for a judge that is not there."""

    def __init__(self, judges: list[Judge]) -> None:
        from troupe.testing.evidence import Watch  # noqa: PLC0415 - most sweeps have no judges

        self.judges = [(one, one.load()) for one in judges]
        self.watch = Watch()
        self.simulation: Any = None

    def each_tick(self, engine: Engine) -> None:
        """Look at the end of a tick."""
        from troupe.simulation import Simulation  # noqa: PLC0415

        if self.simulation is None:
            self.simulation = Simulation.watching(engine)
        self.watch(self.simulation)

    def columns(self, result: Result) -> dict[str, Any]:
        """What the judges say of a run that has come to its end; raises UsageError."""
        found: dict[str, Any] = {}
        if self.simulation is None:
            return found
        seen = self.watch.evidence
        for judge, function in self.judges:
            try:
                found |= columns_of(judge, function(seen, result))
            except Exception as error:  # a function of the user's raises anything
                raise UsageError(f"{judge}: {type(error).__name__}: {error}") from error
        return found
