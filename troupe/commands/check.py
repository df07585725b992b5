"""`troupe check`: are these world files in order? All mistakes of each, with their places."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from sim.build import LoadedWorld


def check(
    worlds: Annotated[
        list[str], typer.Argument(metavar="WORLD...", help="Files, or names of shipped worlds.")
    ],
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="A value laid upon the files; repeatable.",
            show_default="no change",
        ),
    ] = None,
) -> None:
    """Check world files: one line for each that is in order, all mistakes of the others.

    Exit code 2 if there is any mistake.
    """
    from player.printable import printable  # noqa: PLC0415 - `troupe --help` stays quick
    from sim.worldfile.mistakes import WorldError  # noqa: PLC0415
    from troupe.worlds import find_world  # noqa: PLC0415

    refused = False
    for world in worlds:
        try:
            path = find_world(world)
            world_summary = summary(loaded(path, settings or ()))
        except WorldError as error:
            print(error, file=sys.stderr)
            refused = True
        else:
            print(printable(f"{path}: ok ({world_summary})"))
    if refused:
        raise typer.Exit(2)


def loaded(path: Path, settings: Sequence[str]) -> LoadedWorld:
    """The world of a file that is there; raises WorldError."""
    from sim.build import load  # noqa: PLC0415 - loads numba
    from troupe.compiling import Compiling  # noqa: PLC0415
    from troupe.warm import tell, warm_once  # noqa: PLC0415

    warm_once(tell)
    with Compiling():
        return load(path, settings=settings)


def summary(loaded: LoadedWorld) -> str:
    """What is in a world, in a line: robots, doors, size, models' sensors."""
    width, height = loaded.layout.size
    parts = []
    if loaded.robots or not loaded.layout.doors:
        parts.append(_counted(len(loaded.robots), "robot"))
    if loaded.layout.doors:
        parts.append(_counted(len(loaded.layout.doors), "door"))
    parts.append(f"{width:g} x {height:g} m")
    if loaded.world.obstacles:
        parts.append(_counted(len(loaded.world.obstacles), "obstacle"))
    drivers = Counter(robot.controller or "no controller" for robot in loaded.robots)
    drivers.update(door.controller or "no controller" for door in loaded.layout.doors)
    parts += [f"controller {name}" if name != "no controller" else name for name in drivers]
    return ", ".join(parts)


def _counted(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
