"""What a user can get wrong on the command line, in the arguments of `troupe.run`, or around it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path


class UsageError(ValueError):
    """Says which option is at fault, and what would do."""


def told(error: OSError) -> str:
    """An error of the system with the file that it is about, without its number."""
    reason = error.strerror or str(error)
    return reason if error.filename is None else f"{error.filename}: {reason}"


def check_output(path: Path, endings: Sequence[str], what: str, *sources: Path) -> Path:
    """The file that something is to be written to, with links followed; nothing is written yet.

    Raises UsageError where that cannot be, or where it is one of the `sources` that it is made of.
    """
    from sim.video.errors import VideoError  # noqa: PLC0415 - `troupe --help` stays quick
    from sim.video.target import check_target  # noqa: PLC0415

    check_apart(path, *sources)
    try:
        return check_target(path, endings=endings, what=what)
    except VideoError as error:
        raise UsageError(str(error)) from error


def check_apart(path: Path, *sources: Path) -> None:
    """Raises UsageError for a file that is to be read as well as written."""
    for source in sources:
        if path.exists() and source.exists() and path.samefile(source):
            raise UsageError(f"{path}: is read for this; name another file to write")
