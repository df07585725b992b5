"""The laser: a scan of ranges, with Gaussian noise if wanted."""

import math
from typing import Any, Self

from pydantic import model_validator

from sensors.noise import add_range_noise
from sensors.readings import Fan, Scans, too_near
from sensors.registry import sensor
from sensors.settings import (
    Count,
    Housing,
    Number,
    SensorSettings,
    check_min_range,
    housing,
    setting,
)
from sensors.view import View


class LaserSettings(SensorSettings):
    """The defaults are those of the paper's robots: 180 rays over 180 degrees, 20 m."""

    range: Number = setting(
        20.0, gt=0, unit="m", description="how far it sees; the reading where nothing is hit"
    )
    min_range: Number = setting(
        0.0, ge=0, unit="m", description="what is nearer than that reads 0: too near to measure"
    )
    fov: Number = setting(
        180.0, gt=0, le=360, unit="deg", description="the fan's width; both ends are rays"
    )
    samples: Count = setting(180, ge=2, le=100_000, unit="rays", description="rays per scan")
    noise: Number = setting(
        0.0, ge=0, unit="m", description="standard deviation of the noise on ranges that hit"
    )
    housing: Housing = housing()

    @model_validator(mode="after")
    def _sees_something(self) -> Self:
        check_min_range(self.min_range, self.range)
        return self


def _empty(settings: LaserSettings, n: int) -> Scans:
    return Scans.empty(n, settings.samples, math.radians(settings.fov), settings.range)


def fan_of(settings: Any, scans: Any) -> Fan | None:
    """The rays of a scan."""
    return Fan(scans.fov, scans.max_range, scans.ranges, scans.hits)


@sensor("laser", kind="scan", settings=LaserSettings, readings=_empty, fan=fan_of, threads=True)
def sense_laser(settings: LaserSettings, view: View, scans: Scans) -> None:
    """Ranges to the nearest thing along each ray of a fan."""
    if settings.noise > 0.0:
        add_range_noise(
            scans.ranges,
            scans.hits,
            view.rows,
            view.keys,
            view.tick,
            settings.noise,
            settings.range,
        )
    too_near(scans.ranges, view.rows, settings.min_range)
