"""Reads, checks and expands a world file: what it says so far as it holds, and all that is wrong.

Nothing is built here: what only shows once bodies stand in a world is added by who builds it
(`sim.build`), so that all mistakes are told at once.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sim.worldfile import nodes
from sim.worldfile.data import node_of
from sim.worldfile.extents import period_mistakes, port_mistakes
from sim.worldfile.files import FileSet, folder_of, rebased
from sim.worldfile.mistakes import Mistake, WorldError, suggestion
from sim.worldfile.nodes import MappingNode, ScalarNode
from sim.worldfile.references import reference_mistakes
from sim.worldfile.robots import RobotSpec, expanded, name_mistakes, number_mistakes
from sim.worldfile.schema import World
from sim.worldfile.sensing import with_settings
from sim.worldfile.settings import BadSetting, with_setting
from sim.worldfile.things import thing_name_mistakes
from sim.worldfile.valid_part import ValidPart, valid_part


@dataclass(frozen=True)
class CheckedWorld:
    """A world as its file says it, with the place of every value, and what is wrong with it.

    `folder` is where relative names of maps and programs start.
    """

    path: Path
    folder: Path
    root: MappingNode  # the file as read, settings laid upon it, with the place of every value
    world: World | None  # so far as it holds; None where there is too little to build anything of
    robots: tuple[RobotSpec, ...]
    mistakes: tuple[Mistake, ...]
    written: MappingNode  # the file as read, without settings
    files: tuple[str, ...]  # as shown, in the order of reading
    valid_part: ValidPart

    def error(self, more: Iterable[Mistake] = ()) -> WorldError | None:
        """All that is wrong, in the file's order; None if nothing is.

        `more` has been found besides, at places in `world`, whose lists may be shorter than the
        file's.
        """
        placed = [replace(one, where=_in_list(self.valid_part, one.where)) for one in more]
        meant = [_meant(one, self.written) for one in located(placed, self.root)]
        mistakes = [*self.mistakes, *meant]
        return WorldError(in_order(mistakes, self.files)) if mistakes else None


def check_file(path: str | Path, settings: Sequence[str] = ()) -> CheckedWorld:
    """Checks a world file, with `--set` texts such as `models.a.drive.max_speed=0.3` laid upon it.

    Raises WorldError where there is no file that can be read.
    """
    path = Path(path)
    files = FileSet()
    root = files.read(path)
    if root is None:
        raise WorldError(files.mistakes)
    return _with_settings(root, path, settings, files)


def check_data(
    data: Mapping[str, Any], settings: Sequence[str] = (), folder: str | Path = "."
) -> CheckedWorld:
    """Checks a world that is given as Python data, with the strictness of a file.

    `folder` is where relative names of maps and programs start. The place of a mistake is its path
    in the data. Raises WorldError where the data are no world at all.
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
) -> CheckedWorld:
    """The world of a tree with settings laid upon it."""
    mistakes = files.mistakes
    written = root
    for setting in settings:
        try:
            root = with_setting(root, setting)
        except BadSetting as error:
            mistakes += error.mistakes
    folder = folder_of(path)
    found, world, robots, wrong = _checked(root, folder, complete=files.complete)
    mistakes += [_meant(mistake, written) for mistake in located(wrong, root)]
    return CheckedWorld(
        path, folder, root, world, robots, tuple(mistakes), written, tuple(files.names), found
    )


def _checked(
    root: MappingNode, folder: Path, *, complete: bool
) -> tuple[ValidPart, World | None, tuple[RobotSpec, ...], list[Mistake]]:
    """What is left of a read file, the world to build, or None, its robots, and what is wrong.

    Where a file that it includes could not be read (`complete` is false), what is missing may
    stand there: then only what does stand in the others is looked at.
    """
    data = rebased(nodes.plain(root), root, folder)
    ready, mistakes, wrong = with_settings(data, folder)
    found = valid_part(ready, mistakes, wrong)
    world, mistakes = found.world, found.mistakes
    if not complete:
        there = [one for one in mistakes if nodes.at(root, one.where) is not None]
        return found, None, (), there
    if world is None:
        return found, None, (), mistakes
    mistakes += reference_mistakes(data, found, folder)
    entries = [(found.index(("robots",), i), one) for i, one in enumerate(world.robots)]
    doors = [(found.index(("doors",), i), one) for i, one in enumerate(world.doors)]
    crowd = number_mistakes(entries)
    if crowd:
        return found, None, (), mistakes + crowd
    robots = tuple(expanded(entries))
    mistakes += name_mistakes(robots, doors)
    things = [(found.index(("obstacles",), i), one) for i, one in enumerate(world.obstacles)]
    mistakes += thing_name_mistakes(things, robots, doors)
    mistakes += port_mistakes(world, len(robots))
    if not found.lost("clock"):
        late = period_mistakes(world)
        mistakes += [replace(one, where=_in_list(found, one.where)) for one in late]
    return found, world, robots, mistakes


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


def _in_list(found: ValidPart, where: nodes.Path) -> nodes.Path:
    """A place in the part that is left as one in the file: obstacles and doors by their index."""
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
