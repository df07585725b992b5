"""Finds a world: a path, or the name of a world that comes with Troupe."""

from __future__ import annotations

import os
from pathlib import Path

SUFFIXES = (".yaml", ".yml")


def worlds_folder() -> Path | None:
    """The folder of the worlds that come with Troupe.

    Inside the installed package; in a checkout, beside the packages.
    """
    package = Path(__file__).resolve().parent
    for folder in (package / "worlds", package.parent / "worlds"):
        if folder.is_dir():
            return folder
    return None


def world_names() -> list[str]:
    """The names of the worlds that come with Troupe, sorted."""
    folder = worlds_folder()
    if folder is None:
        return []
    return sorted(path.stem for path in folder.iterdir() if path.suffix in SUFFIXES)


def find_world(world: str | Path) -> Path:
    """The file of a world: a path as it stands, or the name of one that comes with Troupe.

    A path that exists goes before a name; it may be a pipe, as /dev/stdin, which `-` stands for.
    Raises WorldError for what is neither.
    """
    text = str(world)
    path = Path("/dev/stdin" if text == "-" else world)
    if os.path.exists(path) and (not path.is_dir() or isinstance(world, Path)):
        return path
    folder = worlds_folder()
    if folder is not None and Path(text).name == text and text not in ("", ".", ".."):
        for suffix in ("", *SUFFIXES):
            shipped = folder / f"{text}{suffix}"
            if os.path.isfile(shipped) and shipped.suffix in SUFFIXES:
                return shipped
    from sim.worldfile.mistakes import (  # noqa: PLC0415 - loads the schema
        Mistake,
        WorldError,
        listed,
        suggestion,
    )

    names = world_names()
    near = _beside(path) or suggestion(path.stem, names)
    what = (
        "is a folder, not a world file" if text and os.path.isdir(path) else f"no such world{near}"
    )
    allowed = (
        f"a file, or a world that comes with Troupe: {listed(names, 30)}" if names else "a file"
    )
    raise WorldError([Mistake((), what, None, allowed, text or "''")])


def _beside(path: Path) -> str:
    """What a path may have meant: a file of its folder with nearly its name."""
    try:
        names = sorted(entry.name for entry in path.parent.iterdir() if entry.suffix in SUFFIXES)
    except OSError:
        return f"; there is no folder {path.parent}"
    from sim.worldfile.mistakes import suggestion  # noqa: PLC0415 - loads the schema

    return suggestion(path.name, names)
