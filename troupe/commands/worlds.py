"""`troupe worlds`: the worlds that come with Troupe, a line each."""

from __future__ import annotations

from pathlib import Path


def worlds() -> None:
    """List the worlds that come with Troupe, and the maps for `troupe disperse`.

    Run one by its name: `troupe run wander`.
    """
    from troupe.maps import map_files  # noqa: PLC0415 - `--help` stays quick
    from troupe.worlds import find_world, world_names  # noqa: PLC0415

    names = world_names()
    width = max(map(len, names), default=0)
    for name in names:
        print(f"{name:{width}}  {about(find_world(name))}".rstrip())
    print(f"\nmaps for `troupe disperse`: {', '.join(map_files())}")


def about(path: Path) -> str:
    """The sentence that a world file begins with, as a comment."""
    words: list[str] = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            break
        words.append(line.lstrip("# "))
        if line.rstrip().endswith((".", ":")):
            break
    first, stop, _ = " ".join(words).partition(". ")
    return first + "." if stop else first.rstrip(":")
