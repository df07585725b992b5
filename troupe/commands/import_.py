"""`troupe import`: a world file of Stage's, and a configuration file of Player's, become ours."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from troupe.usage import told

if TYPE_CHECKING:
    from troupe.importers.stage import Converted, Note


def import_(
    world: Annotated[Path, typer.Argument(metavar="FILE.world", help="A world file of Stage's.")],
    cfg: Annotated[
        Path | None,
        typer.Argument(
            metavar="[FILE.cfg]",
            help="Player's configuration file: ports, indices, which ranger is a laser.",
            show_default="none",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "--output",
            "-o",
            metavar="WORLD.yaml",
            help="Where to write it.",
            show_default="FILE.yaml in the current folder",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Write over files that exist.")] = False,
    strict: Annotated[
        bool,
        typer.Option("--strict", help="Fail if anything is lost that changes what robots do."),
    ] = False,
) -> None:
    """Turn a world of Stage's into a world file, and list what could not be carried over.

    The list names file and line. Exit code 0: the world file is written and in order; 1: it is
    written, but something in it must be mended by hand, or with --strict something was not
    carried over; 2: the input has a mistake, or a file is in the way.
    """
    from troupe.importers.stage import StageError, convert  # noqa: PLC0415 - other commands stay quick

    target = output if output is not None else Path(f"{world.stem}.yaml")
    try:
        for source in (world, cfg):
            if source is not None and same(source, target):
                raise OSError(f"{target}: is what is to be imported; name another file with -o")
        converted = convert(str(world), None if cfg is None else str(cfg), target)
        write(converted, target, force)
    except (StageError, OSError) as error:
        print(told(error) if isinstance(error, OSError) else error, file=sys.stderr)
        raise typer.Exit(2) from None
    mistakes = mistakes_in(target)
    print("\n".join([*report(converted.notes), "", f"{target}: {verdict(target, mistakes)}"]))
    for mistake in mistakes:
        print(mistake, file=sys.stderr)
    lost = strict and any(note.kind == "lost" for note in converted.notes)
    raise typer.Exit(1 if mistakes or lost else 0)


def same(one: Path, other: Path) -> bool:
    """Whether two names are those of one file."""
    return one.exists() and other.exists() and one.samefile(other)


def write(converted: Converted, target: Path, force: bool) -> None:
    """Write the world file and the images beside it. Raises FileExistsError unless `force`."""
    from troupe.importers.stage.bitmap import write_png  # noqa: PLC0415  (loads OpenCV)

    for path in (target, *converted.images):
        if path.exists() and not force:
            raise FileExistsError(f"{path}: exists already (--force writes over it, -o elsewhere)")
    for path, walls in converted.images.items():
        write_png(path, walls)
    target.write_text(converted.text, encoding="utf-8")


def mistakes_in(target: Path) -> list[str]:
    """What is wrong with a world file, also with where its robots stand."""
    from sim.build import load  # noqa: PLC0415  (loads the compiled kernels)
    from sim.worldfile import WorldError  # noqa: PLC0415

    try:
        loaded = load(target)
        loaded.place(loaded.world.seed)
    except WorldError as error:
        return [str(mistake) for mistake in error.mistakes]
    return []


def verdict(target: Path, mistakes: Sequence[str]) -> str:
    """What came out, in a line."""
    if not mistakes:
        return f"written and in order (troupe run {target})"
    return f"written, but {len(mistakes)} thing(s) in it must be mended by hand"


def report(notes: Sequence[Note]) -> list[str]:
    """The notes as lines under headings: one for each thing, with how many places and the first."""
    from troupe.importers.stage.notes import HEADINGS  # noqa: PLC0415

    lines: list[str] = []
    for kind, group in itertools.groupby(notes, key=lambda note: note.kind):
        lines += [*([""] if lines else []), f"{HEADINGS[kind]}:"]
        alike: dict[str, list[Note]] = {}
        for note in group:
            alike.setdefault(note.what, []).append(note)
        for same in alike.values():
            more = f" (and in {len(same) - 1} more place{'s' * (len(same) > 2)})"
            lines.append(f"  {same[0]}{more if len(same) > 1 else ''}")
    return lines or ["everything was carried over"]
