"""The cells of a world's doors: where they are, and how large."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.stage.geometry import outline, placed
from sim.stage.raster import Raster
from sim.stage.standing import DoorCell
from sim.worldfile.mistakes import Mistake, WorldError

if TYPE_CHECKING:
    from sim.worldfile.schema import Door, World


def door_cells(
    world: World, raster: Raster | None, cells: tuple[tuple[int, int], ...], is_text: bool
) -> tuple[DoorCell, ...]:
    """The doors with their places; those `at: S` take the map's S in reading order."""
    doors: list[DoorCell] = []
    mistakes: list[Mistake] = []
    waiting = iter(cells)
    lettered = sum(isinstance(door.at, str) for door in world.doors)
    if lettered and lettered != len(cells):
        index = next(i for i, door in enumerate(world.doors) if isinstance(door.at, str))
        what = "each door `at: S` needs an S of its own in the text map, and each S a door"
        given = f"{lettered} door(s), {len(cells)} S in the map"
        raise WorldError([Mistake(("doors", index, "at"), what, given)])
    for index, door in enumerate(world.doors):
        where = ("doors", index, "at")
        if isinstance(door.at, str):
            column, row = next(waiting)
        elif is_text and raster is not None:
            column, row = raster.at(*door.at)
            rows, columns = raster.walls.shape
            if not (0 <= column < columns and 0 <= row < rows) or raster.walls[row, column]:
                given = f"[{door.at[0]:g}, {door.at[1]:g}]"
                mistakes.append(Mistake(where, "the door is in a wall or off the map", given))
                continue
        if is_text and raster is not None:
            doors.append(_door(door, raster.centre(column, row), (raster.cell, raster.cell)))
        elif not isinstance(door.at, str) and door.model in world.models:
            doors.append(_door(door, door.at, _room(world.models[door.model].body, door.heading)))
    if mistakes:
        raise WorldError(mistakes)
    return tuple(doors)


def _room(body: Any, heading: float) -> tuple[float, float]:
    """Width and depth of the upright rectangle about the origin that a body takes at a heading."""
    vertices = placed(outline(body), (0.0, 0.0, math.radians(heading)))
    width, depth = 2 * np.abs(vertices).max(axis=0)
    return float(width), float(depth)


def _door(door: Door, centre: tuple[float, float], size: tuple[float, float]) -> DoorCell:
    heading = math.radians(door.heading)
    return DoorCell(door.name, centre, size, heading, door.period, door.model, door.controller)
