"""A judge of FCDFS with bodies: the run is the grid model's, robot by robot."""

from __future__ import annotations

import math
from collections.abc import Iterator

import troupe
from gridworld.grid import Outcome, simulate
from gridworld.regions import Region, load
from sim.result import Result, RobotRecord

CELL = 1.5
"""Metres of a cell in the worlds that come with Troupe."""


def cell_of(robot: RobotRecord, region: Region, cell: float = CELL) -> tuple[int, int]:
    """(column, row) of the map's cell in which a robot stands at the end."""
    x, y, _ = robot.pose
    return math.floor(x / cell), region.rows - 1 - math.floor(y / cell)


def agreeing(result: Result, region: Region, grid: Outcome, cell: float = CELL) -> list[bool]:
    """Per robot, whether it entered, moved, settled and stands exactly as in the grid model.

    That is the step of entry, the number of moves, the step in which it settled, and the cell.
    """
    return [
        k < len(grid.entered)
        and result.doors[0].steps[k] == grid.entered[k]
        and robot.properties.get("travel") == grid.moves[k]
        and robot.properties.get("settled_step") == grid.settled[k]
        and list(cell_of(robot, region, cell)) == grid.cell[k].tolist()
        for k, robot in enumerate(result.robots)
    ]


def faults(result: Result, region: Region, grid: Outcome, cell: float = CELL) -> list[str]:
    """What is wrong with a run, in words; nothing if it is the grid model's and nobody touched."""
    return list(_faults(result, region, grid, cell))


def measures(result: Result) -> dict[str, int]:
    """In numbers, beside the grid model: a function for `troupe sweep --each`.

    The world must be where it was. `cells` of the map, robots that `agree`, the `steps` until the
    last one came, their `travel` and `contacts`.
    """
    world = troupe.load(result.world)
    region = load(world.loaded.folder / world.map.file)
    told = world.controllers["fcdfs"].args
    grid = simulate(region, told["rule"], seed=result.seed, q=told.get("q", 0.0))
    return {
        "cells": grid.cells,
        "agree": sum(agreeing(result, region, grid)),
        "steps": result.doors[0].steps[-1],
        "travel": sum(robot.properties.get("travel", 0) for robot in result.robots),
        "contacts": sum(robot.contacts for robot in result.robots),
    }


def _faults(result: Result, region: Region, grid: Outcome, cell: float) -> Iterator[str]:
    if result.outcome != "completed":
        yield f"outcome {result.outcome}"
    if len(result.robots) != grid.cells:
        yield f"{len(result.robots)} robots for {grid.cells} cells"
    for robot, same in zip(result.robots, agreeing(result, region, grid, cell), strict=True):
        if robot.error:
            yield f"{robot.name}: {robot.error}"
        if robot.contacts:
            yield f"{robot.name}: {robot.contacts} contacts"
        if not same:
            yield f"{robot.name}: not as in the grid model"
