"""A judge of Paint in the world: contacts, order and goals from the true poses of every tick."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.build import load
from sim.engine import Engine, Settings
from sim.result import Result, RobotRecord
from sim.run import run_world
from tests.papers.paint_bench import SAME_HEIGHT, expected_goals, ranked, touching, walls_of

Floats = NDArray[np.float64]


@dataclass
class Judge:
    """Watches a run; `region` (k, 2) are the walls' corners, counter-clockwise.

    `sprayer` is the length and width of what the painters spray (m). `painted` are the lowest and
    the highest height that each robot's sprayer reached while on.
    """

    region: Floats
    sprayer: tuple[float, float]
    contacts: list[str] = field(default_factory=list)
    swaps: list[str] = field(default_factory=list)
    order: NDArray[np.intp] | None = None
    level: NDArray[np.bool_] | None = None
    painted: dict[int, tuple[float, float]] = field(default_factory=dict)

    @cached_property
    def walls(self) -> tuple[Floats, Floats]:
        """The walls' normals and offsets."""
        return walls_of(self.region)

    def each_tick(self, engine: Engine) -> None:
        """Look at the true poses after a tick."""
        poses = np.array(engine.scenery.stage.poses, dtype=float)
        if self.order is None:
            starts = np.array([robot.record.start for robot in engine.robots])
            self.order, self.level = ranked(starts)
        assert self.level is not None
        heights = poses[self.order, 1]
        drops = heights[:-1] - heights[1:]
        late = drops > np.where(self.level, SAME_HEIGHT, 0.0)
        if late.any():
            self.swaps.append(f"{engine.time:.1f} s: {drops.max():.4f} m")
        for robot, one in enumerate(engine.robots):
            if any(sprayer.on for sprayer in one.sprayers):
                y, yaw = poses[robot, 1:]
                length, width = self.sprayer
                reach = 0.5 * (abs(math.cos(yaw)) * width + abs(math.sin(yaw)) * length)
                low, high = self.painted.get(robot, (y, y))
                self.painted[robot] = min(low, y - reach), max(high, y + reach)
        self.contacts += [f"{engine.time:.1f} s: {what}" for what in self.touching(poses)]

    def touching(self, poses: Floats) -> list[str]:
        """Which bodies overlap each other or a wall."""
        return [
            f"robot {i} and a wall" if j == len(poses) else f"robots {i} and {j}"
            for i, j in sorted(touching(poses, *self.walls))
        ]


@dataclass
class Judged:
    """A result and what the judge saw."""

    result: Result
    judge: Judge

    @property
    def right(self) -> list[bool]:
        """Per robot, whether it reported and reached the goal that the paper gives it."""
        starts = np.array([robot.start for robot in self.result.robots])
        region = self.judge.region
        wanted = expected_goals(starts, region.min(axis=0), region.max(axis=0))
        return [
            "goal_time" in robot.properties
            and bool(np.abs(reported_goal(robot) - goal).max() < 0.01)
            for robot, goal in zip(self.result.robots, wanted, strict=True)
        ]

    @property
    def faults(self) -> list[str]:
        """What is wrong with the run, in words; nothing if all is right."""
        found = [f"outcome {self.result.outcome}"] if self.result.outcome != "completed" else []
        found += [f"{robot.name}: {robot.error}" for robot in self.result.robots if robot.error]
        found += [
            f"{robot.name}: not at its goal"
            for robot, right in zip(self.result.robots, self.right, strict=True)
            if not right
        ]
        return found + self.judge.contacts[:3] + self.judge.swaps[:3]


def reported_goal(robot: RobotRecord) -> Floats:
    """The goal that a robot reported in its own start frame, in the world (2,)."""
    x, y, yaw = robot.start
    gx, gy = robot.properties["goal"]
    cos, sin = math.cos(yaw), math.sin(yaw)
    return np.array([x + cos * gx - sin * gy, y + sin * gx + cos * gy])


def judged_run(
    world: Path, seed: int, settings: Sequence[str] = (), duration: float | None = None
) -> Judged:
    """Run a world with the judge watching.

    Raises:
        KeyboardInterrupt: the run was interrupted, and is no result.
    """
    loaded = load(world, settings=settings)
    if loaded.world.region is not None and loaded.world.boundary is not None:
        corners: Any = loaded.world.region
    else:
        width, height = loaded.layout.size
        corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
    sprayers = [actuator for m in loaded.world.models.values() for actuator in m.actuators]
    judge = Judge(np.array(corners, dtype=float), sprayers[0].size)
    limit = duration if duration is not None else loaded.world.duration
    result = run_world(loaded, Settings(seed, limit), each_tick=judge.each_tick)
    if result.outcome == "interrupted":
        raise KeyboardInterrupt
    return Judged(result, judge)
