"""Whether robots can fit into a world at all, by area: told at once, without a search."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from math import hypot, pi
from typing import Any

from sim.worldfile.mistakes import Mistake
from sim.worldfile.robots import RobotSpec
from sim.worldfile.schema import Body, Model
from sim.worldfile.shapes import BoxShape, CircleShape, Compound


def crowd_mistakes(
    robots: Sequence[RobotSpec], models: Mapping[str, Model], size: tuple[float, float]
) -> list[Mistake]:
    """The entry of randomly placed robots with which the world's area (m) would be too small.

    Necessary, not sufficient: bodies with half their margin around them are disjoint, and lie in
    the world without half a margin along its walls. Of several margins the least counts.
    """
    margins = [robot.placement.margin for robot in robots if robot.placement is not None]
    if not margins:
        return []
    half = min(margins) / 2
    room = max(0.0, size[0] - 2 * half) * max(0.0, size[1] - 2 * half)
    taken = sum(_area(models[one.model].body, 0.0) for one in robots if one.placement is None)
    placed = [one for one in robots if one.placement is not None]
    for entry, group in groupby(placed, key=lambda one: one.entry):
        members = list(group)
        taken += len(members) * _area(models[members[0].model].body, half)
        if taken > room:
            return [
                Mistake(
                    ("robots", entry),
                    f"{len(members)} robot(s) of model {members[0].model} do not fit here: "
                    f"with those before they need {taken:.4g} m2 of {room:.4g}",
                    None,
                    "fewer robots, a smaller margin, or a larger world",
                )
            ]
    return []


def _area(body: Body, around: float) -> float:
    """Area in m2 of a convex body with a border of width `around` (Steiner's formula).

    Of a compound body that of its largest part, without a border: no more than its own.
    """
    if isinstance(body, Compound):
        return max(_area_of(part, 0.0) for part in body.parts)
    return _area_of(body, around)


def _area_of(body: Any, around: float) -> float:
    if isinstance(body, CircleShape):
        return pi * (body.radius + around) ** 2
    if isinstance(body, BoxShape):
        length, width = body.size
        area, outline = length * width, 2 * (length + width)
    else:
        ring = list(zip(body.points, [*body.points[1:], body.points[0]], strict=True))
        area = sum(x1 * y2 - x2 * y1 for (x1, y1), (x2, y2) in ring) / 2
        outline = sum(hypot(x2 - x1, y2 - y1) for (x1, y1), (x2, y2) in ring)
    return area + outline * around + pi * around * around
