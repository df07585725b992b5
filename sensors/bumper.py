"""The bumper: switches around the body that close where it touches something.

A switch covers an arc of bearings about the sensor's place on the robot (its centre, unless the
pose says otherwise). The body touches in points and in straight stretches; each closes every
switch whose arc it meets, both ends included.
"""

import math
from typing import Self

import numpy as np
from pydantic import model_validator

from sensors.compiled import compiled
from sensors.grid import Flags, Floats, Ints
from sensors.readings import Bits
from sensors.registry import sensor
from sensors.settings import Count, Number, SensorSettings, setting
from sensors.view import View

Arc = tuple[Number, Number]
BORDER = 1e-9
"""Radians: a contact this near to the border of two switches closes both, rounding or not."""


class BumperSettings(SensorSettings):
    """Equal switches all around, or parts of one's own."""

    count: Count = setting(
        4,
        ge=1,
        le=360,
        unit="switches",
        description="so many equal switches all around, the first ahead, then counter-clockwise",
    )
    parts: tuple[Arc, ...] = setting(
        (),
        max_length=360,
        unit="deg, deg",
        description="instead of count: from which bearing to which (counter-clockwise) each "
        "switch reaches",
    )

    @model_validator(mode="after")
    def _without_height(self) -> Self:
        if self.z is not None:
            raise ValueError("a bumper has no height: it feels all that its body touches")
        return self

    @model_validator(mode="after")
    def _count_or_parts(self) -> Self:
        if self.parts and "count" in self.model_fields_set:
            raise ValueError("give count or parts, not both")
        for k, (begin, end) in enumerate(self.parts):
            if not 0.0 < end - begin <= 360.0:
                raise ValueError(
                    f"part {k} must reach counter-clockwise from its first bearing to a larger "
                    f"one, by 360 degrees at most, not from {begin} to {end}"
                )
        return self

    @property
    def arcs(self) -> tuple[tuple[float, float], ...]:
        """From which bearing to which each switch reaches, in radians."""
        width = 360.0 / self.count
        equal = tuple(((k - 0.5) * width, (k + 0.5) * width) for k in range(self.count))
        return tuple((math.radians(a), math.radians(b)) for a, b in self.parts or equal)


def _empty(settings: BumperSettings, n: int) -> Bits:
    return Bits.empty(n, len(settings.arcs), settings.arcs)


@sensor("bumper", kind="bits", settings=BumperSettings, readings=_empty)
def sense_bumps(settings: BumperSettings, view: View, readings: Bits) -> None:
    """Which switches around the body touch something."""
    assert readings.arcs is not None
    readings.bits[view.rows] = False
    contacts = view.contacts
    if len(contacts.robots):
        wanted = np.zeros(len(view.robots), np.bool_)
        wanted[view.rows] = True
        _close(
            readings.bits,
            wanted,
            view.robots,
            view.origins,
            np.searchsorted(view.robots, contacts.robots),
            np.ascontiguousarray(contacts.robots, np.int64),
            np.ascontiguousarray(contacts.points, np.float64),
            np.ascontiguousarray(
                contacts.points if contacts.ends is None else contacts.ends, np.float64
            ),
            readings.arcs,
        )


@compiled
def _close(
    bits: Flags,
    wanted: Flags,
    robots: Ints,
    origins: Floats,
    first_rows: Ints,
    touching: Ints,
    points: Floats,
    ends: Floats,
    arcs: Floats,
) -> None:
    """Close the switches that touch: robot touching[c], from points[c] to ends[c].

    first_rows[c] is the robot's first row.
    """
    turn = 2.0 * math.pi
    for c in range(touching.shape[0]):
        j = first_rows[c]
        while j < robots.shape[0] and robots[j] == touching[c]:
            if wanted[j]:
                ax, ay = points[c, 0] - origins[j, 0], points[c, 1] - origins[j, 1]
                bx, by = ends[c, 0] - origins[j, 0], ends[c, 1] - origins[j, 1]
                if ax * by - ay * bx < 0.0:  # counter-clockwise, so that it spans less than a turn
                    ax, ay, bx, by = bx, by, ax, ay
                begin = math.atan2(ay, ax) - origins[j, 2]
                cross, dot = ax * by - ay * bx, ax * bx + ay * by
                span = math.atan2(cross, dot)
                if dot <= 0.0 and cross <= 1e-9 * math.hypot(bx - ax, by - ay):
                    span = turn  # it touches at the very place from which bearings count
                for k in range(arcs.shape[0]):
                    ahead, behind = begin - arcs[k, 0], arcs[k, 0] - begin
                    ahead -= turn * math.floor((ahead + BORDER) / turn)
                    behind -= turn * math.floor((behind + BORDER) / turn)
                    # It begins within the arc, or the arc within it.
                    if ahead <= arcs[k, 1] - arcs[k, 0] + BORDER or behind <= span + BORDER:
                        bits[j, k] = True
            j += 1
