"""Loads a world file: reads, checks and expands it, and tells all that is wrong at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sim.worldfile import nodes
from sim.worldfile.crowds import crowd_mistakes
from sim.worldfile.data import node_of
from sim.worldfile.extents import period_mistakes, physics_mistakes, port_mistakes, size_mistakes
from sim.worldfile.files import FileSet, folder_of, rebased
from sim.worldfile.mistakes import Mistake, WorldError, suggestion
from sim.worldfile.nodes import MappingNode, ScalarNode
from sim.worldfile.references import reference_mistakes
from sim.worldfile.robots import RobotSpec, expanded, name_mistakes, number_mistakes
from sim.worldfile.salvage import Salvaged, salvage
from sim.worldfile.schema import World
from sim.worldfile.sensing import with_settings
from sim.worldfile.settings import Refused, with_setting
from sim.worldfile.things import thing_name_mistakes

if TYPE_CHECKING:
    from sim.stage.layout import Layout


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
        from sim.stage.placement import place  # noqa: PLC0415

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
    path = Path(path)
    files = FileSet()
    root = files.read(path)
    if root is None:
        raise WorldError(files.mistakes)
    return _with_settings(root, path, settings, files)


def load_data(
    data: Mapping[str, Any], *, settings: Sequence[str] = (), folder: str | Path = "."
) -> LoadedWorld:
    """Loads a world that is given as Python data, with the strictness of a file.

    `folder` is where relative names of maps and programs start. Raises WorldError with every
    mistake that was found, each with its path in the data.
    """
    mistakes: list[Mistake] = []
    root = node_of(data, mistakes)
    if not isinstance(root, MappingNode):
        raise WorldError([Mistake((), "a world is a mapping", type(data).__name__)])
    name = root.items.get("name")
    label = name.value if isinstance(name, ScalarNode) and isinstance(name.value, str) else "world"
    path = Path(folder) / (label.replace("/", " ").replace("\0", " ") or "world")
    return _with_settings(root, path, settings, FileSet(mistakes))


def _with_settings(
    root: MappingNode, path: Path, settings: Sequence[str], files: FileSet
) -> LoadedWorld:
    """The world of a tree with settings laid upon it; raises WorldError."""
    mistakes = files.mistakes
    written = root
    for setting in settings:
        try:
            root = with_setting(root, setting)
        except Refused as error:
            mistakes += error.mistakes
    loaded, found = _checked(root, path, complete=files.complete)
    mistakes += [_meant(mistake, written) for mistake in located(found, root)]
    if mistakes or loaded is None:
        raise WorldError(in_order(mistakes, files.names))
    return loaded


def _checked(
    root: MappingNode, path: Path, *, complete: bool
) -> tuple[LoadedWorld | None, list[Mistake]]:
    """The world of a read file, or None, and what is wrong with it.

    Where a file that it includes could not be read (`complete` is false), what is missing may
    stand there: then only what does stand in the others is looked at.
    """
    folder = folder_of(path)
    data = rebased(nodes.plain(root), root, folder)
    ready, mistakes, wrong = with_settings(data, folder)
    found = salvage(ready, mistakes, wrong)
    if not complete:
        return None, [one for one in found.mistakes if nodes.at(root, one.where) is not None]
    world, mistakes = found.world, found.mistakes
    if world is None:
        return None, mistakes
    mistakes += reference_mistakes(data, found, folder)
    entries = [(found.index(("robots",), i), one) for i, one in enumerate(world.robots)]
    doors = [(found.index(("doors",), i), one) for i, one in enumerate(world.doors)]
    crowd = number_mistakes(entries)
    if crowd:
        return None, mistakes + crowd
    robots = tuple(expanded(entries))
    mistakes += name_mistakes(robots, doors)
    things = [(found.index(("obstacles",), i), one) for i, one in enumerate(world.obstacles)]
    mistakes += thing_name_mistakes(things, robots, doors)
    mistakes += port_mistakes(world, len(robots))
    if not found.lost("clock"):
        late = period_mistakes(world) + physics_mistakes(world)
        mistakes += [replace(one, where=_in_list(found, one.where)) for one in late]
    if found.lost("map"):
        return None, mistakes
    if found.lost("size"):
        return None, mistakes + _map_mistakes(world, folder)
    layout, start, more = _laid_out(world, folder, robots)
    mistakes += [replace(one, where=_in_list(found, one.where)) for one in more]
    if layout is None or start is None:
        return None, mistakes
    return LoadedWorld(world, path, folder, layout, robots, start, root), mistakes


def _map_mistakes(world: World, folder: Path) -> list[Mistake]:
    """What is wrong with the map, and with doors in it, whatever the world's size may be."""
    from sim.stage.layout import build_layout  # noqa: PLC0415

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
    from sim.stage.layout import build_layout  # noqa: PLC0415
    from sim.stage.placement import check_start, place  # noqa: PLC0415

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


def _meant(mistake: Mistake, written: MappingNode) -> Mistake:
    """A mistake in what a setting has made under a name that the file does not have.

    More likely than another model or controller, with too little in it, one of the file's is meant.
    """
    part, *rest = mistake.where or ("",)
    names = nodes.at(written, (part,))
    if mistake.line is not None or not rest or part not in ("models", "controllers"):
        return mistake
    name = str(rest[0])
    if not isinstance(names, MappingNode) or name in names.items:
        return mistake
    hint = suggestion(name, names.items)
    if not hint:
        return mistake
    return replace(mistake, what=f"{mistake.what}; the file has no {part}.{name}{hint}")


def _in_list(found: Salvaged, where: nodes.Path) -> nodes.Path:
    """A place in the salvaged world as a place in the file: obstacles and doors by their index."""
    if len(where) > 1 and where[0] in ("obstacles", "doors") and isinstance(where[1], int):
        return (where[0], found.index((where[0],), where[1]), *where[2:])
    return where


def located(mistakes: Iterable[Mistake], root: MappingNode) -> list[Mistake]:
    """The mistakes with file, line and column, where they have none yet."""
    return [locate(mistake, root) for mistake in mistakes]


def locate(mistake: Mistake, root: MappingNode) -> Mistake:
    """A mistake with its place: of the value at `where`, its key, or the part that lacks it."""
    if mistake.file is not None:
        return mistake
    mark = nodes.mark_of(root, mistake.where, at_key=mistake.at_key)
    return replace(mistake, file=mark.file, line=mark.line, column=mark.column)


def in_order(mistakes: Iterable[Mistake], files: Sequence[str]) -> list[Mistake]:
    """Mistakes by file in the order of reading, then by place; each once."""
    rank = {name: index for index, name in enumerate(files)}
    unique = dict.fromkeys(mistakes)
    return sorted(
        unique,
        key=lambda one: (rank.get(one.file or "", len(rank)), one.line or 0, one.column or 0),
    )
