"""Finds a text map: a path, or the name of a map that comes with Troupe."""

from __future__ import annotations

import difflib
from pathlib import Path

from troupe.usage import UsageError
from troupe.worlds import worlds_folder

GRIDWORLD = Path(__file__).resolve().parent.parent / "gridworld" / "maps"


def map_files() -> dict[str, Path]:
    """The text maps that come with Troupe, by name, sorted."""
    shipped = worlds_folder()
    folders = [GRIDWORLD] if shipped is None else [shipped / "maps", GRIDWORLD]
    found = {path.stem: path for folder in folders for path in folder.glob("*.txt")}
    return dict(sorted(found.items()))


def find_map(map_file: Path) -> Path:
    """A path that exists as it stands, or the map of that name; raises UsageError for neither."""
    if map_file.exists():
        return map_file
    known = map_files()
    if map_file.name == str(map_file) and map_file.name.removesuffix(".txt") in known:
        return known[map_file.name.removesuffix(".txt")]
    near = difflib.get_close_matches(map_file.name, known, 1)
    hint = f"; did you mean {near[0]}?" if near else ""
    raise UsageError(
        f"{map_file}: No such file{hint} (a file, or a map that comes with Troupe: "
        f"{', '.join(known)})"
    )
