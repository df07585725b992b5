"""The models of a Stage world with their poses in it, as a tree."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

from troupe.importers.stage import values
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.values import Pose, Units

TYPES = frozenset(
    {
        *("model", "position", "ranger", "blobfinder", "fiducial", "bumper", "gripper", "camera"),
        *("actuator", "blinkenlight", "lightindicator"),
        *("laser", "sonar", "fiducialfinder", "ptz", "power", "speech", "audio", "wifi"),
        *("block", "sensor", "window"),
    }
)
"""Types of entities in a world file: Stage 4's, and those of older versions that became others."""

PARTS = frozenset({"block", "sensor", "window"})
"""Entities that are no models of their own."""

NO_BODY = frozenset(
    {"ranger", "laser", "sonar", "blobfinder", "fiducial", "fiducialfinder", "bumper"}
)
"""Types of models without a body: nobody sees them or bumps into them."""

MODEL_SIZE = (0.4, 0.4, 1.0)
SIZES = {
    "ranger": (0.15, 0.15, 0.2),
    "laser": (0.15, 0.15, 0.2),
    "gripper": (0.2, 0.3, 0.2),
}
"""Metres; Stage's defaults: by type, and for anything else MODEL_SIZE."""


@dataclass
class Thing:
    """A model: its name in Stage, its pose in the world, its size and its children."""

    entity: Entity
    name: str
    pose: Pose
    size: tuple[float, float, float]
    origin: Pose
    parent: Thing | None = None
    children: list[Thing] = field(default_factory=list)

    def all(self) -> Iterator[Thing]:
        """This thing and all below it."""
        yield self
        for child in self.children:
            yield from child.all()

    def of_type(self, *types: str) -> list[Thing]:
        """The things below this one of some type, in Stage's order."""
        return [thing for thing in self.all() if thing is not self and thing.entity.type in types]


def is_movable(thing: Thing) -> bool:
    """Whether a model can be pushed about, with all that stands on it."""
    entity = thing.entity
    return entity.type == "model" and values.number(entity, "gripper_return", 0) != 0


def things_in(world: Entity, units: Units, notes: Notes) -> list[Thing]:
    """The models at the top of a world, with their children. Raises StageError."""
    return _made(world, None, units, notes)


def _made(entity: Entity, parent: Thing | None, units: Units, notes: Notes) -> list[Thing]:
    found: list[Thing] = []
    numbers: Counter[str] = Counter()
    for child in entity.children:
        if child.type in PARTS:
            continue
        size = values.size(child, units, SIZES.get(child.type, MODEL_SIZE))
        own = values.pose(child, "pose", units, notes)
        pose, prefix = own, ""
        if parent is not None:
            pose, prefix = parent.pose.then(own), f"{parent.name}."
            if values.number(parent.entity, "stack_children", 1):
                pose = pose._replace(z=pose.z + parent.size[2])
        name = values.text(child, "name", "")
        if name.startswith("/"):
            name = name[1:]
        else:
            name = prefix + (name or f"{child.type}:{numbers[child.type]}")
        numbers[child.type] += 1
        origin = values.pose(child, "origin", units, notes)
        thing = Thing(child, name, pose, size, origin, parent)
        thing.children = _made(child, thing, units, notes)
        found.append(thing)
    return found
