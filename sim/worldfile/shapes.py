"""Bodies and obstacles in world files: box, circle and convex polygon."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from sim.worldfile.values import (
    BodyColor,
    Name,
    NonNegative,
    Part,
    Point,
    Pose,
    Positive,
    SeenBy,
    Size,
    wrong,
)

GRAY = 0x808080


def convex(points: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """The corners of a convex polygon, counter-clockwise.

    Raises the validator's error for fewer than three corners, corners that coincide, a
    polygon without area, and one that is not convex or winds more than once.
    """
    corners = tuple((float(x), float(y)) for x, y in points)
    if len(corners) < 3:
        raise wrong("a polygon has at least 3 corners", given=f"{len(corners)} corners")
    turns, extent = [], max(hypot(x - corners[0][0], y - corners[0][1]) for x, y in corners)
    for i, (x1, y1) in enumerate(corners):
        x2, y2 = corners[(i + 1) % len(corners)]
        x3, y3 = corners[(i + 2) % len(corners)]
        if hypot(x2 - x1, y2 - y1) <= 1e-9 * extent:
            raise wrong("this corner stands twice", given=[x2, y2], at=((i + 1) % len(corners),))
        turns.append((x2 - x1) * (y3 - y2) - (y2 - y1) * (x3 - x2))
    area = _signed_area(corners)
    if abs(area) <= 1e-12 * extent * extent:
        raise wrong("the polygon has no area", allowed="corners that are not all on one line")
    if area < 0:
        corners, turns = corners[::-1], [-turn for turn in turns]
    if min(turns) < -1e-9 * extent * extent or _winds_twice(corners):
        raise wrong(
            "the polygon is not convex", allowed="corners in order, no edge bent inwards or crossed"
        )
    return corners


def _signed_area(corners: Sequence[tuple[float, float]]) -> float:
    x0, y0 = corners[0]
    return 0.5 * sum(
        (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        for (x1, y1), (x2, y2) in zip(corners, [*corners[1:], corners[0]], strict=True)
    )


def _winds_twice(corners: Sequence[tuple[float, float]]) -> bool:
    """True for a star whose turns all go left: its x coordinate rises more than once a round."""
    steps = [b[0] - a[0] for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]
    signs = [step > 0 for step in steps if step != 0]
    return sum(a != b for a, b in zip(signs, [*signs[1:], signs[0]], strict=True)) > 2


ConvexPolygon = Annotated[tuple[Point, ...], AfterValidator(convex)]
"""Corners of a convex polygon; counter-clockwise after reading, whatever way they were written."""


class Thing(Part):
    """What bodies of all shapes have."""

    height: Positive = Field(default=1.0, description="m, from its lower end to its upper one")
    color: BodyColor = Field(default=GRAY, description="X11 name, #rrggbb, or random")
    mass: Positive = Field(default=10.0, description="kg")
    friction: NonNegative = Field(
        default=0.5, description="Coulomb's coefficient where bodies touch"
    )
    z: NonNegative = Field(
        default=0.0,
        description="m above the floor at which it begins; what shares no height never touches",
    )
    solid: bool = Field(
        default=True, description="false: nothing is stopped by it, as paint on the ground"
    )
    seen_by: SeenBy = Field(
        default=None,
        description="the kinds of sensor that see it, such as [laser, ranger]; [] for none. "
        "Default: all",
    )


class BoxShape(Part):
    """A rectangle, centred."""

    shape: Literal["box"] = Field(description="a rectangle, centred on its pose")
    size: Size = Field(description="length along the heading and width across it, m")


class CircleShape(Part):
    """A disc, centred."""

    shape: Literal["circle"] = Field(description="a disc, centred on its pose")
    radius: Positive = Field(description="m")


class PolygonShape(Part):
    """A convex polygon."""

    shape: Literal["polygon"] = Field(description="a convex polygon")
    points: ConvexPolygon = Field(description="corners [x, y] in the body's frame, m")


class Box(Thing, BoxShape):
    """A rectangle, centred."""


class Circle(Thing, CircleShape):
    """A disc, centred."""


class Polygon(Thing, PolygonShape):
    """A convex polygon in the body's frame."""


def simple(points: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """The corners of a polygon that may be concave, counter-clockwise.

    Raises the validator's error for fewer than three corners, no area, and edges that cross.
    """
    corners = tuple((float(x), float(y)) for x, y in points)
    if len(corners) < 3:
        raise wrong("a polygon has at least 3 corners", given=f"{len(corners)} corners")
    crossing = crossing_edges(corners)
    if crossing is not None:
        given = f"those from {list(corners[crossing[0]])} and from {list(corners[crossing[1]])}"
        raise wrong("edges of the polygon cross or touch", given=given, allowed="corners in order")
    extent = max(hypot(x - corners[0][0], y - corners[0][1]) for x, y in corners)
    area = _signed_area(corners)
    if abs(area) <= 1e-12 * extent * extent:
        raise wrong("the polygon has no area", allowed="corners that are not all on one line")
    return corners if area > 0 else corners[::-1]


def crossing_edges(corners: Sequence[tuple[float, float]]) -> tuple[int, int] | None:
    """The first two edges of a ring that meet without being neighbours."""
    count = len(corners)
    for i in range(count):
        a, b = corners[i], corners[(i + 1) % count]
        if a == b:
            return i, (i + 1) % count
        for j in range(i + 2, count - (i == 0)):
            c, d = corners[j], corners[(j + 1) % count]
            if _meet(a, b, c, d):
                return i, j
    return None


def _meet(
    a: tuple[float, float], b: tuple[float, float], c: tuple[float, float], d: tuple[float, float]
) -> bool:
    """Whether two segments have a point in common: either's ends lie on both sides of the other."""
    for axis in (0, 1):
        if max(a[axis], b[axis]) < min(c[axis], d[axis]):
            return False
        if max(c[axis], d[axis]) < min(a[axis], b[axis]):
            return False
    return _side(a, b, c) * _side(a, b, d) <= 0 and _side(c, d, a) * _side(c, d, b) <= 0


def _side(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    """Above 0 where c lies to the left of the line from a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


SimplePolygon = Annotated[tuple[Point, ...], Field(max_length=1000), AfterValidator(simple)]
"""Corners of a polygon without holes; counter-clockwise after reading."""
AT = "x, y in m and heading in degrees, in the body's frame"


class BoxPart(BoxShape):
    """A rectangle of a compound body."""

    pose: Pose = Field(default=(0.0, 0.0, 0.0), description=AT)


class CirclePart(CircleShape):
    """A disc of a compound body."""

    pose: Pose = Field(default=(0.0, 0.0, 0.0), description=AT)


class PolygonPart(Part):
    """A polygon of a compound body; it may be concave."""

    shape: Literal["polygon"] = Field(description="a polygon without holes")
    points: SimplePolygon = Field(description="corners [x, y] about its pose, m, in order")
    pose: Pose = Field(default=(0.0, 0.0, 0.0), description=AT)


class CompoundShape(Part):
    """Several parts that are one body."""

    shape: Literal["compound"] = Field(description="several parts that are one body")
    parts: Annotated[
        tuple[Annotated[BoxPart | CirclePart | PolygonPart, Field(discriminator="shape")], ...],
        Field(min_length=1, max_length=2000),
    ] = Field(description="its parts: boxes, circles and polygons")


class Compound(Thing, CompoundShape):
    """Several parts that are one body."""


class Standing(Thing):
    """What obstacles of all shapes have besides."""

    name: Name | None = Field(
        default=None, description="by which programs ask where it is; no two things share one"
    )
    pose: Pose = Field(description="x, y in m and heading in degrees")
    movable: bool = Field(default=False, description="true: robots can push it; it has `mass`")
    fiducial: Annotated[int, Field(ge=1, le=2**31 - 1)] | None = Field(
        default=None, description="an id that fiducial finders see"
    )
    charger: Positive | None = Field(
        default=None, description="W that it gives to the battery of each robot that touches it"
    )


class BoxObstacle(Box, Standing):
    """A box that stands in the world."""


class CircleObstacle(Circle, Standing):
    """A disc that stands in the world."""


class PolygonObstacle(Polygon, Standing):
    """A convex polygon that stands in the world."""


class CompoundObstacle(Compound, Standing):
    """Several parts that stand in the world as one."""


Body = Annotated[Box | Circle | Polygon | Compound, Field(discriminator="shape")]
Obstacle = Annotated[
    BoxObstacle | CircleObstacle | PolygonObstacle | CompoundObstacle,
    Field(discriminator="shape"),
]
