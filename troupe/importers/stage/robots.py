"""Stage's position models as models of robots: body, drive, localization, sensors."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from troupe.importers.stage import values
from troupe.importers.stage.bitmap import outline, read_plan
from troupe.importers.stage.footprint import footprint
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.polygons import Polygon, area
from troupe.importers.stage.sensing import SENSORS, Sensor, sensors_of
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.text import flow
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place, StageError
from troupe.importers.stage.values import Units

DRIVES = {"diff": "differential", "omni": "omnidirectional", "car": "car"}
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
    place: Place

    @property
    def key(self) -> str:
        """Equal for robots that can share a model: those whose models are written alike."""
        return flow((self.stem, self.body, self.drive, self.rest, [s.data for s in self.sensors]))


def robot_of(
    thing: Thing, units: Units, folder: str, scanners: Collection[str] | None, notes: Notes
) -> Robot:
    """The robot that a position model is. Raises StageError."""
    entity = thing.entity
    rest: dict[str, Any] = {"localization": _localization(entity, notes)}
    fiducial = int(values.number(entity, "fiducial_return", 0))
    if fiducial > 0:
        rest["fiducial"] = fiducial
    for child in thing.children:
        if child.entity.type not in SENSORS:
            _note_part(child, thing, notes)
    stem = next(iter(entity.macros), "robot")
    sensors = tuple(sensors_of(thing, units, scanners, notes))
    body = body_of(thing, folder, notes)
    return Robot(thing, stem, body, _drive(entity, units, notes), rest, sensors, entity.place)


def landmark_of(thing: Thing, folder: str, notes: Notes) -> Robot:
    """A model that carries a fiducial, as a robot that cannot move: only robots carry them here."""
    entity = thing.entity
    rest = {"fiducial": int(values.number(entity, "fiducial_return", 0))}
    stem = next(iter(entity.macros), "landmark")
    return Robot(thing, stem, body_of(thing, folder, notes), None, rest, (), entity.place)


def body_of(thing: Thing, folder: str, notes: Notes) -> dict[str, Any]:
    """A robot's body: a box, or the convex hull of its blocks or bitmap."""
    entity = thing.entity
    shape: list[Polygon] = []
    bitmap = values.get(entity, "bitmap")
    if bitmap is not None and bitmap.values != ("",):
        plan = read_plan(str(bitmap.values[0]), folder, thing.pose, thing.size[:2], bitmap.place)
        shape = [outline(plan)]
        if plan.walls.mean() < 1.0:
            notes.differs(bitmap.place, "a robot's body is the convex hull of its bitmap here")
    drawn = footprint(thing, notes, shape)
    if not drawn.pieces:
        raise StageError(entity.place, f"{entity.word} {thing.name}: a robot needs a body")
    body: dict[str, Any]
    if drawn.box is not None:
        body = {"shape": "box", "size": list(drawn.box)}
    else:
        corners = drawn.hull
        body = {"shape": "polygon", "points": [list(corner) for corner in corners]}
        # 1 %: blocks that overlap or leave slits between them do not matter to anybody
        if not shape and area(corners) > 1.01 * sum(map(area, drawn.pieces)):
            notes.differs(
                entity.place, f"{entity.word}: its body is the convex hull of its blocks here"
            )
    if thing.size[2] > 0.0:
        body["height"] = thing.size[2]
    body["color"] = values.color(entity, notes)
    mass = values.numbers(entity, "mass")
    if mass is not None and mass[0] > 0.0:
        body["mass"] = mass[0]
    return body


def _drive(entity: Entity, units: Units, notes: Notes) -> dict[str, Any]:
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
    if max(speeds) <= 0.0 or max(turns) <= 0.0:
        raise StageError(
            entity.properties["velocity_bounds"].place, "a robot that cannot move needs no drive"
        )
    drive["max_speed"], drive["max_turn_rate"] = max(speeds), max(turns)
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


def _localization(entity: Entity, notes: Notes) -> str:
    mode = values.text(entity, "localization", "gps")
    at = entity.properties.get("localization")
    place = at.place if at is not None else entity.place
    error = values.numbers(entity, "odom_error")
    origin = values.numbers(entity, "localization_origin")
    if mode not in ("gps", "odom"):
        raise StageError(place, f'localization is "gps" or "odom", not {mode}')
    if mode == "gps":
        notes.differs(
            place,
            "localization gps: positions count from the lower left corner of the world, not from "
            "Stage's origin (the world file says how far the two are apart)",
        )
        return "gps"
    if origin is not None and any(origin):
        notes.lost(
            entity.properties["localization_origin"].place,
            "localization_origin: odometry begins at (0, 0, 0), where the robot starts",
        )
    if error is not None:
        notes.lost(
            entity.properties["odom_error"].place,
            "odom_error: a factor drawn once per run; here odometry is exact, or drifts with "
            "`odometry_noise: {slip: ..., turn: ...}`",
        )
    else:
        notes.lost(
            place,
            "odom_error, by default 0.03 0.03 0 0.05 in Stage: here odometry is exact, or drifts "
            "with `odometry_noise: {slip: ..., turn: ...}`",
        )
    return "odometry"


def _note_part(part: Thing, robot: Thing, notes: Notes) -> None:
    """A child of a robot that is no sensor."""
    entity = part.entity
    for below in part.all():
        below.entity.used |= set(below.entity.properties)
    what = (
        f"{entity.type} {part.name}"
        if entity.word == entity.type
        else f"{entity.word} ({entity.type})"
    )
    if entity.type == "model":
        notes.lost(
            entity.place, f"{what}: a part of {robot.entity.word}, whose body is its own only"
        )
    elif entity.type == "position":
        notes.lost(entity.place, f"{what}: a robot upon a robot")
    else:
        notes.lost(entity.place, f"{what}: there is no such device here")
