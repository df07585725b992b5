"""Message types as ROS 2 writes them down: their fields, and the text that a log carries."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parent / "definitions"
PRIMITIVES = {
    "bool": "?", "byte": "u1", "char": "u1", "int8": "i1", "uint8": "u1", "int16": "<i2",
    "uint16": "<u2", "int32": "<i4", "uint32": "<u4", "int64": "<i8", "uint64": "<u8",
    "float32": "<f4", "float64": "<f8",
}  # fmt: skip
"""numpy's names of the primitive types."""
FIELD = re.compile(r"([\w/]+)(\[(\d*)\])?\s+(\w+)")
NAME = re.compile(r"\w+/\w+", re.ASCII)
BETWEEN = "=" * 80 + "\n"


@dataclass(frozen=True)
class Field:
    """One field. `length`: None for a single value, 0 for a sequence, else of a fixed array."""

    name: str
    type: str
    length: int | None


@cache
def fields(name: str) -> tuple[Field, ...]:
    """The fields of a type such as `sensor_msgs/LaserScan`; constants are left out."""
    found = []
    for line in text(name).splitlines():
        match = FIELD.fullmatch(line.partition("#")[0].strip())
        if match is not None:
            kind, is_array, length, field = match.groups()
            found.append(Field(field, kind, int(length or 0) if is_array else None))
    return tuple(found)


@cache
def text(name: str) -> str:
    """A type's own definition. Raises KeyError for a type that we do not know."""
    if not NAME.fullmatch(name):
        raise KeyError(name)
    try:
        return (FOLDER / f"{name}.msg").read_text(encoding="utf-8")
    except FileNotFoundError:
        raise KeyError(name) from None


@cache
def whole(name: str) -> str:
    """A type's definition followed by those of all types in it, as MCAP's `ros2msg` wants it."""
    inside: dict[str, None] = {}

    def gather(one: str) -> None:
        for field in fields(one):
            if field.type not in PRIMITIVES and field.type != "string" and field.type not in inside:
                inside[field.type] = None
                gather(field.type)

    gather(name)
    return text(name) + "".join(f"{BETWEEN}MSG: {one}\n{text(one)}" for one in inside)
