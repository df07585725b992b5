"""Loads a world: what its file says, checked, and what is built of it before a run begins."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.stage.layout import Layout, build_layout
from sim.stage.limits import physics_mistakes
from sim.stage.placement import check_start, place
from sim.worldfile.checked import CheckedWorld, check_data, check_file, located
from sim.worldfile.crowds import crowd_mistakes
from sim.worldfile.extents import size_mistakes
from sim.worldfile.mistakes import Mistake, WorldError
from sim.worldfile.nodes import MappingNode
from sim.worldfile.robots import RobotSpec
from sim.worldfile.schema import World


@dataclass(frozen=True)
class LoadedWorld:
    """A world that holds: its values, what stands in it, and its robots one by one.

    `folder` is where relative names of maps and programs start. Random placement needs a
    seed, and is `place`.
    """

    world: World
    path: Path
    folder: Path
    layout: Layout
    robots: tuple[RobotSpec, ...]
    start: NDArray[np.float64]  # (n, 3): the poses with the world's own seed
    root: MappingNode  # the file as read, with the place of every key and value

    def place(self, seed: int) -> NDArray[np.float64]:
        """Where the robots start, (n, 3): x, y in m and yaw in radians.

        Raises WorldError, with places in the file, where they do not fit.
        """
        if seed == self.world.seed:
            return self.start.copy()
        try:
            return place(self.layout, self.robots, self.world.models, seed)
        except WorldError as error:
            raise WorldError(located(error.mistakes, self.root)) from None


def load(path: str | Path, *, settings: Sequence[str] = ()) -> LoadedWorld:
    """Loads a world file, with `--set` texts such as `models.a.drive.max_speed=0.3` laid upon it.

    Raises WorldError with every mistake that was found, in the file's order.
    """
    return build(check_file(path, settings))


def load_data(
    data: Mapping[str, Any], *, settings: Sequence[str] = (), folder: str | Path = "."
) -> LoadedWorld:
    """Loads a world that is given as Python data, with the strictness of a file.

    `folder` is where relative names of maps and programs start. Raises WorldError with every
    mistake that was found, each with its path in the data.
    """
    return build(check_data(data, settings, folder))


def build(checked: CheckedWorld) -> LoadedWorld:
    """Builds what a world file says; raises WorldError with all that is wrong in it.

    What holds of a world with mistakes is built too, so that two robots that overlap are told
    together with a word that is misspelt.
    """
    world, layout, start, mistakes = checked.world, None, None, list[Mistake]()
    lost = checked.valid_part.lost
    if world is not None:
        if not lost("clock"):
            mistakes += physics_mistakes(world)
        if lost("size") and not lost("map"):
            mistakes += _map_mistakes(world, checked.folder)
        elif not lost("map"):
            layout, start, more = _laid_out(world, checked.folder, checked.robots)
            mistakes += more
    error = checked.error(mistakes)
    if error is not None:
        raise error
    assert world is not None
    assert layout is not None
    assert start is not None
    return LoadedWorld(
        world, checked.path, checked.folder, layout, checked.robots, start, checked.root
    )


def _map_mistakes(world: World, folder: Path) -> list[Mistake]:
    """What is wrong with the map, and with doors in it, whatever the world's size may be."""
    if world.map is not None:
        try:
            build_layout(world.model_copy(update={"size": None}), folder)
        except WorldError as error:
            return error.mistakes
    return []


def _laid_out(
    world: World, folder: Path, robots: Sequence[RobotSpec]
) -> tuple[Layout | None, NDArray[np.float64] | None, list[Mistake]]:
    """The layout and the robots' places in it, each or None, and what is wrong with them."""
    try:
        layout = build_layout(world, folder)
    except WorldError as error:
        return None, None, error.mistakes
    mistakes = size_mistakes(world, layout.size)
    known = [robot for robot in robots if robot.model in world.models]
    mistakes += check_start(layout, known, world.models)
    poses = [robot.pose for robot in known if robot.pose is not None]
    if len(poses) == len(known):
        return layout, np.array(poses, dtype=np.float64).reshape(-1, 3), mistakes
    crowded = crowd_mistakes(known, world.models, layout.size)
    if crowded or any(one.where == ("region",) for one in mistakes):
        return layout, None, mistakes + crowded
    try:
        return layout, place(layout, known, world.models, world.seed), mistakes
    except WorldError as error:
        return layout, None, mistakes + error.mistakes
