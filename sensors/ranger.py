"""The ranger: a ring of elements that each measure the nearest thing in a cone, or one scan."""

import math
from functools import cached_property, lru_cache
from typing import Annotated, Any, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from sensors.cones import cast_cones
from sensors.laser import fan_of
from sensors.noise import add_element_noise, add_range_noise
from sensors.readings import Elements, Fan, Scans, too_near
from sensors.registry import sensor
from sensors.settings import (
    Count,
    Housing,
    Number,
    Pose,
    SensorSettings,
    check_min_range,
    housing,
    setting,
)
from sensors.view import View, place_elements

Far = Annotated[Number, Field(gt=0)]
Wide = Annotated[Number, Field(gt=0, le=360)]


class RangerSettings(SensorSettings):
    """In sonar style unless `samples` is given: then one element that scans as a laser does."""

    elements: tuple[Pose, ...] = setting(
        ((0.0, 0.0, 0.0),),
        min_length=1,
        max_length=1000,
        unit="m, m, deg",
        description="where each element sits on the sensor, and where it looks",
    )
    range: Far | tuple[Far, ...] = setting(
        5.0,
        unit="m",
        description="how far it measures; the reading where nothing is near; or a list, one for "
        "each element",
    )
    min_range: Number = setting(
        0.0, ge=0, unit="m", description="what is nearer than that reads 0: too near to measure"
    )
    fov: Wide | tuple[Wide, ...] = setting(
        15.0,
        unit="deg",
        description="the cone's width, or the scan's; or a list, one for each element",
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
        for key, told in (("range", self.range), ("fov", self.fov)):
            if isinstance(told, tuple) and len(told) != len(self.elements):
                raise ValueError(
                    f"{key} needs one number, or one for each of {len(self.elements)} elements, "
                    f"not {len(told)}"
                )
        check_min_range(self.min_range, min(self.ranges))
        return self

    @model_validator(mode="after")
    def _one_element_scans(self) -> Self:
        if self.samples is not None and len(self.elements) != 1:
            raise ValueError(
                f"samples needs a single element, but there are {len(self.elements)}: "
                "leave samples out, or make a ranger of each element"
            )
        return self

    @cached_property
    def ranges(self) -> tuple[float, ...]:
        """Each element's range in metres."""
        told = self.range
        return told if isinstance(told, tuple) else (told,) * len(self.elements)

    @cached_property
    def fovs(self) -> tuple[float, ...]:
        """Each element's field of view in radians."""
        told = self.fov if isinstance(self.fov, tuple) else (self.fov,) * len(self.elements)
        return tuple(math.radians(fov) for fov in told)

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
    fov, far = max(settings.fovs), max(settings.ranges)
    if settings.samples is not None:
        return Scans.empty(n, settings.samples, fov, far)
    poses = np.array(settings.elements)
    poses[:, 2] = np.radians(poses[:, 2])
    return Elements.empty(n, poses, fov, far)


@lru_cache(maxsize=256)
def _alike(
    ranges: tuple[float, ...], fovs: tuple[float, ...]
) -> list[tuple[float, float, npt.NDArray[np.int64]]]:
    """The elements that see equally far and wide: range in m, fov in radians, their indices."""
    found: dict[tuple[float, float], list[int]] = {}
    for index, key in enumerate(zip(ranges, fovs, strict=True)):
        found.setdefault(key, []).append(index)
    return [(far, fov, np.array(them)) for (far, fov), them in found.items()]


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
                readings.max_range,
            )
        too_near(readings.ranges, view.rows, settings.min_range)
        return
    for far, fov, them in _alike(settings.ranges, settings.fovs):
        places = place_elements(view.origins, view.rows, readings.poses[them])
        ranges = np.empty(len(places))
        own = np.repeat(view.entities[view.rows], len(them))
        cast_cones(view.seen, places, own, fov, far, ranges)
        readings.ranges[view.rows[:, None], them] = ranges.reshape(-1, len(them))
    if settings.noise > 0.0:
        add_element_noise(
            readings.ranges,
            view.rows,
            view.keys,
            view.tick,
            settings.noise,
            np.array(settings.ranges),
        )
    too_near(readings.ranges, view.rows, settings.min_range)
