"""Stage's position models as models of robots: body, drive, localization, sensors."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from troupe.importers.stage import values
from troupe.importers.stage.carried import carried, fiducial_of, posed, rise_of
from troupe.importers.stage.energy import battery_of
from troupe.importers.stage.footprint import body_of, height_of
from troupe.importers.stage.grippers import grippers_of
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.returns import Returns
from troupe.importers.stage.sensing import SENSORS, Sensor, sensors_of
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.text import flow
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place, StageError
from troupe.importers.stage.values import Units

LIGHTS = ("blinkenlight", "lightindicator")
DRIVES = {"diff": "differential", "omni": "omnidirectional", "car": "car"}
LEAST_SPEED, LEAST_TURN = 1e-6, 1e-4
"""m/s and degrees/s of a drive that shall not do the one or the other."""
ODOM_ERROR = (0.03, 0.03, 0.0, 0.05)
"""Stage's default: the widths of the spreads of relative errors along x, y, z and of turns."""
CAR_STEERING = 45.0
"""Degrees to either side: Stage's cars have no limit, ours must have one."""


@dataclass(frozen=True)
class Robot:
    """A robot: its thing, and its model as the mappings of a world file."""

    thing: Thing
    stem: str
    body: dict[str, Any]
    drive: dict[str, Any] | None
    rest: dict[str, Any]
    sensors: tuple[Sensor, ...]
    grippers: tuple[Sensor, ...]
    place: Place

    @property
    def key(self) -> str:
        """Equal for robots that can share a model: those whose models are written alike."""
        parts = [one.data for one in (*self.sensors, *self.grippers)]
        return flow((self.stem, self.body, self.drive, self.rest, parts))


def robot_of(
    thing: Thing, units: Units, folder: str, scanners: Collection[str] | None, notes: Notes
) -> Robot:
    """The robot that a position model is. Raises StageError."""
    entity = thing.entity
    rest: dict[str, Any] = {**_localization(entity, units, notes), **fiducial_of(thing)}
    for child in thing.children:
        if child.entity.type not in (*SENSORS, "gripper"):
            _note_part(child, notes)
    rest |= battery_of(thing, notes)
    stem = next(iter(entity.macros), "robot")
    sensors = tuple(sensors_of(thing, units, scanners, notes))
    body = robot_body(thing, folder, notes)
    grippers = tuple(grippers_of(thing, notes))
    drive = _drive(entity, units, notes)
    return Robot(thing, stem, body, drive, rest, sensors, grippers, entity.place)


def robot_body(thing: Thing, folder: str, notes: Notes) -> dict[str, Any]:
    """A robot's body: its blocks or its bitmap, and the models that stand on it."""
    entity = thing.entity
    returns = Returns.of(entity, notes)
    shapes = carried(thing, folder, notes)
    if not shapes:
        notes.differs(entity.place, "a robot without blocks is a point that nobody meets or sees")
        return {"shape": "circle", "radius": 0.01, "solid": False, "seen_by": []}
    body = body_of(shapes) | height_of(rise_of(shapes, entity.place, notes))
    body["color"] = values.color(entity, notes)
    mass = values.numbers(entity, "mass")
    if mass is not None and mass[0] > 0.0:
        body["mass"] = mass[0]
    return body | returns.data


def _drive(entity: Entity, units: Units, notes: Notes) -> dict[str, Any] | None:
    name = values.text(entity, "drive", "diff")
    if name not in DRIVES:
        raise StageError(
            entity.properties["drive"].place, f"a drive is {', '.join(DRIVES)}, not {name}"
        )
    drive: dict[str, Any] = {"kind": DRIVES[name]}
    bounds = values.numbers(entity, "velocity_bounds", 8)
    speeds, turns = (1.0, 1.0), (90.0, 90.0)
    if bounds is not None:
        place = entity.properties["velocity_bounds"].place
        slow, fast = -bounds[0] * units.length, bounds[1] * units.length
        right, left = -bounds[6] * units.angle, bounds[7] * units.angle
        if not math.isclose(slow, fast) or not math.isclose(right, left):
            notes.differs(
                place, "velocity_bounds: one limit holds for both directions here, the greater one"
            )
        speeds, turns = (slow, fast), (right, left)
        aside = max(-bounds[2], bounds[3]) * units.length
        if name == "omni" and not math.isclose(aside, max(speeds)):
            notes.differs(place, "velocity_bounds: max_speed holds in every direction here")
    if max(*speeds, *turns) <= 0.0:
        notes.differs(
            entity.properties["velocity_bounds"].place, "a robot that cannot move has no drive here"
        )
        return None
    drive["max_speed"], drive["max_turn_rate"] = max(speeds), max(turns)
    for key, least in (("max_speed", LEAST_SPEED), ("max_turn_rate", LEAST_TURN)):
        if drive[key] < least:
            notes.differs(
                entity.properties["velocity_bounds"].place,
                f"velocity_bounds of zero: {key} is {least:g} here, as near to it as may be",
            )
            drive[key] = least
    if "acceleration_bounds" in entity.properties:
        entity.used.add("acceleration_bounds")
        notes.differs(
            entity.properties["acceleration_bounds"].place,
            "acceleration_bounds: without effect on velocity commands in Stage; here a drive has "
            "max_acceleration and max_turn_acceleration, which are left at their defaults",
        )
    wheelbase = values.number(entity, "wheelbase", 1.0 / units.length) * units.length
    if name == "car":
        drive |= {"wheelbase": wheelbase, "max_steering": CAR_STEERING}
        notes.differs(
            entity.place,
            f"a car steers by at most {CAR_STEERING:g} degrees here (no limit in Stage)",
        )
    if any(values.numbers(entity, "velocity") or ()):
        notes.lost(entity.properties["velocity"].place, "velocity: robots start at rest")
    return drive


def _localization(entity: Entity, units: Units, notes: Notes) -> dict[str, Any]:
    """What position2d reports, and from where odometry counts."""
    mode = values.text(entity, "localization", "gps")
    at = entity.properties.get("localization")
    place = at.place if at is not None else entity.place
    if mode not in ("gps", "odom"):
        raise StageError(place, f'localization is "gps" or "odom", not {mode}')
    if mode == "gps":
        return {"localization": "gps"}
    found: dict[str, Any] = {"localization": "odometry"}
    if "localization_origin" in entity.properties:
        found["odometry_origin"] = posed(values.pose(entity, "localization_origin", units, notes))
    told = values.numbers(entity, "odom_error") or list(ODOM_ERROR)
    ahead, aside, _, turn = (abs(part) for part in [*told, *ODOM_ERROR[len(told) :]][:4])
    if "odom_error" in entity.properties:
        notes.differs(
            entity.properties["odom_error"].place,
            "odom_error: proportions of which each run draws its own, up to half of them to either "
            "side, as Stage's manual says (Stage takes them as they are, theta as an angle)",
        )
    if max(ahead, aside, turn) > 0.0:
        found["odometry_noise"] = {"bias": [ahead, aside, turn]}
    return found


def _note_part(part: Thing, notes: Notes) -> None:
    """A child of a robot that is no sensor; models are parts of its body."""
    entity = part.entity
    if entity.type == "model":
        return
    told = said_of(entity)
    for below in part.all():
        below.entity.used |= set(below.entity.properties)
        if below is not part and below.entity.type not in (*SENSORS, "gripper"):
            notes.lost(below.entity.place, f"{below.entity.type} upon a {entity.type}")
    if entity.type == "position":
        notes.lost(entity.place, f"a robot upon a robot{told}")
    elif entity.type in LIGHTS:
        notes.looks(entity.place, f"{entity.type}: a light that nobody sees{told}")
    else:
        notes.lost(entity.place, f"{entity.type}: there is no such device here{told}")


def said_of(entity: Entity) -> str:
    """What is said of something that is not carried over, in brackets."""
    keys = [key for key in entity.properties if key not in ("name", "pose")]
    return f" ({', '.join(keys)})" if keys else ""
