"""Stage's sensor models as the sensors of our world files."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from troupe.importers.stage import values
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place, StageError
from troupe.importers.stage.values import Pose, Units

SENSORS = ("ranger", "laser", "sonar", "blobfinder", "fiducial", "fiducialfinder", "bumper")
"""Stage's types that become sensors of ours."""

RAY_FOV = 0.1
"""Degrees; for a beam without width, which a cone of ours must have."""


@dataclass(frozen=True)
class Sensor:
    """A sensor as a mapping of the world file, and the model and line that it comes from."""

    data: dict[str, Any]
    thing: Thing
    place: Place


@dataclass(frozen=True)
class _Beam:
    """One transducer of a ranger."""

    pose: Pose
    range: float
    fov: float
    samples: int
    noise: float
    place: Place


def sensors_of(
    robot: Thing, units: Units, scanners: Collection[str] | None, notes: Notes
) -> list[Sensor]:
    """The sensors of a robot in Stage's order.

    `scanners`: names of the rangers that a driver table serves as lasers; None without a table.
    A scan that is wanted as a laser, or of which nobody says, becomes a laser (which is served
    as a ranger too); any other a ranger. Raises StageError.
    """
    found: list[Sensor] = []
    for thing in robot.all():
        kind = thing.entity.type
        if thing is robot or kind not in SENSORS:
            continue
        mount = thing.pose.seen_from(robot.pose)
        mount = mount._replace(a=round(math.remainder(mount.a, 360.0), 9)).then(thing.origin)
        if kind in ("ranger", "laser", "sonar"):
            as_laser = scanners is None or thing.name in scanners or kind == "laser"
            found += _ranging(thing, robot, mount, units, as_laser, notes)
        elif kind == "blobfinder":
            found.append(_blobfinder(thing, mount, units, notes))
        elif kind == "bumper":
            found.append(_bumper(thing, mount, units, notes))
        else:
            found.append(_fiducial(thing, mount, units, notes))
    return found


def _placed(pose: Pose) -> dict[str, Any]:
    return {} if pose[:2] == (0.0, 0.0) and pose.a == 0.0 else {"pose": [pose.x, pose.y, pose.a]}


def _ranging(
    thing: Thing, robot: Thing, mount: Pose, units: Units, as_laser: bool, notes: Notes
) -> list[Sensor]:
    entity = thing.entity
    if entity.type == "laser":
        beams = [_old_laser(entity, units, notes)]
    elif "scount" in entity.properties:
        beams = _old_transducers(entity, units, notes)
    else:
        parts = [child for child in entity.children if child.type == "sensor"]
        beams = [_beam(part, units, notes) for part in parts]
    if not beams:
        notes.lost(entity.place, f"{entity.word}: a ranger without a sensor measures nothing")
        return []
    _note_height(thing, robot, notes)
    if all(beam.samples == 1 for beam in beams):
        return [_cones(thing, mount, beams, notes)]
    if len(beams) > 1:
        notes.differs(
            entity.place, f"{entity.word}: its {len(beams)} sensors are devices of their own here"
        )
    found = []
    for beam in beams:
        if beam.samples == 1:
            found.append(_cones(thing, mount, [beam], notes))
            continue
        data = {
            "type": "laser" if as_laser else "ranger",
            **_placed(mount.then(beam.pose)),
            "range": beam.range,
            "fov": min(beam.fov, 360.0),
            "samples": beam.samples,
            **({"noise": beam.noise} if beam.noise else {}),
        }
        found.append(Sensor(data, thing, beam.place))
    return found


def _cones(thing: Thing, mount: Pose, beams: list[_Beam], notes: Notes) -> Sensor:
    """Single beams as the elements of one ranger."""
    place = thing.entity.place
    first = beams[0]
    widest = max(beam.range for beam in beams), max(beam.fov for beam in beams)
    if any((beam.range, beam.fov) != widest for beam in beams):
        notes.differs(place, "the sensors of one ranger see equally far and wide here: the most")
    notes.differs(
        place, f"{thing.entity.word}: a sensor of one sample sees all of its fov here; "
        "Stage casts one ray"
    )  # fmt: skip
    data = {
        "type": "ranger",
        **_placed(mount),
        "elements": [[beam.pose.x, beam.pose.y, beam.pose.a] for beam in beams],
        "range": widest[0],
        "fov": min(max(widest[1], RAY_FOV), 360.0),
        **({"noise": first.noise} if first.noise else {}),
    }
    return Sensor(data, thing, place if len(beams) > 1 else first.place)


def _beam(part: Entity, units: Units, notes: Notes) -> _Beam:
    part.used |= {"size", "color", "color_rgba"}
    reach = values.numbers(part, "range", 2) or [0.0, 5.0 / units.length]
    samples = int(values.number(part, "samples", 1))
    fov = values.number(part, "fov", math.degrees(0.1) / units.angle) * units.angle
    if reach[1] <= 0.0 or samples < 1 or fov < 0.0:
        raise StageError(part.place, "a sensor needs a range above 0, samples and a fov")
    noise = 0.0
    found = values.numbers(part, "noise", 3)
    if found is not None:
        noise = math.sqrt(max(0.0, found[0] * units.length))  # Stage takes it as a variance
        if found[1] or found[2]:
            notes.lost(
                part.properties["noise"].place,
                "noise in proportion to the range, and of angles: only the constant part is kept",
            )
    pose = values.pose(part, "pose", units, notes)
    return _Beam(pose, reach[1] * units.length, fov, samples, noise, part.place)


def _old_laser(entity: Entity, units: Units, notes: Notes) -> _Beam:
    """The laser model of Stage 2 and 3."""
    entity.used |= {"range_min", "laser_sample_skip"}
    samples = int(values.number(entity, "samples", 180))
    reach = values.number(entity, "range_max", 8.0 / units.length) * units.length
    fov = values.number(entity, "fov", 180.0 / units.angle) * units.angle
    if samples < 2 or reach <= 0.0 or fov <= 0.0:
        raise StageError(entity.place, "a laser needs at least 2 samples, a range_max and a fov")
    if values.number(entity, "resolution", 1) > 1:
        notes.differs(
            entity.properties["resolution"].place,
            "every ray of the laser is cast here, none guessed",
        )
    return _Beam(Pose(), reach, fov, samples, 0.0, entity.place)


def _old_transducers(entity: Entity, units: Units, notes: Notes) -> list[_Beam]:
    """The ranger model of Stage 2 and 3: scount, spose[i], sview."""
    entity.used |= {"ssize", "sraycount"} | {
        key for key in entity.properties if key.startswith("ssize[")
    }
    count = int(values.number(entity, "scount", 0))
    view = values.numbers(entity, "sview", 3) or [0.0, 5.0 / units.length, 15.0 / units.angle]
    beams = []
    for index in range(count):
        found = values.numbers(entity, f"spose[{index}]", 3) or [0.0, 0.0, 0.0]
        x, y, a = found[0] * units.length, found[1] * units.length, found[2] * units.angle
        pose = Pose(x, y, 0.0, a)
        fov = max(view[2] * units.angle, 0.0)
        beams.append(_Beam(pose, view[1] * units.length, fov, 1, 0.0, entity.place))
    if view[1] <= 0.0:
        raise StageError(entity.place, "sview needs a greatest range above 0")
    return beams


def _note_height(thing: Thing, robot: Thing, notes: Notes) -> None:
    """Stage's rangers look over what is lower than they are; ours see it."""
    height = thing.pose.z + 0.5 * thing.size[2]
    if thing.pose.z >= robot.pose.z + robot.size[2] > 0.0:
        notes.differs(
            thing.entity.place,
            f"{thing.entity.word} sits on top of its robot, {height:.2g} m high: in Stage it looks "
            "over what is lower, here it sees it",
        )


def _blobfinder(thing: Thing, mount: Pose, units: Units, notes: Notes) -> Sensor:
    entity = thing.entity
    names = values.texts(entity, "colors")
    names = names[: int(values.number(entity, "colors_count", 0))]
    colors, unknown = values.known_colors(names)
    for name in unknown:
        notes.lost(entity.properties["colors"].place, f"there is no colour {name} to look for")
    image = values.numbers(entity, "image", 2) or [80.0, 60.0]
    pan = values.number(entity, "pan", 0.0) * units.angle
    data = {
        "type": "blobfinder",
        **_placed(mount._replace(a=mount.a + pan)),
        "range": values.number(entity, "range", 12.0),  # never scaled by unit_length, in Stage
        "fov": min(values.number(entity, "fov", 60.0 / units.angle) * units.angle, 360.0),
        "image": [int(image[0]), int(image[1])],
        "colors": colors,
    }
    return Sensor(data, thing, entity.place)


def _fiducial(thing: Thing, mount: Pose, units: Units, notes: Notes) -> Sensor:
    entity = thing.entity
    reach = values.number(entity, "range_max", 8.0 / units.length) * units.length
    near = values.number(entity, "range_max_id", 5.0 / units.length) * units.length
    entity.used.add("ignore_zloc")
    if near < reach:
        notes.differs(
            entity.place,
            f"{entity.word}: ids can be read as far as fiducials are seen, {reach:g} m "
            f"(in Stage {near:g} m; beyond it the id is 0)",
        )
    if values.number(entity, "range_min", 0.0) > 0.0:
        notes.lost(entity.properties["range_min"].place, "range_min: the finder sees near ones too")
    fov = min(values.number(entity, "fov", 180.0 / units.angle) * units.angle, 360.0)
    return Sensor(
        {"type": "fiducial", **_placed(mount), "range": reach, "fov": fov}, thing, entity.place
    )


def _bumper(thing: Thing, mount: Pose, units: Units, notes: Notes) -> Sensor:
    """Each bumper as the arc of bearings that it covers, seen from the robot's middle."""
    entity = thing.entity
    count = int(values.number(entity, "bcount", 0))
    if count < 1:
        raise StageError(entity.place, "a bumper needs bcount and as many bpose[i]")
    common = values.number(entity, "blength", 0.1 / units.length)
    parts = []
    for index in range(count):
        pose = mount.then(values.pose(entity, f"bpose[{index}]", units, notes))
        half = 0.5 * values.number(entity, f"blength[{index}]", common) * units.length
        ends = [pose.then(Pose(0.0, side * half)) for side in (-1, 1)]
        begin, end = (math.degrees(math.atan2(y, x)) for x, y, _, _ in ends)
        span = math.remainder(end - begin, 360.0)
        if span < 0.0:  # seen from behind
            begin, span = end, -span
        span = max(span, 1e-3)
        parts.append([begin, begin + span])
    notes.differs(
        entity.place,
        f"{entity.word}: a bumper closes when the body touches something in its bearings; "
        "Stage casts a ray along it",
    )
    return Sensor({"type": "bumper", "parts": parts}, thing, entity.place)
