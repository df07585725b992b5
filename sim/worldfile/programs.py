"""Controller programs: Troupe's own by name, found without importing them, and Python files."""

from __future__ import annotations

import importlib.util
import re
from functools import cache
from pathlib import Path

LARGEST_PROGRAM = 2_000_000
"""Bytes of a Python file."""

_RUNS_AS_PROGRAM = re.compile(r"""^if __name__ == ["']__main__["']:""", re.MULTILINE)


def is_file_name(program: str) -> bool:
    """Whether a `program` names a file rather than one of Troupe's controllers."""
    return "/" in program or "\\" in program or program.endswith(".py")


@cache
def _folders() -> tuple[Path, ...]:
    """Where Troupe's controllers lie: beside this package, as in a checkout and in a wheel.

    A folder `controllers` of the user's own in the current directory is never meant.
    """
    beside = Path(__file__).resolve().parents[2] / "controllers"
    if beside.is_dir():
        return (beside,)
    spec = importlib.util.find_spec("controllers")
    places = spec.submodule_search_locations if spec is not None else None
    return tuple(Path(place) for place in places or ())


def find_program(name: str) -> str | None:
    """The module to run (`python -m`) for one of Troupe's controllers, or None.

    A controller is a module right under `controllers` that ends in `if __name__ == "__main__":`,
    or a package with a `__main__` module; what lies deeper are their parts.
    """
    return f"controllers.{name}" if name in programs() else None


@cache
def programs() -> tuple[str, ...]:
    """The names of Troupe's controllers, sorted."""
    names: set[str] = set()
    for folder in _folders():
        names |= {entry.parent.name for entry in folder.glob("*/__main__.py")}
        names |= {entry.stem for entry in folder.glob("*.py") if _is_program(entry)}
    return tuple(sorted(names))


def _is_program(path: Path) -> bool:
    if not path.is_file() or path.name.startswith("_"):
        return False
    return bool(_RUNS_AS_PROGRAM.search(path.read_text(encoding="utf-8", errors="replace")))
