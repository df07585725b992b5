"""Stage's sensor models as the sensors of our world files."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from troupe.importers.stage import values
from troupe.importers.stage.beams import Beam, old_laser, old_transducers, range_of
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place
from troupe.importers.stage.values import Pose, Units

SENSORS = ("ranger", "laser", "sonar", "blobfinder", "fiducial", "fiducialfinder", "bumper")
"""Stage's types that become sensors of ours."""

HOUSED = ("ranger", "laser", "sonar")
"""Those of which clients may ask how large they are."""

RAY_FOV = 0.1
"""Degrees; for a beam without width, which a cone of ours must have."""
TRANSDUCER = 0.02
"""Metres: how tall a transducer is in Stage; its ray leaves from the middle."""
MOST_SAMPLES, MOST_PIXELS, MOST_SWITCHES = 100_000, 10_000, 360
"""What our sensors may have."""


@dataclass(frozen=True)
class Sensor:
    """A sensor as a mapping of the world file, and the model and line that it comes from."""

    data: dict[str, Any]
    thing: Thing
    place: Place


def sensors_of(
    robot: Thing, units: Units, scanners: Collection[str] | None, notes: Notes
) -> list[Sensor]:
    """The sensors of a robot in Stage's order.

    `scanners`: names of the rangers that a driver table serves as lasers; None without a table.
    A scan that is wanted as a laser, or of which nobody says, becomes a laser (which is served
    as a ranger too); any other a ranger.
    """
    found: list[Sensor] = []
    for thing in robot.all():
        kind = thing.entity.type
        if thing is robot or kind not in SENSORS:
            continue
        _note_looks(thing, notes)
        mount = thing.pose.seen_from(robot.pose)
        mount = mount._replace(a=round(math.remainder(mount.a, 360.0), 9)).then(thing.origin)
        if kind in HOUSED:
            as_laser = scanners is None or thing.name in scanners or kind == "laser"
            found += _ranging(thing, mount, units, as_laser, notes)
        elif kind == "blobfinder":
            found.append(_blobfinder(thing, mount, units, notes))
        elif kind == "bumper":
            found += _bumper(thing, mount, units, notes)
        else:
            found.append(_fiducial(thing, mount, units, notes))
    return found


def _note_looks(thing: Thing, notes: Notes) -> None:
    """What Stage draws of a sensor: sensors have no body, there and here."""
    entity = thing.entity
    drawn = {"color", "color_rgba", "size"} & set(entity.properties)
    if entity.type in HOUSED:
        drawn -= {"size"}
    entity.used |= drawn | {
        "size",
        "obstacle_return",
        "ranger_return",
        "blob_return",
        "gripper_return",
    }
    blocks = [child for child in entity.children if child.type == "block"]
    for block in blocks:
        block.used |= set(block.properties)
    if drawn or blocks:
        notes.looks(entity.place, "the colour, size or blocks of a sensor: it has no body")


def _housing(thing: Thing) -> dict[str, Any]:
    """The size of which a range finder tells its clients."""
    length, width, _ = thing.size
    told = "size" in thing.entity.properties and min(length, width) > 0.0
    return {"housing": [length, width]} if told else {}


def _placed(pose: Pose) -> dict[str, Any]:
    return {} if pose[:2] == (0.0, 0.0) and pose.a == 0.0 else {"pose": [pose.x, pose.y, pose.a]}


def _ranging(thing: Thing, mount: Pose, units: Units, as_laser: bool, notes: Notes) -> list[Sensor]:
    entity = thing.entity
    if entity.type == "laser":
        beams = [old_laser(thing, units, notes)]
    elif "scount" in entity.properties:
        beams = old_transducers(entity, units, notes)
    else:
        parts = [child for child in entity.children if child.type == "sensor"]
        beams = [_beam(part, units, notes) for part in parts]
    if not beams:
        notes.lost(entity.place, "a ranger without a sensor measures nothing")
        return []
    if all(beam.samples == 1 for beam in beams):
        return _cones(thing, mount, beams, notes)
    if len(beams) > 1:
        notes.differs(entity.place, "the several sensors of one ranger are devices of their own")
    found = []
    for beam in beams:
        if beam.samples == 1:
            found += _cones(thing, mount, [beam], notes)
            continue
        if beam.fov <= 0.0:
            notes.differs(beam.place, f"a scan of no width is {RAY_FOV:g} degrees wide here")
        data = {
            "type": "laser" if as_laser else "ranger",
            **_placed(mount.then(beam.pose)),
            **_height(thing, beam),
            "range": beam.range,
            **_near(beam),
            "fov": min(beam.fov, 360.0) if beam.fov > 0.0 else RAY_FOV,
            "samples": min(beam.samples, MOST_SAMPLES),
            **({"noise": beam.noise} if beam.noise else {}),
            **_housing(thing),
        }
        found.append(Sensor(data, thing, beam.place))
    return found


def _height(thing: Thing, beam: Beam) -> dict[str, Any]:
    """How high above the floor a beam leaves: what is lower or higher is not met, as in Stage."""
    if beam.z is None:
        return {}
    return {"z": thing.pose.z + thing.origin.z + beam.z}


def _near(beam: Beam) -> dict[str, Any]:
    return {"min_range": beam.min_range} if 0.0 < beam.min_range < beam.range else {}


def _cones(thing: Thing, mount: Pose, beams: list[Beam], notes: Notes) -> list[Sensor]:
    """Single beams as the elements of one ranger; of several heights as one for each."""
    place = thing.entity.place
    levels: dict[float | None, list[Beam]] = {}
    for beam in beams:
        levels.setdefault(beam.z, []).append(beam)
    if len(levels) > 1:
        notes.differs(
            place, "the sensors of a ranger at different heights are devices of their own"
        )
    notes.differs(place, "a sensor of one sample sees all of its fov here; Stage casts one ray")
    return [_ring(thing, mount, them, place if len(beams) > 1 else beams[0].place, notes)
            for them in levels.values()]  # fmt: skip


def _ring(thing: Thing, mount: Pose, beams: list[Beam], place: Place, notes: Notes) -> Sensor:
    first = beams[0]
    ranges, fovs = [beam.range for beam in beams], [max(beam.fov, RAY_FOV) for beam in beams]
    if any(beam.noise != first.noise or beam.min_range != first.min_range for beam in beams):
        notes.differs(place, "the sensors of one ranger have one noise and one least range here")
    data = {
        "type": "ranger",
        **_placed(mount),
        **_height(thing, first),
        "elements": [[beam.pose.x, beam.pose.y, beam.pose.a] for beam in beams],
        "range": ranges[0] if len(set(ranges)) == 1 else ranges,
        **_near(first),
        "fov": min(fovs[0], 360.0) if len(set(fovs)) == 1 else [min(fov, 360.0) for fov in fovs],
        **({"noise": first.noise} if first.noise else {}),
        **_housing(thing),
    }
    return Sensor(data, thing, place)


def _beam(part: Entity, units: Units, notes: Notes) -> Beam:
    if {"color", "color_rgba"} & set(part.properties):
        part.used |= {"color", "color_rgba"}
        notes.looks(part.place, "the colour, size or blocks of a sensor: it has no body")
    reach = values.numbers(part, "range") or [0.0, 5.0 / units.length]
    if reach[0] > 0.0 and len(reach) > 1:
        notes.unneeded(part.properties["range"].place, "a least range: Stage does not apply it")
    samples = max(1, int(values.number(part, "samples", 1)))
    fov = max(0.0, values.number(part, "fov", math.degrees(0.1) / units.angle) * units.angle)
    noise = 0.0
    found = values.numbers(part, "noise")
    if found is not None:
        noise = math.sqrt(max(0.0, found[0] * units.length))  # Stage takes it as a variance
        if any(found[1:]):
            notes.lost(
                part.properties["noise"].place,
                "noise in proportion to the range, and of angles: only the constant part is kept",
            )
    pose = values.pose(part, "pose", units, notes)
    tall = values.numbers(part, "size")
    z = pose.z + 0.5 * (tall[2] * units.length if tall and len(tall) > 2 else TRANSDUCER)
    far = range_of(part.place, reach[-1] * units.length, notes)
    return Beam(pose, far, fov, samples, noise, part.place, z=z)


def _blobfinder(thing: Thing, mount: Pose, units: Units, notes: Notes) -> Sensor:
    entity = thing.entity
    names: list[str] = []
    for list_of, count in (("colors", "colors_count"), ("channels", "channels_count")):
        told = values.texts(entity, list_of)
        if list_of == "colors" or count in entity.properties:
            told = told[: int(values.number(entity, count, 0))]
        names = names or told
    colors, unknown = values.known_colors(names)
    if unknown:
        where = entity.properties.get("colors") or entity.properties["channels"]
        for name in unknown:
            notes.lost(where.place, f"there is no colour {name} to look for")
    image = values.numbers(entity, "image") or [80.0, 60.0]
    columns, rows = (min(max(1, int(side)), MOST_PIXELS) for side in [*image, 60.0][:2])
    pan = values.number(entity, "pan", 0.0) * units.angle
    fov = min(values.number(entity, "fov", 60.0 / units.angle) * units.angle, 360.0)
    far = values.number(entity, "range", values.number(entity, "range_max", 12.0))
    data = {
        "type": "blobfinder",
        **_placed(mount._replace(a=mount.a + pan)),
        "range": range_of(entity.place, far, notes),  # never scaled by unit_length, in Stage
        "fov": fov if fov > 0.0 else RAY_FOV,
        "image": [columns, rows],
        "colors": colors,
    }
    return Sensor(data, thing, entity.place)


def _fiducial(thing: Thing, mount: Pose, units: Units, notes: Notes) -> Sensor:
    entity = thing.entity
    reach = values.number(entity, "range_max", 8.0 / units.length) * units.length
    near = values.number(entity, "range_max_id", 5.0 / units.length) * units.length
    least = values.number(entity, "range_min", 0.0) * units.length
    ids: dict[str, Any] = {"id_range": near} if 0.0 < near < reach else {}
    if near <= 0.0:
        notes.differs(entity.place, "range_max_id 0: ids are read as far as the finder sees here")
    fov = min(values.number(entity, "fov", 180.0 / units.angle) * units.angle, 360.0)
    height = {"z": thing.pose.z + thing.origin.z}
    if values.number(entity, "ignore_zloc", 0):
        height = {}
        notes.differs(
            entity.properties["ignore_zloc"].place,
            "ignore_zloc: what is lower or higher is found, and is in the way too",
        )
    data = {
        "type": "fiducial",
        **_placed(mount),
        **height,
        "range": range_of(entity.place, reach, notes),
        **({"min_range": least} if 0.0 < least < reach else {}),
        **ids,
        "fov": fov if fov > 0.0 else RAY_FOV,
    }
    return Sensor(data, thing, entity.place)


def _bumper(thing: Thing, mount: Pose, units: Units, notes: Notes) -> list[Sensor]:
    """Each bumper as the arc of bearings that it covers, seen from the robot's middle."""
    entity = thing.entity
    count = int(values.number(entity, "bcount", 0))
    if count < 1:
        notes.lost(entity.place, "a bumper without bcount feels nothing")
        return []
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
        "a bumper closes when the body touches something in its bearings; Stage casts a ray "
        "along it",
    )
    return [Sensor({"type": "bumper", "parts": parts[:MOST_SWITCHES]}, thing, entity.place)]
