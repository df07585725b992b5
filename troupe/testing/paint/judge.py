"""A judge of Paint in the world: contacts, order, goals and strips from the true poses.

judged("run.mcap").faults                # a log, whoever made it
judged_run("paint_case_2", 7).faults     # or a run that is made for it
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import troupe
from controllers.paint.constants import LEVEL
from troupe.testing.evidence import Evidence, Watch
from troupe.testing.paint.goals import SAME_HEIGHT, expected_goals
from troupe.testing.ranks import Passing, passings, ranked
from troupe.testing.touching import Contact, contacts

if TYPE_CHECKING:
    from sim.result import Result

Floats = NDArray[np.float64]
AT_GOAL = 0.01
"""A reported goal is right if it is so near to the paper's, in both axes (m)."""


@dataclass(frozen=True)
class Judged:
    """A run of Paint: what was seen of it, and the result as `troupe run --json` prints it."""

    seen: Evidence
    result: Mapping[str, Any]

    @cached_property
    def contacts(self) -> list[Contact]:
        """Which bodies overlapped each other or a wall."""
        return contacts(self.seen)

    @cached_property
    def swaps(self) -> list[Passing]:
        """Who passed whom, of neighbours by height."""
        return passings(self.seen, level=LEVEL, give=SAME_HEIGHT)

    @property
    def region(self) -> Floats:
        """Corners (k, 2) of the walls, counter-clockwise."""
        arena = self.seen.around.arena
        assert arena is not None, "a world of Paint has a boundary"
        return arena

    @cached_property
    def goals(self) -> Floats:
        """(n, 2) where the paper has each robot go."""
        return expected_goals(self.seen.starts, self.region.min(axis=0), self.region.max(axis=0))

    @cached_property
    def off_goal(self) -> float:
        """How far from the paper's goals robots truly stood when they said that they had come, m.

        The largest of all robots; NaN if none has come.
        """
        found = math.nan
        for k, robot in enumerate(self.result["robots"]):
            told = robot["properties"].get("goal_time")
            if isinstance(told, int | float):
                times = self.seen.times
                tick = min(int(np.searchsorted(times, told - 1e-6)), len(times) - 1)
                off = math.dist(self.seen.poses[tick, k, :2], self.goals[k])
                found = off if math.isnan(found) else max(off, found)
        return found

    @cached_property
    def right(self) -> list[bool]:
        """Per robot, whether it reported the goal that the paper gives it, and that it is there."""
        return [
            "goal_time" in robot["properties"]
            and bool(np.abs(reported_goal(robot) - goal).max() < AT_GOAL)
            for robot, goal in zip(self.result["robots"], self.goals, strict=True)
        ]

    @property
    def faults(self) -> list[str]:
        """What is wrong with the run, in words; nothing if all is right."""
        outcome, robots = self.result["outcome"], self.result["robots"]
        found = [f"outcome {outcome}"] if outcome != "completed" else []
        errors = [(robot["name"], robot["controller"]["error"]) for robot in robots]
        found += [f"{name}: {error}" for name, error in errors if error]
        found += [
            f"{robot['name']}: not at its goal"
            for robot, right in zip(robots, self.right, strict=True)
            if not right
        ]
        return found + [str(one) for one in (*self.contacts[:3], *self.swaps[:3])]

    @cached_property
    def painted_outside(self) -> float:
        """How far beyond its own strip's borders anybody painted, m; to the cells' centres."""
        seen = self.seen
        size = seen.around.cell
        low, high = self.region[:, 1].min(), self.region[:, 1].max()
        borders = np.linspace(low, high, len(seen.names) + 1)
        borders[[0, -1]] = -np.inf, np.inf  # beyond the walls there is nothing to paint
        place = np.empty(len(seen.names), int)
        place[ranked(seen.starts, level=LEVEL)[0]] = np.arange(len(seen.names))
        of = place[seen.painted["robot"]]
        heights = (seen.painted["row"] + 0.5) * size
        off = np.maximum(borders[of] - heights, heights - borders[of + 1])
        return float(np.maximum(off, 0.0).max(initial=0.0))

    @property
    def measures(self) -> dict[str, float]:
        """In numbers: goals that are right, contacts, changes of the order by height, how far off
        its goal anybody stood, and how far beyond its strip anybody painted (m)."""
        return {
            "right": sum(self.right),
            "contacts": len(self.contacts),
            "passings": len(self.swaps),
            "off_goal": round(self.off_goal, 4),
            "painted_outside": round(self.painted_outside, 4),
        }


def measures(seen: Evidence, result: Result) -> dict[str, float]:
    """Columns of a sweep's table: `troupe sweep --judge troupe.testing.paint.judge:measures`."""
    return Judged(seen, result.as_json()).measures


def reported_goal(robot: Mapping[str, Any]) -> Floats:
    """The goal that a robot reported in its own start frame, in the world (2,)."""
    x, y, yaw = robot["start"]
    gx, gy = robot["properties"]["goal"]
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.array([x + cos * gx - sin * gy, y + sin * gx + cos * gy])


def judged(log: troupe.Log | str | Path) -> Judged:
    """The run of a log, whoever made it.

    Raises troupe.LogError for a file that is no log, and ValueError for one without a result.
    """
    log = log if isinstance(log, troupe.Log) else troupe.Log(log)
    if log.result is None:
        raise ValueError(f"{log.path}: the run was cut off: there is no result to be judged")
    return Judged(Evidence.of(log), log.result)


def judged_run(
    world: str | Path,
    seed: int,
    settings: Sequence[str] = (),
    duration: float | None = None,
    log: str | Path | None = None,
) -> Judged:
    """Run a world with the judge watching; `log` keeps the run in a file.

    Raises:
        KeyboardInterrupt: the run was interrupted, and is no result.
    """
    watch = Watch()
    result = troupe.run(
        world, seed=seed, settings=settings, duration=duration, log=log, each_tick=watch
    )
    if result.outcome == "interrupted":
        raise KeyboardInterrupt
    return Judged(watch.evidence, result.as_json())
