"""What stands in a world or can be pushed there, as plain geometry: walls, obstacles, doors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from sensors.eyes import EVERY_EYE
from sim.stage.geometry import Floats, rectangle
from sim.stage.levels import EVERY_LEVEL


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
