"""Properties of entities as numbers, texts, lengths, angles, poses and colours."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sensors.colors import format_color, parse_color
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.syntax import Entity, Property
from troupe.importers.stage.tokens import StageError

LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001}
ANGLES = {"degrees": 1.0, "radians": 180.0 / math.pi}
DEFAULT_COLOR = "red"
"""Stage's colour of everything that has none."""


@dataclass(frozen=True)
class Units:
    """What one unit of the file is: in metres, in degrees."""

    length: float = 1.0
    angle: float = 1.0


class Pose(NamedTuple):
    """x, y, z in metres, heading in degrees."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    a: float = 0.0

    def then(self, other: Pose) -> Pose:
        """`other`, given in the frame of this pose, in the frame that this pose is given in."""
        angle = math.radians(self.a)
        cos, sin = math.cos(angle), math.sin(angle)
        return Pose(
            self.x + cos * other.x - sin * other.y,
            self.y + sin * other.x + cos * other.y,
            self.z + other.z,
            self.a + other.a,
        )

    def seen_from(self, frame: Pose) -> Pose:
        """This pose in a frame that is given in the same frame as it."""
        angle = math.radians(frame.a)
        cos, sin = math.cos(angle), math.sin(angle)
        dx, dy = self.x - frame.x, self.y - frame.y
        return Pose(cos * dx + sin * dy, cos * dy - sin * dx, self.z - frame.z, self.a - frame.a)


def units_of(world: Entity) -> Units:
    """The file's units. Raises StageError."""
    found = []
    for key, known, default in (("unit_length", LENGTHS, "m"), ("unit_angle", ANGLES, "degrees")):
        name = text(world, key, default)
        if name not in known:
            place = world.properties[key].place
            raise StageError(place, f"{key} is {' or '.join(known)}, not {name}")
        found.append(known[name])
    return Units(*found)


def get(entity: Entity, key: str) -> Property | None:
    """A property, or None; it counts as used."""
    found = entity.properties.get(key)
    if found is not None:
        entity.used.add(key)
    return found


def text(entity: Entity, key: str, default: str) -> str:
    """A text."""
    found = get(entity, key)
    if found is None or not found.values:
        return default
    value = found.values[0]
    return value if isinstance(value, str) else f"{value:g}"


def texts(entity: Entity, key: str) -> list[str]:
    """The texts of a tuple."""
    found = get(entity, key)
    return [str(value) for value in found.values] if found is not None else []


def numbers(entity: Entity, key: str, least: int = 1) -> list[float] | None:
    """The numbers of a property, None if there is none. Raises StageError below `least`."""
    found = get(entity, key)
    if found is None:
        return None
    values = []
    for value in found.values:
        try:
            values.append(float(value))
        except ValueError:
            raise StageError(found.place, f"{key} needs numbers, not {value!r}") from None
    if len(values) < least:
        raise StageError(found.place, f"{key} needs {least} numbers, {len(values)} are given")
    if not all(map(math.isfinite, values)):
        raise StageError(found.place, f"{key} needs finite numbers")
    return values


def number(entity: Entity, key: str, default: float) -> float:
    """A number."""
    found = numbers(entity, key)
    return default if found is None else found[0]


def pose(entity: Entity, key: str, units: Units, notes: Notes) -> Pose:
    """A pose [x y z heading]; [x y heading], as in Stage 2, is taken with a note."""
    found = numbers(entity, key, 3)
    if found is None:
        return Pose()
    if len(found) == 3:
        place = entity.properties[key].place
        notes.differs(
            place, f"{key} has 3 values: taken as x, y, heading, as Stage 2 did (Stage 4 needs 4)"
        )
        found.insert(2, 0.0)
    x, y, z, a = found[:4]
    return Pose(x * units.length, y * units.length, z * units.length, a * units.angle)


def size(
    entity: Entity, units: Units, default: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Extents along x, y, z in metres; z may be left out, as in Stage 2. Raises StageError."""
    found = numbers(entity, "size", 2)
    if found is None:
        return default
    x, y, *rest = (value * units.length for value in found)
    z = rest[0] if rest else default[2]
    if min(x, y, z) < 0.0:
        raise StageError(entity.properties["size"].place, "a size must not be below 0")
    return x, y, z


def color(entity: Entity, notes: Notes) -> str:
    """A colour as our world files write it; what Stage does not know is red there, and here."""
    rgba = numbers(entity, "color_rgba", 3)
    name = text(entity, "color", DEFAULT_COLOR)
    if rgba is not None:
        parts = [round(255 * min(1.0, max(0.0, part))) for part in rgba[:3]]
        return format_color(parts[0] << 16 | parts[1] << 8 | parts[2])
    if name == "random":
        return name
    try:
        parse_color(name)
    except ValueError:
        place = entity.properties["color"].place
        notes.differs(place, f"there is no colour {name}: {DEFAULT_COLOR} is taken, as in Stage")
        return DEFAULT_COLOR
    return name.lower().replace(" ", "")


def known_colors(names: Sequence[str]) -> tuple[list[str], list[str]]:
    """Colour names that there are, and those that there are not."""
    good, bad = [], []
    for name in names:
        try:
            parse_color(name)
        except ValueError:
            bad.append(name)
        else:
            good.append(name.lower().replace(" ", ""))
    return good, bad
