"""The ranger: a ring of elements that each measure the nearest thing in a cone, or one scan."""

import math
from typing import Any, Self

import numpy as np
from pydantic import model_validator

from .cones import cast_cones
from .laser import fan_of
from .noise import add_element_noise, add_range_noise
from .readings import Elements, Fan, Scans, too_near
from .registry import sensor
from .settings import (
    Count,
    Housing,
    Number,
    Pose,
    SensorSettings,
    check_min_range,
    housing,
    setting,
)
from .view import View, place_elements


class RangerSettings(SensorSettings):
    """In sonar style unless `samples` is given: then one element that scans as a laser does."""

    elements: tuple[Pose, ...] = setting(
        ((0.0, 0.0, 0.0),),
        min_length=1,
        max_length=1000,
        unit="m, m, deg",
        description="where each element sits on the sensor, and where it looks",
    )
    range: Number = setting(
        5.0, gt=0, unit="m", description="how far it measures; the reading where nothing is near"
    )
    min_range: Number = setting(
        0.0, ge=0, unit="m", description="what is nearer than that reads 0: too near to measure"
    )
    fov: Number = setting(
        15.0, gt=0, le=360, unit="deg", description="the cone's width, or the scan's"
    )
    samples: Count | None = setting(
        None,
        ge=2,
        le=100_000,
        unit="rays",
        description="null: the nearest thing in the cone; a number: a scan of so many rays, "
        "which needs a single element",
    )
    noise: Number = setting(
        0.0, ge=0, unit="m", description="standard deviation of the noise on ranges that hit"
    )
    housing: Housing = housing()

    @model_validator(mode="after")
    def _measures_something(self) -> Self:
        check_min_range(self.min_range, self.range)
        return self

    @model_validator(mode="after")
    def _one_element_scans(self) -> Self:
        if self.samples is not None and len(self.elements) != 1:
            raise ValueError(
                f"samples needs a single element, but there are {len(self.elements)}: "
                "leave samples out, or make a ranger of each element"
            )
        return self

    @property
    def mount(self) -> tuple[float, float, float]:
        """The pose on the robot, in radians; for a scan that of its one element."""
        x, y, heading = self.pose[0], self.pose[1], math.radians(self.pose[2])
        if self.samples is None:
            return x, y, heading
        ex, ey, turn = self.elements[0]
        cos, sin = math.cos(heading), math.sin(heading)
        return x + cos * ex - sin * ey, y + sin * ex + cos * ey, heading + math.radians(turn)


def _empty(settings: RangerSettings, n: int) -> Scans | Elements:
    fov = math.radians(settings.fov)
    if settings.samples is not None:
        return Scans.empty(n, settings.samples, fov, settings.range)
    poses = np.array(settings.elements)
    poses[:, 2] = np.radians(poses[:, 2])
    return Elements.empty(n, poses, fov, settings.range)


def _fan(settings: RangerSettings, readings: Any) -> Fan | None:
    return fan_of(settings, readings) if isinstance(readings, Scans) else None


@sensor("ranger", kind="elements", settings=RangerSettings, readings=_empty, fan=_fan)
def sense_ranges(settings: RangerSettings, view: View, readings: Any) -> None:
    """Range to the nearest thing in the cone of each element; with `samples`, a scan."""
    if isinstance(readings, Scans):
        if settings.noise > 0.0:
            add_range_noise(
                readings.ranges,
                readings.hits,
                view.rows,
                view.keys,
                view.tick,
                settings.noise,
                settings.range,
            )
        too_near(readings.ranges, view.rows, settings.min_range)
        return
    count = len(readings.poses)
    places = place_elements(view.origins, view.rows, readings.poses)
    ranges = np.empty(len(places))
    own = np.repeat(view.entities[view.rows], count)
    cast_cones(view.scene.arrays, places, own, readings.fov, settings.range, ranges)
    readings.ranges[view.rows] = ranges.reshape(-1, count)
    if settings.noise > 0.0:
        add_element_noise(
            readings.ranges, view.rows, view.keys, view.tick, settings.noise, settings.range
        )
    too_near(readings.ranges, view.rows, settings.min_range)
