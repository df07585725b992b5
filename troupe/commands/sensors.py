"""`troupe sensors`: the sensors and actuators there are, their settings, defaults and units."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.table import Table


READ_BY = {
    "scan": "LaserProxy",
    "elements": "RangerProxy",
    "intensities": "RangerProxy",
    "blobs": "BlobfinderProxy",
    "fiducials": "FiducialProxy",
    "bits": "BumperProxy",
    "scalars": "AioProxy",
}
"""Which proxy a program reads a kind of readings with."""


def sensors(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[FILE.py]...",
            help="Sensors of your own, instead of Troupe's.",
            show_default="Troupe's",
        ),
    ] = None,
) -> None:
    """Print the sensors and actuators, their settings, defaults and units.

    With files of sensors of one's own, print those: what a world file may say of each, and by which
    of Player's interfaces a program reads it. Exit code 2 if a file is no sensor.
    """
    from pydantic_core import PydanticUndefined  # noqa: PLC0415 - other commands stay quick
    from rich.console import Console  # noqa: PLC0415

    from sensors.registry import describe, load_file  # noqa: PLC0415
    from sim.worldfile.models import Gripper, Sprayer  # noqa: PLC0415

    console = Console(highlight=False, markup=False)
    if files:
        try:
            own = [load_file(file) for file in files]
        except ValueError as error:
            print(error, file=sys.stderr)
            raise typer.Exit(2) from None
        for file, entry in zip(files, describe(own), strict=True):
            title = f"{entry['summary']} (type: {file}; read by {READ_BY[entry['kind']]})"
            console.print(_table("sensor", entry["name"], title, entry["settings"]))
        return
    for entry in describe():
        console.print(_table("sensor", entry["name"], entry["summary"], entry["settings"]))
    for actuator in (Sprayer, Gripper):
        rows = [
            {
                "name": name,
                "unit": "m",
                "required": info.is_required(),
                "default": None if info.default is PydanticUndefined else info.default,
                "description": info.description or "",
            }
            for name, info in actuator.model_fields.items()
            if name != "type"
        ]
        title = (actuator.__doc__ or "").strip()
        console.print(_table("actuator", actuator.__name__.lower(), title, rows))


def _table(kind: str, name: str, summary: str, settings: list[dict[str, Any]]) -> Table:
    from rich import box  # noqa: PLC0415
    from rich.table import Table  # noqa: PLC0415

    table = Table(title=f"{kind} {name}: {summary}", box=box.SIMPLE, title_justify="left")
    for heading in ("setting", "default", "unit", "what it is"):
        table.add_column(heading, overflow="fold")
    for row in settings:
        default = "(required)" if row["required"] else _text(row["default"])
        table.add_row(row["name"], default, row["unit"], row["description"])
    return table


def _text(value: Any) -> str:
    """A default as a world file would write it."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple | list):
        return "[" + ", ".join(_text(item) for item in value) + "]"
    return f"{value:g}" if isinstance(value, float) else str(value)
