"""`troupe sensors`: the sensors and actuators there are, their settings, defaults and units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.table import Table


def sensors() -> None:
    """Print the sensors and actuators, their settings, defaults and units."""
    from pydantic_core import PydanticUndefined  # noqa: PLC0415 - other commands stay quick
    from rich.console import Console  # noqa: PLC0415

    from sensors.registry import describe  # noqa: PLC0415
    from sim.worldfile.models import Sprayer  # noqa: PLC0415

    console = Console(highlight=False, markup=False)
    for entry in describe():
        console.print(_table("sensor", entry["name"], entry["summary"], entry["settings"]))
    rows = [
        {
            "name": name,
            "unit": "m",
            "required": info.is_required(),
            "default": None if info.default is PydanticUndefined else info.default,
            "description": info.description or "",
        }
        for name, info in Sprayer.model_fields.items()
        if name != "type"
    ]
    console.print(_table("actuator", "sprayer", (Sprayer.__doc__ or "").strip(), rows))


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
