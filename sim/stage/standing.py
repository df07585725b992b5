"""What stands in a world or can be pushed there, as plain geometry: walls, obstacles, doors."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from sensors.eyes import EVERY_EYE, eyes
from sim.stage.geometry import Floats, pieces, placed, rectangle
from sim.stage.geometry import faces as parts_of
from sim.stage.levels import EVERY_LEVEL

Pose = tuple[float, float, float]
"""x, y, yaw in the world: metres and radians."""


class Look(NamedTuple):
    """What there is to see of a thing that stands: 0xRRGGBB, and from z to z + height in metres.

    seen_by: bits of `sensors.eyes`. What is not solid has no inside.
    """

    color: int
    height: float
    z: float = 0.0
    seen_by: int = EVERY_EYE
    solid: bool = True


@dataclass(frozen=True)
class Solid:
    """A standing convex body: a piece of a wall, or an obstacle.

    vertices (k, 2) counter-clockwise in the world. levels: the bits of the heights at which it
    stops others, none if it is not solid (see `levels`). Pieces of
    one thing (all blocks of a map) share `group`, so that a robot that slides from block to
    block touches one wall once. Chipmunk multiplies the coefficients of friction of two bodies
    that touch. circle: x, y and radius in metres of what is round; its vertices
    are those of a polygon of the same area, for pictures and placement. landmark: sensors see it as
    one of the layout's landmarks.
    """

    vertices: Floats
    look: Look
    friction: float
    group: int = 0
    circle: tuple[float, float, float] | None = None
    levels: int = EVERY_LEVEL
    landmark: bool = False


@dataclass(frozen=True)
class Movable:
    """An obstacle that robots can push: `body` of the schema, start pose (x, y, yaw) radians."""

    body: Any
    pose: tuple[float, float, float]
    color: int
    height: float
    mass: float
    friction: float = 0.5


@dataclass(frozen=True)
class Landmark:
    """An obstacle that stands and carries a fiducial: `body` of the schema, pose (x, y, yaw)."""

    body: Any
    pose: tuple[float, float, float]


@dataclass(frozen=True)
class Stood:
    """What an obstacle that stands is made of where it stands; see `Layout` for each."""

    solids: list[Solid]
    insides: list[Solid]
    obstacles: list[Floats]
    segments: Floats
    landmarks: list[Landmark]


@dataclass(frozen=True)
class Fixture:
    """An obstacle that stands and has a name: nothing pushes it, but hands may put it elsewhere.

    body: of the schema. group: its solids'. start: where it stands in the world file, and pose:
    here. The slices say which parts of a layout are its own.
    """

    name: str
    body: Any
    group: int
    start: Pose
    pose: Pose
    solids: slice
    insides: slice
    obstacles: slice
    segments: slice
    landmarks: slice


def stood(entry: Any, pose: Pose, group: int, levels: int) -> Stood:
    """What an obstacle of the schema is made of at a pose. levels: at which it stops others."""
    look = Look(entry.color, entry.height, entry.z, eyes(entry.seen_by), entry.solid)
    alone = entry.fiducial is not None
    made = Stood([], [], [], np.zeros((0, 4)), [Landmark(entry, pose)] if alone else [])
    for vertices, circle in pieces(entry):
        at = placed(vertices, pose)
        around = None if circle is None else _moved(circle, pose)
        solid = Solid(at, look, entry.friction, group, around, levels, alone)
        made.solids.append(solid)
        if entry.solid and entry.z == 0.0:
            made.obstacles.append(at)
        if entry.solid and circle is None and not alone:
            made.insides.append(solid)
    sides = [made.segments]
    for vertices, circle in parts_of(entry) if not alone else ():
        if circle is None:
            begin = placed(vertices, pose)
            sides.append(np.concatenate([begin, np.roll(begin, -1, axis=0)], axis=1))
    return replace(made, segments=np.concatenate(sides))


def _moved(circle: tuple[float, float, float], pose: Pose) -> tuple[float, float, float]:
    """A circle (x, y, radius) of a body's frame in the world, for a body at a pose."""
    ((x, y),) = placed([circle[:2]], pose)
    return float(x), float(y), circle[2]


@dataclass(frozen=True)
class DoorCell:
    """A door: robots of `model` enter at `centre` with `heading` (radians), one by one.

    size: width and depth in metres of the upright cell that must be free. period in seconds.
    """

    name: str
    centre: tuple[float, float]
    size: tuple[float, float]
    heading: float
    period: float
    model: str
    controller: str | None

    @property
    def rectangle(self) -> Floats:
        """The door's cell (4, 2), counter-clockwise."""
        (x, y), (width, depth) = self.centre, self.size
        return rectangle(x - width / 2, y - depth / 2, x + width / 2, y + depth / 2)
