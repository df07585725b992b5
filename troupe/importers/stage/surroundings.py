"""What stands in a Stage world: its extent, walls, maps and obstacles, where Stage has them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from troupe.importers.stage import values
from troupe.importers.stage.bitmap import Plan, read_plan, rectangles
from troupe.importers.stage.carried import fiducial_of, name_of, posed
from troupe.importers.stage.energy import charger_of
from troupe.importers.stage.footprint import (
    FLAT,
    Rise,
    Shape,
    body_of,
    height_of,
    hull_of,
    shapes_of,
)
from troupe.importers.stage.notes import Notes
from troupe.importers.stage.polygons import Polygon, area, bounds, cross
from troupe.importers.stage.returns import Returns
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place
from troupe.importers.stage.values import Pose

WALL = 0.01
"""Metres: how thick the walls are that Stage puts around a model with `boundary 1`."""

MARGIN = 1.0
"""Metres kept around everything in a world that no floorplan encloses."""

MOST_PARTS = 1000
"""Parts of one obstacle; a bitmap of more rectangles becomes several."""


@dataclass
class Standing:
    """A model that stands in the world: a floorplan drawn by a bitmap, walls, or obstacles."""

    thing: Thing
    color: str
    rise: Rise
    returns: Returns
    plan: Plan | None = None
    shapes: list[Shape] = field(default_factory=list)
    hollow: bool = False  # its outline is wall, and there are things inside

    @property
    def pose(self) -> Pose:
        """Of the model, in the world."""
        return self.thing.pose

    def look(self, rise: Rise | None = None) -> dict[str, Any]:
        """What there is to see and touch of a part that reaches so high; of all unless told."""
        return {"color": self.color, **height_of(rise or self.rise), **self.returns.data}

    @property
    def is_wall(self) -> bool:
        """Whether it stops everybody and everybody sees it, as the boundary of a world."""
        return self.returns.solid and not self.returns.unseen

    @property
    def corners(self) -> Polygon:
        """Of its bounding box, in the world."""
        if self.plan is not None:
            length, width = self.plan.size
            middle = self.plan.pose
            low_x, low_y, high_x, high_y = -length / 2, -width / 2, length / 2, width / 2
        else:
            middle = self.pose
            low_x, low_y, high_x, high_y = bounds(self.hull)
        box = [(low_x, low_y), (high_x, low_y), (high_x, high_y), (low_x, high_y)]
        return [middle.then(Pose(x, y))[:2] for x, y in box]

    @property
    def hull(self) -> Polygon:
        """Of what it is made of, or of the box that is empty, in the model's frame."""
        if self.shapes:
            return hull_of(self.shapes)
        x, y = self.thing.size[0] / 2, self.thing.size[1] / 2
        return [self.thing.origin.then(Pose(*corner))[:2]
                for corner in ((-x, -y), (x, -y), (x, y), (-x, y))]  # fmt: skip

    @property
    def corners_heading(self) -> float:
        """Degrees by which the bounding box is turned."""
        return self.plan.pose.a if self.plan is not None else self.pose.a

    @property
    def has_boundary(self) -> bool:
        """Whether there are walls around it."""
        return bool(values.number(self.thing.entity, "boundary", 0)) or self.hollow


@dataclass
class Surroundings:
    """The still part of a world file; `corner` is the world's lower left corner."""

    corner: tuple[float, float]
    size: tuple[float, float]
    frame: Standing | None
    plans: list[Standing] = field(default_factory=list)
    obstacles: list[tuple[dict[str, Any], Place]] = field(default_factory=list)

    @property
    def origin(self) -> list[float] | str:
        """Where Stage's origin lies in our world, as `origin` says it."""
        (left, low), (width, height) = self.corner, self.size
        if math.isclose(left, -width / 2) and math.isclose(low, -height / 2):
            return "center"
        return [-left, -low]


def standing(thing: Thing, folder: str, inside: Sequence[Thing], notes: Notes) -> Standing | None:
    """A model that stands in the world; None for one that can be neither touched nor kept.

    `inside`: robots; a solid model that has one within its outline is hollow, as all are in Stage.
    """
    entity = thing.entity
    bitmap = values.get(entity, "bitmap")
    returns = Returns.of(entity, notes)
    bottom = thing.pose.z + thing.origin.z
    rise = bottom, bottom + max(thing.size[2], FLAT)
    found = Standing(thing, values.color(entity, notes), rise, returns)
    if rise[1] <= 0.0:
        notes.lost(entity.place, "a model below the floor: nobody meets or sees it")
        return None
    if bitmap is not None and bitmap.values != ("",):
        pose = thing.pose.then(thing.origin)
        found.plan = read_plan(str(bitmap.values[0]), folder, pose, thing.size[:2], bitmap.place)
        if found.plan is None:
            notes.differs(bitmap.place, "a bitmap without a dark pixel: nothing of it is solid")
            return found if found.has_boundary else None
        return found
    found.shapes = shapes_of(thing, folder, notes)
    if not found.shapes:
        return found if found.has_boundary else None
    found.hollow = found.has_boundary or (
        returns.solid
        and any(_within(robot.pose.seen_from(thing.pose)[:2], found.hull) for robot in inside)
    )
    return found


def _within(point: tuple[float, float], outline: Polygon) -> bool:
    return all(
        cross(a, b, point) > 0.0 for a, b in zip(outline, [*outline[1:], outline[0]], strict=True)
    )


def surroundings_of(
    found: Sequence[Standing],
    robots: Sequence[Thing],
    moving: Sequence[Mapping[str, Any]],
    notes: Notes,
) -> Surroundings:
    """Where the world ends, and everything that stands in it.

    robots: what else must lie in it; moving: obstacles that can be pushed likewise.
    """
    places = [robot.pose[:2] for robot in robots]
    places += [(one["pose"][0], one["pose"][1]) for one in moving]
    frame = _frame(found, places)
    if frame is not None:
        low_x, low_y, high_x, high_y = bounds(frame.corners)
    else:
        points = [corner for one in found for corner in one.corners] + places
        for robot in robots:
            reach = max(robot.size[:2])
            points += [(robot.pose.x - reach, robot.pose.y - reach)]
            points += [(robot.pose.x + reach, robot.pose.y + reach)]
        low_x, low_y, high_x, high_y = bounds(points or [(-5.0, -5.0), (5.0, 5.0)])
        low_x, low_y, high_x, high_y = (
            low_x - MARGIN, low_y - MARGIN, high_x + MARGIN, high_y + MARGIN,
        )  # fmt: skip
    surroundings = Surroundings((low_x, low_y), (high_x - low_x, high_y - low_y), frame)
    mapped = {id(one) for one in _mapped(found)}
    for one in found:
        if id(one) in mapped:
            surroundings.plans.append(one)
        elif not one.hollow:
            surroundings.obstacles += _obstacles(one, notes)
        if name_of(one.thing) and (id(one) in mapped or one.hollow):
            place = one.thing.entity.properties["name"].place
            notes.looks(place, "name of a floorplan or of walls: nobody asks where they are")
        if one.has_boundary and not (one is frame and one.is_wall):
            surroundings.obstacles += _walls(one)
    return surroundings


def _mapped(found: Sequence[Standing]) -> list[Standing]:
    """The floorplans that the one map of a world can hold: those that look as the largest does."""
    plans = [one for one in found if one.plan is not None and not one.returns.fiducial]
    if not plans:
        return []
    largest = max(plans, key=lambda one: one.plan.size[0] * one.plan.size[1])  # type: ignore[union-attr]
    if largest.rise[0] > 1e-9:
        return []
    return [one for one in plans if one.look() == largest.look()]


def _frame(found: Sequence[Standing], places: Sequence[tuple[float, ...]]) -> Standing | None:
    """The largest floorplan or walled model that stands upright and encloses all the rest."""
    upright = [
        one
        for one in found
        if (one.plan is not None or (one.has_boundary and _is_box(one)))
        and abs(math.remainder(one.corners_heading, 90.0)) < 1e-9
    ]
    points = [*places, *(one.pose[:2] for one in found)]
    for one in sorted(upright, key=lambda one: -area(one.corners)):
        low_x, low_y, high_x, high_y = bounds(one.corners)
        if all(low_x <= x <= high_x and low_y <= y <= high_y for x, y in points):
            return one
    return None


def _is_box(one: Standing) -> bool:
    return len(one.shapes) <= 1 and math.isclose(area(one.hull), area(one.corners))


def _obstacles(one: Standing, notes: Notes) -> list[tuple[dict[str, Any], Place]]:
    """Obstacles of all shapes that reach equally high, with a fiducial if there is one."""
    charger = charger_of(one.thing, notes)
    place, pose, shapes = one.thing.entity.place, one.pose, one.shapes
    if one.plan is not None:
        pose = one.plan.pose
        shapes = [Shape(corners, one.rise) for corners in rectangles(one.plan)]
    alike: dict[Rise, list[Shape]] = {}
    for shape in shapes:
        alike.setdefault(shape.rise, []).append(shape)
    found = []
    for number, (rise, them) in enumerate(alike.items()):
        for first in range(0, len(them), MOST_PARTS):
            data = {
                **(name_of(one.thing) if number == first == 0 else {}),
                **body_of(them[first : first + MOST_PARTS]),
                "pose": posed(pose),
                **one.look(rise),
                **(fiducial_of(one.thing) if number == first == 0 else {}),
                **charger,
            }
            found.append((data, place))
    above = any(child.entity.type == "model" for child in one.thing.children)
    if name_of(one.thing) and (above or len(found) > 1):
        what = "a client that puts it elsewhere moves its first part alone"
        notes.differs(place, f"{what}: parts of several heights, and models upon it, stand alone")
    return found


def _walls(one: Standing) -> list[tuple[dict[str, Any], Place]]:
    """The outline as thin boxes."""
    ring = one.corners
    if one.plan is None:
        ring = [one.pose.then(Pose(x, y))[:2] for x, y in one.hull]
    found = []
    for (x1, y1), (x2, y2) in zip(ring, [*ring[1:], ring[0]], strict=True):
        middle = Pose((x1 + x2) / 2, (y1 + y2) / 2, 0.0, math.degrees(math.atan2(y2 - y1, x2 - x1)))
        wall = {
            "shape": "box",
            "size": [math.dist((x1, y1), (x2, y2)), WALL],
            "pose": posed(middle),
            **one.look(),
        }
        found.append((wall, one.thing.entity.place))
    return found
