"""Stage's grippers as those of our world files."""

from __future__ import annotations

import math

from troupe.importers.stage import values
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.sensing import Sensor
from troupe.importers.stage.syntax import Entity
from troupe.importers.stage.things import Thing
from troupe.importers.stage.values import Pose

PADDLES = (0.66, 0.1)
"""Stage's default: length and thickness of the paddles, in lengths and widths of the gripper."""
LEAST = 1e-3
"""Metres of a space between paddles that could be none."""
BODY = (
    "color", "color_rgba", "obstacle_return", "ranger_return", "laser_return", "blob_return",
    "gripper_return", "fiducial_return", "mass", "bitmap",
)  # fmt: skip
"""What is said of a body."""


def grippers_of(robot: Thing, notes: Notes) -> list[Sensor]:
    """The grippers of a robot in Stage's order."""
    return [_gripper(robot, thing, notes) for thing in robot.of_type("gripper")]


def _gripper(robot: Thing, thing: Thing, notes: Notes) -> Sensor:
    entity = thing.entity
    told = values.numbers(entity, "paddle_size") or []
    long, thick = (*told[:2], *PADDLES[len(told) :])[:2]
    long, thick = min(max(long, 0.0), 1.0), min(max(thick, 0.0), 0.5)
    length, width, _ = thing.size
    mount = thing.pose.seen_from(robot.pose)
    mount = mount._replace(a=round(math.remainder(mount.a, 360.0), 9)).then(thing.origin)
    middle = mount.then(Pose(length * (1.0 - long) / 2.0))
    notes.differs(
        entity.place,
        "a gripper opens and closes at once here, has no body, and holds a thing where it lies "
        "(Stage moves it to the middle)",
    )
    _note_rest(entity, notes)
    data = {
        "type": "gripper",
        "pose": [middle.x, middle.y, middle.a],
        "space": [max(length * long, LEAST), max(width * (1.0 - 2.0 * thick), LEAST)],
    }
    return Sensor(data, thing, entity.place)


def _note_rest(entity: Entity, notes: Notes) -> None:
    state = values.texts(entity, "paddle_state")
    if state and (state[0] == "closed" or state[1:] == ["up"]):
        place = entity.properties["paddle_state"].place
        notes.differs(place, "paddle_state: a gripper is open at the start here, and has no lift")
    if values.number(entity, "autosnatch", 0):
        place = entity.properties["autosnatch"].place
        notes.lost(place, "autosnatch: a gripper closes when its program has it close")
    drawn = [key for key in BODY if key in entity.properties]
    blocks = [child for child in entity.children if child.type == "block"]
    entity.used |= set(drawn)
    for block in blocks:
        block.used |= set(block.properties)
    if drawn or blocks:
        what = f"{drawn[0] if drawn else 'block'}: a gripper has no body of its own"
        notes.looks(entity.place, what)
