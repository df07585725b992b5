"""What stands in a Stage world: its extent, walls, map and obstacles, moved to our origin."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from troupe.importers.stage import values
from troupe.importers.stage.bitmap import Plan, read_plan
from troupe.importers.stage.footprint import Footprint, footprint
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.polygons import Polygon, area, bounds, cross
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place
from troupe.importers.stage.values import Pose

WALL = 0.01
"""Metres: how thick the walls are that Stage puts around a model with `boundary 1`."""

MARGIN = 1.0
"""Metres kept around everything in a world that no floorplan encloses."""


@dataclass
class Standing:
    """A model that stands in the world: a floorplan drawn by a bitmap, walls, or obstacles."""

    thing: Thing
    color: str
    height: float
    plan: Plan | None = None
    drawn: Footprint | None = None
    hollow: bool = False  # its outline is wall, and there are things inside
    movable: bool = False

    @property
    def pose(self) -> Pose:
        """Of the model, in Stage's world."""
        return self.thing.pose

    @property
    def corners(self) -> Polygon:
        """Of its bounding box, in Stage's world."""
        if self.plan is not None:
            length, width = self.plan.size
            middle = self.plan.pose
            low_x, low_y, high_x, high_y = -length / 2, -width / 2, length / 2, width / 2
        else:
            assert self.drawn is not None
            middle = self.pose
            low_x, low_y, high_x, high_y = bounds(self.drawn.hull)
        box = [(low_x, low_y), (high_x, low_y), (high_x, high_y), (low_x, high_y)]
        return [middle.then(Pose(x, y))[:2] for x, y in box]

    @property
    def corners_heading(self) -> float:
        """Degrees by which the bounding box is turned."""
        return self.plan.pose.a if self.plan is not None else self.pose.a

    @property
    def has_boundary(self) -> bool:
        """Whether there are walls around it."""
        return self.hollow or bool(values.number(self.thing.entity, "boundary", 0))


@dataclass
class Surroundings:
    """The still part of a world file; `corner` is our origin in Stage's world."""

    corner: tuple[float, float]
    size: tuple[float, float]
    frame: Standing | None
    plans: list[Standing] = field(default_factory=list)
    obstacles: list[tuple[dict[str, Any], Place]] = field(default_factory=list)

    def place(self, pose: Pose) -> list[float]:
        """A pose of Stage's world in ours: x, y and heading from -180 to 180 degrees."""
        heading = math.remainder(pose.a, 360.0)
        return [pose.x - self.corner[0], pose.y - self.corner[1], heading]


def standing(thing: Thing, folder: str, inside: Sequence[Thing], notes: Notes) -> Standing | None:
    """A model that stands in the world; None for one that can be neither touched nor kept.

    `inside`: robots; a model that has one within its outline is hollow, as all are in Stage.
    """
    entity = thing.entity
    bitmap = values.get(entity, "bitmap")
    solid = values.number(entity, "obstacle_return", 1) != 0
    seen = values.number(entity, "ranger_return", 1) >= 0
    place = entity.place
    color, height = values.color(entity, notes), thing.size[2]
    movable = values.number(entity, "gripper_return", 0) != 0
    found = Standing(thing, color, height if height > 0 else 1.0, movable=movable)
    if bitmap is not None and bitmap.values != ("",):
        pose = thing.pose.then(thing.origin)
        found.plan = read_plan(str(bitmap.values[0]), folder, pose, thing.size[:2], bitmap.place)
    else:
        found.drawn = footprint(thing, notes)
        if not found.drawn.pieces:
            return None
        outline = found.drawn.hull
        found.hollow = found.has_boundary or any(
            _within(robot.pose.seen_from(thing.pose)[:2], outline) for robot in inside
        )
    walls = found.plan is not None or found.hollow
    if not solid and not walls:
        lack = "lasers see it and robots drive through it" if seen else "a mark on the floor"
        notes.lost(place, f"{entity.word}: obstacle_return 0 ({lack}): everything is solid here")
        return None
    if not solid:
        notes.differs(
            place,
            f"{entity.word}: obstacle_return 0 (robots drive through it): its walls are solid here",
        )
    if not seen:
        notes.differs(place, f"{entity.word}: ranger_return below 0: rangers see it here")
    if movable and walls:
        found.movable = False
    elif movable:
        notes.differs(place, f"{entity.word}: gripper_return: robots can push it; nobody grips it")
    if thing.parent is not None and thing.pose.z > 1e-9:
        notes.differs(
            place, f"{entity.word}: stands on the floor here, not on {thing.parent.entity.word}"
        )
    return found


def _within(point: tuple[float, float], outline: Polygon) -> bool:
    return all(
        cross(a, b, point) > 0.0 for a, b in zip(outline, [*outline[1:], outline[0]], strict=True)
    )


def surroundings_of(
    found: Sequence[Standing], robots: Sequence[Thing], notes: Notes
) -> Surroundings:
    """Where the world ends, and everything in it in our coordinates."""
    frame = _frame(found, robots)
    if frame is not None:
        low_x, low_y, high_x, high_y = bounds(frame.corners)
    else:
        points = [corner for one in found for corner in one.corners]
        for robot in robots:
            reach = max(robot.size[:2])
            points += [(robot.pose.x - reach, robot.pose.y - reach)]
            points += [(robot.pose.x + reach, robot.pose.y + reach)]
        low_x, low_y, high_x, high_y = bounds(points or [(-5.0, -5.0), (5.0, 5.0)])
        low_x, low_y, high_x, high_y = (
            low_x - MARGIN, low_y - MARGIN, high_x + MARGIN, high_y + MARGIN,
        )  # fmt: skip
    surroundings = Surroundings((low_x, low_y), (high_x - low_x, high_y - low_y), frame)
    for one in found:
        if one.plan is not None:
            surroundings.plans.append(one)
        elif not one.hollow:
            surroundings.obstacles += _obstacles(one, surroundings, notes)
        if one is not frame and one.has_boundary:
            surroundings.obstacles += _walls(one, surroundings)
    return surroundings


def _frame(found: Sequence[Standing], robots: Sequence[Thing]) -> Standing | None:
    """The largest floorplan or walled model that stands upright and encloses all the rest."""
    upright = [
        one
        for one in found
        if (one.plan is not None or (one.hollow and _is_box(one)))
        and abs(math.remainder(one.corners_heading, 90.0)) < 1e-9
    ]
    points = [robot.pose[:2] for robot in robots] + [one.pose[:2] for one in found]
    for one in sorted(upright, key=lambda one: -area(one.corners)):
        low_x, low_y, high_x, high_y = bounds(one.corners)
        if all(low_x <= x <= high_x and low_y <= y <= high_y for x, y in points):
            return one
    return None


def _is_box(one: Standing) -> bool:
    assert one.drawn is not None
    return len(one.drawn.pieces) == 1 and math.isclose(area(one.drawn.hull), area(one.corners))


def _obstacles(
    one: Standing, surroundings: Surroundings, notes: Notes
) -> list[tuple[dict[str, Any], Place]]:
    assert one.drawn is not None
    place, pose = one.thing.entity.place, surroundings.place(one.pose)
    common: dict[str, Any] = {"pose": pose, "color": one.color, "height": one.height}
    if one.movable:
        common["movable"] = True
        mass = values.numbers(one.thing.entity, "mass")
        if mass is not None and mass[0] > 0:
            common["mass"] = mass[0]
    if one.drawn.box is not None:
        return [({"shape": "box", "size": list(one.drawn.box), **common}, place)]
    pieces = list(one.drawn.pieces)
    if one.movable and len(pieces) > 1:
        notes.differs(
            place, f"{one.thing.entity.word}: what can be pushed is convex here: its hull"
        )
        pieces = [one.drawn.hull]
    return [
        ({"shape": "polygon", "points": [list(corner) for corner in piece], **common}, place)
        for piece in pieces
    ]


def _walls(one: Standing, surroundings: Surroundings) -> list[tuple[dict[str, Any], Place]]:
    """The outline as thin boxes."""
    ring = one.corners
    if one.hollow and one.drawn is not None:
        ring = [one.pose.then(Pose(x, y))[:2] for x, y in one.drawn.hull]
    found = []
    for (x1, y1), (x2, y2) in zip(ring, [*ring[1:], ring[0]], strict=True):
        middle = Pose((x1 + x2) / 2, (y1 + y2) / 2, 0.0, math.degrees(math.atan2(y2 - y1, x2 - x1)))
        wall = {
            "shape": "box",
            "size": [math.dist((x1, y1), (x2, y2)), WALL],
            "pose": surroundings.place(middle),
            "color": one.color,
            "height": one.height,
        }
        found.append((wall, one.thing.entity.place))
    return found
