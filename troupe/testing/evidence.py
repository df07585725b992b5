"""What a judge looks at: the true poses of every tick, the bodies, and all that stands around them.

    Evidence.of("run.mcap")                  # a log, whoever made it

    watch = Watch()
    troupe.run("wander", each_tick=watch)    # or a run, while it goes on
    watch.evidence

Both are the same for the same run, bit by bit. A judge sees the ends of ticks, and nothing between.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.log.contents import PAINTED
from troupe.log import Log
from troupe.testing.outlines import Floats, Outline, inside, outline_of, separation

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from troupe.simulation import Simulation


class Thing(NamedTuple):
    """A piece of what stands: its name, its outline, and its pose x, y (m), yaw (rad)."""

    name: str
    outline: Outline
    pose: Floats


@dataclass(frozen=True)
class Surroundings:
    """All of a world that is no robot.

    `size` (m, m). `arena`: corners (k, 2) of the convex boundary, counter-clockwise, or None.
    `standing`: obstacles, by their names or `obstacle K`, from 0 as in the file, and the blocks of
    the `map`. `movables`: name and outline of what can be pushed. `cell`: metres of a painted cell.
    """

    size: tuple[float, float]
    arena: Floats | None = None
    standing: Sequence[Thing] = ()
    movables: Sequence[tuple[str, Outline]] = ()
    cell: float = 0.05

    @classmethod
    def of(cls, loaded: LoadedWorld) -> Surroundings:
        """Those of a world."""
        world, layout = loaded.world, loaded.layout
        arena = layout.arena if world.boundary is not None else None
        standing, movables = [], []
        for k, one in enumerate(world.obstacles):
            name, outline = one.name or f"obstacle {k}", outline_of(one)
            if one.movable:
                movables.append((name, outline))
                continue
            x, y, degrees = one.pose
            standing.append(Thing(name, outline, np.array([x, y, np.radians(degrees)])))
        walls = 0 if arena is None else len(arena)
        for block in layout.solids[walls : len(layout.solids) - len(standing)]:
            centre = block.vertices.mean(axis=0)
            standing.append(Thing("map", block.vertices - centre, np.array([*centre, 0.0])))
        return cls(layout.size, arena, standing, movables, world.floor.resolution)

    def free(self, points: Floats) -> NDArray[np.bool_]:
        """(k,) whether points (k, 2) lie on the world's floor and in nothing that stands."""
        width, height = self.size
        ground = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
        found = inside(ground if self.arena is None else self.arena, points)
        poses = np.column_stack([points, np.zeros(len(points))])
        for thing in self.standing:
            there = np.broadcast_to(thing.pose, poses.shape)
            found &= separation(0.0, poses, thing.outline, there) > 0.0
        return found


@dataclass(frozen=True)
class Evidence:
    """A run as it was seen from outside, for t ticks, n robots and m things that can be pushed.

    `outlines` (n,) the robots' bodies, in their own frames. `starts` (n, 3) where they entered.
    `times` (t,) s. `poses` (t, n, 3) x, y (m), yaw (rad), the truth; NaN where a robot had not
    entered yet. `movable_poses` (t, m, 3). `painted` (k,) records of cells that a robot painted
    which was not the last to do so: tick, robot, row, column.
    """

    names: list[str]
    outlines: list[Outline]
    starts: Floats
    times: Floats
    poses: Floats
    around: Surroundings
    movable_poses: Floats = field(default_factory=lambda: np.zeros((0, 0, 3)))
    painted: NDArray[Any] = field(default_factory=lambda: np.zeros(0, PAINTED))

    @classmethod
    def of(cls, source: Evidence | Log | str | Path) -> Evidence:
        """Of a log or its file; evidence is given back as it is.

        Raises troupe.LogError for a file that is no log, or whose world does not hold any more.
        """
        if isinstance(source, Evidence):
            return source
        log = source if isinstance(source, Log) else Log(source)
        return cls(
            log.robots,
            outlines_of(log.world, [entry.model for entry in log.entries]),
            np.array([entry.pose for entry in log.entries]).reshape(-1, 3),
            log.times,
            log.poses,
            Surroundings.of(log.world),
            log.movable_poses,
            log.painted,
        )


def outlines_of(loaded: LoadedWorld, models: Sequence[str]) -> list[Outline]:
    """The bodies of robots of these models."""
    shapes = {name: outline_of(loaded.world.models[name].body) for name in {*models}}
    return [shapes[name] for name in models]


class Watch:
    """Gathers the evidence of a run: call it after every tick with the simulation.

    It is a hook for `troupe.run(each_tick=...)`; who steps a `troupe.Simulation` calls it after
    each step.
    """

    def __init__(self) -> None:
        self._simulation: Simulation | None = None
        self._times: list[float] = []
        self._poses: list[Floats] = []
        self._movables: list[Floats] = []
        self._floor: NDArray[np.int16] | None = None
        self._painted = [np.zeros(0, PAINTED)]

    def __call__(self, simulation: Simulation) -> None:
        """Look at a run at the end of a tick."""
        self._simulation = simulation
        self._times.append(simulation.time)
        self._poses.append(simulation.poses)
        self._movables.append(simulation.movable_poses)
        floor = simulation.floor()
        if floor is None:
            return
        known = np.zeros_like(floor) if self._floor is None else self._floor
        rows, columns = np.nonzero(floor != known)
        if len(rows):
            fresh = np.zeros(len(rows), PAINTED)
            fresh["tick"], fresh["robot"] = simulation.ticks, floor[rows, columns] - 1
            fresh["row"], fresh["column"] = rows, columns
            self._painted.append(fresh)
        self._floor = floor

    @property
    def evidence(self) -> Evidence:
        """All that was seen so far. Raises RuntimeError where there was nothing to see yet."""
        simulation = self._simulation
        if simulation is None:
            raise RuntimeError("nothing has been watched: call it after every tick")
        entries = simulation.entries
        poses = np.full((len(self._poses), len(entries), 3), np.nan)
        for tick, there in enumerate(self._poses):
            poses[tick, : len(there)] = there
        return Evidence(
            [entry.name for entry in entries],
            outlines_of(simulation.loaded, [entry.model for entry in entries]),
            np.array([entry.pose for entry in entries]).reshape(-1, 3),
            np.array(self._times),
            poses,
            Surroundings.of(simulation.loaded),
            np.array(self._movables),
            np.concatenate(self._painted),
        )
