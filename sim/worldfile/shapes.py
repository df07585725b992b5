"""Bodies and obstacles in world files: box, circle and convex polygon."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from sim.worldfile.values import Color, Name, NonNegative, Part, Point, Pose, Positive, Size, wrong

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


class Box(Part):
    """A rectangle, centred."""

    shape: Literal["box"] = Field(description="a rectangle, centred on the body's pose")
    size: Size = Field(description="length along the heading and width across it, m")
    height: Positive = Field(
        default=1.0, description="height above the floor, m; what a camera sees"
    )
    color: Color = Field(default=GRAY, description="X11 name or #rrggbb")
    mass: Positive = Field(default=10.0, description="kg")
    friction: NonNegative = Field(
        default=0.5, description="Coulomb's coefficient where bodies touch"
    )


class Circle(Part):
    """A disc, centred."""

    shape: Literal["circle"] = Field(description="a disc, centred on the body's pose")
    radius: Positive = Field(description="m")
    height: Positive = Field(
        default=1.0, description="height above the floor, m; what a camera sees"
    )
    color: Color = Field(default=GRAY, description="X11 name or #rrggbb")
    mass: Positive = Field(default=10.0, description="kg")
    friction: NonNegative = Field(
        default=0.5, description="Coulomb's coefficient where bodies touch"
    )


class Polygon(Part):
    """A convex polygon in the body's frame."""

    shape: Literal["polygon"] = Field(description="a convex polygon")
    points: ConvexPolygon = Field(description="corners [x, y] in the body's frame, m")
    height: Positive = Field(
        default=1.0, description="height above the floor, m; what a camera sees"
    )
    color: Color = Field(default=GRAY, description="X11 name or #rrggbb")
    mass: Positive = Field(default=10.0, description="kg")
    friction: NonNegative = Field(
        default=0.5, description="Coulomb's coefficient where bodies touch"
    )


class BoxObstacle(Box):
    """A box that stands in the world."""

    name: Name | None = Field(
        default=None, description="by which programs ask where it is; no two things share one"
    )
    pose: Pose = Field(description="x, y in m and heading in degrees")
    movable: bool = Field(default=False, description="true: robots can push it; it has `mass`")


class CircleObstacle(Circle):
    """A disc that stands in the world."""

    name: Name | None = Field(
        default=None, description="by which programs ask where it is; no two things share one"
    )
    pose: Pose = Field(description="x, y in m and heading in degrees")
    movable: bool = Field(default=False, description="true: robots can push it; it has `mass`")


class PolygonObstacle(Polygon):
    """A convex polygon that stands in the world."""

    name: Name | None = Field(
        default=None, description="by which programs ask where it is; no two things share one"
    )
    pose: Pose = Field(description="x, y in m and heading in degrees")
    movable: bool = Field(default=False, description="true: robots can push it; it has `mass`")


Body = Annotated[Box | Circle | Polygon, Field(discriminator="shape")]
Obstacle = Annotated[BoxObstacle | CircleObstacle | PolygonObstacle, Field(discriminator="shape")]
