"""What `troupe.run` does after every tick for those who asked: hooks, and trajectories."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from sim.engine import Engine
    from sim.result import Result
    from troupe.simulation import Simulation

Hook = Callable[["Simulation"], object]


class Hooks:
    """The hooks of one run. What one raises ends the run: RunError, with the result so far."""

    def __init__(self, each_tick: Hook | None, until: Hook | None, trajectories: bool) -> None:
        self.hooks = {"each_tick": each_tick, "until": until}
        self.trajectories = trajectories
        self.poses: list[NDArray[np.float64]] = []
        self.times: list[float] = []
        self.simulation: Simulation | None = None

    @property
    def wanted(self) -> bool:
        """Whether there is anything to be done."""
        return self.trajectories or any(self.hooks.values())

    def each_tick(self, engine: Engine) -> None:
        """A tick has gone by."""
        from troupe.simulation import RunError, Simulation  # noqa: PLC0415

        if self.trajectories:
            self.poses.append(engine.scenery.stage.poses.copy())
            self.times.append(engine.time)
        if self.simulation is None:
            self.simulation = Simulation.watching(engine)
        for name, hook in self.hooks.items():
            if hook is None:
                continue
            try:
                found = hook(self.simulation)
            except Exception as error:
                result = engine.result("interrupted", perf_counter() - engine.began)
                raise RunError(
                    f"{name} raised at tick {engine.ticks} ({engine.time:g} s): "
                    f"{type(error).__name__}: {error}",
                    result,
                ) from error
            if name == "until" and found:
                engine.ending.enough = True

    def finish(self, result: Result) -> None:
        """Put the trajectories into the result; robots that came later have NaN before."""
        if not self.trajectories:
            return
        result.times = np.array(self.times)
        result.poses = np.full((len(self.poses), len(result.robots), 3), np.nan)
        for tick, poses in enumerate(self.poses):
            result.poses[tick, : len(poses)] = poses
