"""What can move in a Stage world: a model with all that stands on it is one thing."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from troupe.importers.stage import values
from troupe.importers.stage.energy import charger_of
from troupe.importers.stage.footprint import Rise, Shape, body_of, height_of, shapes_of
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.returns import Returns
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place
from troupe.importers.stage.values import Pose


def posed(pose: Pose) -> list[float]:
    """A pose as the world file has it: x, y and heading from -180 to 180 degrees."""
    return [pose.x, pose.y, math.remainder(pose.a, 360.0)]


def name_of(thing: Thing) -> dict[str, Any]:
    """The name of a model that was given one, by which programs ask where it is."""
    return {"name": thing.name} if "name" in thing.entity.properties else {}


def movable_of(thing: Thing, folder: str, notes: Notes) -> list[tuple[dict[str, Any], Place]]:
    """A model that can be pushed, with all that stands on it: one obstacle."""
    entity = thing.entity
    returns = Returns.of(entity, notes)
    shapes = carried(thing, folder, notes)
    if not shapes:
        return []
    mass = values.numbers(entity, "mass")
    data: dict[str, Any] = {
        **name_of(thing),
        **body_of(shapes),
        "pose": posed(thing.pose),
        "color": values.color(entity, notes),
        **height_of(rise_of(shapes, entity.place, notes)),
        "movable": True,
        **({"mass": mass[0]} if mass is not None and mass[0] > 0 else {}),
        **returns.data,
        **fiducial_of(thing),
        **next(filter(None, (charger_of(one, notes) for one in thing.all())), {}),
    }
    return [(data, entity.place)]


def carried(thing: Thing, folder: str, notes: Notes) -> list[Shape]:
    """The shapes of a model and of the models that stand on it, in its frame."""
    found = shapes_of(thing, folder, notes)
    for child in thing.children:
        if child.entity.type != "model":
            continue
        pose = child.pose.seen_from(thing.pose)
        parts = [shape.moved(pose) for shape in carried(child, folder, notes)]
        returns = Returns.of(child.entity, notes)
        if parts and returns != Returns.of(thing.entity, notes):
            notes.differs(
                child.entity.place, "a part of something is seen and touched as the whole is here"
            )
        if parts and values.color(child.entity, notes) != values.color(thing.entity, notes):
            notes.differs(
                child.entity.place, "a part of something has the colour of the whole here"
            )
        found += parts
    return found


def rise_of(shapes: Sequence[Shape], place: Place, notes: Notes) -> Rise:
    """From where to where the shapes of one body reach; what differs is noted."""
    low, high = min(one.rise[0] for one in shapes), max(one.rise[1] for one in shapes)
    if any(abs(one.rise[0] - low) + abs(one.rise[1] - high) > 1e-6 for one in shapes):
        notes.differs(
            place, "all parts of what can move are as high here: from the lowest to the highest"
        )
    return low, high


def fiducial_of(thing: Thing) -> dict[str, Any]:
    """The `fiducial` of a model that carries one."""
    number = int(values.number(thing.entity, "fiducial_return", 0))
    return {"fiducial": number} if number > 0 else {}
