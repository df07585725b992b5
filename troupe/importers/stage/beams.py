"""The single beams and scans that rangers are made of, and those of the models of Stage 2 and 3."""

from __future__ import annotations

from dataclasses import dataclass

from troupe.importers.stage import values
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place
from troupe.importers.stage.values import Pose, Units

LEAST_RANGE = 1e-6
"""Metres; for a sensor that sees nothing."""


@dataclass(frozen=True)
class Beam:
    """One transducer of a ranger. z: m above its sensor's floor, None for one without a height."""

    pose: Pose
    range: float
    fov: float
    samples: int
    noise: float
    place: Place
    min_range: float = 0.0
    z: float | None = None


def range_of(place: Place, far: float, notes: Notes) -> float:
    """A range that a sensor can have; of one without, it sees nothing."""
    if far > 0.0:
        return far
    notes.differs(place, f"a sensor without a range sees {LEAST_RANGE:g} m far here")
    return LEAST_RANGE


def old_laser(thing: Thing, units: Units, notes: Notes) -> Beam:
    """The laser model of Stage 2 and 3."""
    entity = thing.entity
    samples = max(1, int(values.number(entity, "samples", 180)))
    reach = values.number(entity, "range_max", 8.0 / units.length) * units.length
    near = values.number(entity, "range_min", 0.0) * units.length
    fov = max(0.0, values.number(entity, "fov", 180.0 / units.angle) * units.angle)
    if samples < 2:
        notes.differs(entity.place, "a laser of one sample is a ranger here")
    for key in ("resolution", "laser_sample_skip"):
        if values.number(entity, key, 1) > 1:
            place = entity.properties[key].place
            notes.differs(place, f"{key}: every ray of the laser is cast and told here")
    pose = values.numbers(entity, "pose")
    z = 0.5 * thing.size[2] if pose is None or len(pose) > 3 else None
    far = range_of(entity.place, reach, notes)
    return Beam(Pose(), far, fov, samples, 0.0, entity.place, near, z)


def old_transducers(entity: Entity, units: Units, notes: Notes) -> list[Beam]:
    """The ranger model of Stage 2 and 3: scount, spose[i], sview and sview[i]."""
    sizes = [key for key in entity.properties if key == "ssize" or key.startswith("ssize[")]
    entity.used |= {"sraycount", *sizes}
    if sizes:
        notes.looks(entity.place, f"{sizes[0]}: the colour, size or blocks of a sensor")
    if "sraycount" in entity.properties:
        place = entity.properties["sraycount"].place
        notes.unneeded(place, "sraycount: a sonar sees all of its cone here")
    count = int(values.number(entity, "scount", 0))
    common = values.numbers(entity, "sview") or []
    beams = []
    for index in range(count):
        found = values.numbers(entity, f"spose[{index}]", 3) or [0.0, 0.0, 0.0]
        x, y, a = found[0] * units.length, found[1] * units.length, found[2] * units.angle
        own = values.numbers(entity, f"sview[{index}]") or []
        defaults = [0.0, 5.0 / units.length, 15.0 / units.angle]
        near, far, fov = own[:3] + common[len(own) : 3] + defaults[max(len(own), len(common)) :]
        far = range_of(entity.place, far * units.length, notes)
        fov = max(fov * units.angle, 0.0)
        pose = Pose(x, y, 0.0, a)
        beams.append(Beam(pose, far, fov, 1, 0.0, entity.place, near * units.length))
    return beams
