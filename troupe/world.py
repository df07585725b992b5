"""A world as a Python object: the schema of world files, from a mapping or keyword arguments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

import yaml

from sim.build import LoadedWorld, load, load_data
from sim.worldfile.files import absolute, rebased
from sim.worldfile.nodes import plain
from troupe.setting import as_text
from troupe.worlds import find_world


class World:
    """A world that holds: checked whole when it is made, and then as it is.

    The keys are those of world files: `World(size=[10, 8], models={...}, robots=[...])`, or one
    mapping. What stands in it is read as attributes, checked and with the defaults filled in:
    `world.size`, `world.models["rover"].drive.max_speed`. `folder` is where relative names of maps
    and programs start; the current folder unless given.

    Raises sim.worldfile.WorldError with all that is wrong, each with its path in the data.

    >>> World(size=[4, 3], duration=2).size
    (4.0, 3.0)
    """

    def __init__(
        self, data: Mapping[str, Any] | None = None, /, *, folder: str | Path = ".", **keys: Any
    ) -> None:
        self.loaded = load_data({**(data or {}), **keys}, folder=folder)

    @classmethod
    def of(cls, loaded: LoadedWorld) -> Self:
        """The world that was loaded."""
        made = cls.__new__(cls)
        made.loaded = loaded
        return made

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name == "loaded":
            raise AttributeError(name)
        return getattr(self.loaded.world, name)

    def __dir__(self) -> list[str]:
        return sorted({*object.__dir__(self), *type(self.loaded.world).model_fields})

    def __repr__(self) -> str:
        width, height = self.loaded.layout.size
        what = self.loaded.world.name or self.loaded.path.name
        return f"<World {what!r}: {width:g} x {height:g} m, {len(self.loaded.robots)} robots>"

    def data(self) -> dict[str, Any]:
        """The world as plain mappings, lists and scalars, as it was given.

        Names of files start at the world's folder; those in files included from elsewhere are
        absolute.
        """
        root = self.loaded.root
        listed: dict[str, Any] = lists(rebased(plain(root), root, self.loaded.folder))
        return listed

    def with_settings(self, settings: Mapping[str, Any] | Sequence[str]) -> World:
        """Another world with changes, such as `{"models.rover.drive.max_speed": 0.3}`."""
        return World.of(
            load_data(self.data(), settings=as_text(settings), folder=self.loaded.folder)
        )

    def to_yaml(self, path: str | Path | None = None) -> str:
        """The text of a world file, which is also written to `path` if one is given.

        Names of files in it start at the folder of `path`, or else at the world's own.
        """
        data, folder = self.data(), self.loaded.folder.resolve()
        if path is not None and Path(path).resolve().parent != folder:
            data = lists(absolute(data, folder))
        text: str = yaml.safe_dump(data, sort_keys=False, default_flow_style=None)
        if path is not None:
            Path(path).write_text(text, encoding="utf-8")
        return text


def lists(value: Any) -> Any:
    """A value with lists in place of tuples, as YAML has them."""
    if isinstance(value, Mapping):
        return {key: lists(one) for key, one in value.items()}
    return [lists(one) for one in value] if isinstance(value, tuple | list) else value


def load_world(path: str | Path, *, set: Mapping[str, Any] | Sequence[str] = ()) -> World:
    """The world of a file, or of a name that comes with Troupe; raises WorldError."""
    return World.of(load(find_world(path), settings=as_text(set)))


def loaded_world(
    world: str | Path | Mapping[str, Any] | World, settings: Mapping[str, Any] | Sequence[str]
) -> LoadedWorld:
    """A world that holds, from wherever it comes, with settings laid upon it."""
    if isinstance(world, World):
        return world.with_settings(settings).loaded if settings else world.loaded
    if isinstance(world, Mapping):
        return load_data(world, settings=as_text(settings))
    return load(find_world(world), settings=as_text(settings))
