"""The paper's model on the grid: a run of robots that come in through doors, and its outcome."""

from dataclasses import dataclass
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from controllers.dispersal import chance
from controllers.dispersal.rules import RULES, SENSES, TALK
from gridworld import step
from gridworld.compiled import Rule, compile_rule
from gridworld.regions import Cell, Region, RegionError
from gridworld.topology import FAR, distances, framed, offsets_around

OUTCOMES = {
    step.RUNNING: "step_limit",
    step.COMPLETE: "completed",
    step.COLLIDED: "collision",
    step.LEFT_REGION: "left_region",
    step.STUCK: "stuck",
    step.CIRCLING: "circling",
}
"""How a run can end, by the status of the compiled step."""

NO_LIMIT = 2**31 - 1
"""As a number of steps: until the run ends."""

_STRIDE = 1000  # steps between two looks at the keyboard: compiled code cannot be interrupted


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of a run. Arrays hold one value per robot, in the order of entry."""

    outcome: str
    """One of OUTCOMES: completed; collision; left_region (a move into a wall); stuck (nobody is
    active, nobody can enter); circling (nobody entered or settled for long); step_limit."""
    cells: int
    """Cells of the region, V."""
    steps: int
    """Steps done; the last robot settles in the last one."""
    makespan: int | None
    """First step at whose end every cell is occupied; None if that did not happen."""
    collisions: int
    sum_of_distances: int
    """Over all cells, from the nearest door: the least total travel there can be."""
    max_distance: int
    where: Cell | None
    """Cell of the first collision or move into a wall, if any."""
    entered: NDArray[np.int32]
    """(n,) step at whose end the robot entered."""
    settled: NDArray[np.int32]
    """(n,) step at whose end it was settled, 0 if it is still active."""
    cell: NDArray[np.int32]
    """(n, 2) column and row where it stands at last."""
    travel: NDArray[np.int32]
    """(n,) T_i of the paper: steps that began and ended with it active, moving or not."""
    moves: NDArray[np.int32]
    """(n,) steps in which it changed its cell."""
    state: NDArray[np.int64]
    """(n,) its last state: the five bits, for fcdfs5."""
    door: NDArray[np.int32]
    """(n,) number of the door that it came from, from 0."""
    paths: tuple[NDArray[np.int32], ...] | None
    """Per robot the cells (k, 2) where it stood at the end of each step from its entry to its
    settling, if asked for."""

    @property
    def covered(self) -> bool:
        """Whether every cell came to be occupied."""
        return self.makespan is not None

    @property
    def all_settled(self) -> bool:
        """Whether the run completed: every cell holds a settled robot."""
        return self.outcome == "completed"

    @property
    def energy(self) -> NDArray[np.int32]:
        """(n,) E_i of the later paper: steps of activity, the one in which it settled as well."""
        energy: NDArray[np.int32] = self.travel + (self.settled > 0).astype(np.int32)
        return energy

    def figures(self) -> dict[str, Any]:
        """The run in figures, as plain data for JSON.

        Travel counts pauses, as the paper defines it; moves do not, as its table 1 does. Energy
        counts the step in which a robot settles too, as the later paper does.
        """
        return {
            "outcome": self.outcome,
            "cells": self.cells,
            "makespan": self.makespan,
            "total_travel": int(self.travel.sum(dtype=np.int64)),
            "max_travel": int(self.travel.max(initial=0)),
            "total_moves": int(self.moves.sum(dtype=np.int64)),
            "max_moves": int(self.moves.max(initial=0)),
            "total_energy": int(self.energy.sum(dtype=np.int64)),
            "max_energy": int(self.energy.max(initial=0)),
            "sum_of_distances": self.sum_of_distances,
            "max_distance": self.max_distance,
            "collisions": self.collisions,
            "where": list(self.where) if self.where else None,
            "entered": len(self.entered),
            "settled": int((self.settled > 0).sum()),
            "covered": self.covered,
            "steps": self.steps,
        }


class GridRun:
    """A run on the grid that has begun. `advance` does steps; the arrays may be read between.

    Robots are counted from 0 in the arrays (from 1 in the paper and in `chance`).
    """

    def __init__(
        self,
        region: Region,
        rule: str | Rule,
        *,
        seed: int = 0,
        q: float = 0.0,
        conflict: str = "stop",
        senses: int | None = None,
    ) -> None:
        """Set up a run with the region's doors.

        `rule` is a name from RULES, or a function of their kind, whose `senses` default to none.
        `q` is the probability that an activation fails. With `conflict` "stop" a run ends where
        two robots would meet in a cell; with "stay" the first to have entered the region gets the
        cell, the other stays, as if it had not been activated; a robot that would enter waits.
        """
        if not region.doors:
            raise RegionError("the region has no door")
        if len(region.doors) > 60:
            raise RegionError(f"{len(region.doors)} doors are given; at most 60 are possible")
        if not 0 <= q < 1:
            raise ValueError(f"q is {q}: it must be at least 0 and less than 1")
        if not 0 <= seed < 2**63:
            raise ValueError(f"the seed is {seed}: it must be at least 0 and less than 2**63")
        if conflict not in ("stop", "stay"):
            raise ValueError(f"conflict is {conflict!r}: it must be 'stop' or 'stay'")
        if isinstance(rule, str):
            if rule not in RULES:
                raise ValueError(f"there is no rule {rule!r}; the rules are {', '.join(RULES)}")
            senses = SENSES.get(rule, 0) if senses is None else senses
            rule = RULES[rule]
        self.region = region
        self.counters = np.zeros(step.COUNTERS, np.int64)
        grid = framed(region.free)
        self.width = grid.shape[1]
        self.doors = np.array([(r + 1) * self.width + c + 1 for c, r in region.doors], np.int32)
        self.cells = np.where(grid.ravel(), np.uint16(step.FREE), np.uint16(step.STANDING))
        n = region.cells
        self.active = np.empty(n, np.int32)
        self.position = np.zeros(n, np.int32)
        self.state = np.zeros(n, np.int64)
        self.entered = np.zeros(n, np.int32)
        self.settled = np.zeros(n, np.int32)
        self.moves = np.zeros(n, np.int32)
        self.door_of = np.zeros(n, np.int32)
        senses = senses or 0
        marks = self.cells.size if senses & TALK else 0
        self._arguments = (
            compile_rule(rule),
            senses,
            self.cells,
            np.full(marks, step.NOBODY),
            np.zeros(marks, np.int8),
            offsets_around(self.width),
            self.doors,
            self.counters,
            self.active,
            self.position,
            self.state,
            self.entered,
            self.settled,
            self.moves,
            self.door_of,
            np.empty(n, np.int64),
            np.empty(n, np.int8),
            n,
            seed,
            ceil(q * chance.RANGE),
            int(conflict == "stay"),
            ceil((2 * n + 100) / (1 - q)),
        )

    def advance(self, steps: int = 1) -> bool:
        """Do `steps` steps or fewer, until the run ends. Returns whether it goes on."""
        goes_on = bool(self.counters[step.STATUS] == step.RUNNING)
        while goes_on and steps > 0:
            step.advance(*self._arguments, min(steps, _STRIDE))
            goes_on = bool(self.counters[step.STATUS] == step.RUNNING)
            steps -= _STRIDE
        return goes_on

    @property
    def steps(self) -> int:
        """Steps done."""
        return int(self.counters[step.STEP])

    @property
    def emitted(self) -> int:
        """Robots that have entered."""
        return int(self.counters[step.ENTERED])

    @property
    def at_work(self) -> NDArray[np.int32]:
        """The active robots, in the order of entry."""
        return self.active[: self.counters[step.AT_WORK]]

    def cell_of(self, positions: NDArray[np.integer]) -> NDArray[np.int32]:
        """(n, 2) columns and rows of positions (n,) in the framed grid."""
        rows, columns = np.divmod(positions, self.width)
        return np.stack([columns - 1, rows - 1], axis=-1).astype(np.int32)

    def outcome(self, paths: tuple[NDArray[np.int32], ...] | None = None) -> Outcome:
        """What has come of the run so far."""
        n = self.emitted
        distance = distances(self.region.free, self.region.doors)
        reached = distance[distance != FAR]
        settled, entered = self.settled[:n], self.entered[:n]
        # Settling is a step of its own that ends settled; entering is no step of the robot's.
        ended = np.where(settled > 0, settled - 1, self.steps).astype(np.int32)
        where = int(self.counters[step.WHERE])
        return Outcome(
            outcome=OUTCOMES[int(self.counters[step.STATUS])],
            cells=self.region.cells,
            steps=self.steps,
            makespan=int(self.counters[step.MAKESPAN]) or None,
            collisions=int(self.counters[step.COLLISIONS]),
            sum_of_distances=int(reached.sum(dtype=np.int64)),
            max_distance=int(reached.max()),
            where=_pair(self.cell_of(np.array([where]))[0]) if where else None,
            entered=entered.copy(),
            settled=settled.copy(),
            cell=self.cell_of(self.position[:n]),
            travel=ended - entered,
            moves=self.moves[:n].copy(),
            state=self.state[:n].copy(),
            door=self.door_of[:n].copy(),
            paths=paths,
        )


def simulate(
    region: Region,
    rule: str | Rule = "fcdfs",
    *,
    seed: int = 0,
    q: float = 0.0,
    conflict: str = "stop",
    senses: int | None = None,
    max_steps: int | None = None,
    paths: bool = False,
) -> Outcome:
    """Run robots from the region's doors until they have dispersed, or cannot.

    See `GridRun` for the arguments. `max_steps` ends a run early (outcome "step_limit"); without
    it a run ends by itself. `paths` keeps where every robot was (memory: the total travel). The
    region is not checked: see `Region.check`.
    """
    run = GridRun(region, rule, seed=seed, q=q, conflict=conflict, senses=senses)
    limit = NO_LIMIT if max_steps is None else max_steps
    if not paths:
        run.advance(limit)
        return run.outcome()
    walked: list[list[int]] = []
    while run.steps < limit:
        before = run.at_work.copy()
        goes_on = run.advance()
        walked.extend([] for _ in range(run.emitted - len(walked)))
        newcomers = run.at_work[run.entered[run.at_work] == run.steps]
        for robot in (*before, *newcomers):
            walked[robot].append(int(run.position[robot]))
        if not goes_on:
            break
    return run.outcome(tuple(run.cell_of(np.array(walk, np.int32)) for walk in walked))


def _pair(cell: NDArray[np.int32]) -> Cell:
    return int(cell[0]), int(cell[1])
