"""laser: a scan, whole or the part of it that a client has configured."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from player import DeviceAddr, layouts
from player.codes import Interface
from sensors.readings import Scans
from sim.devices.device import Context, Refused, Values, finite, flat_pose, limited
from sim.devices.encoding import Encodings, told
from sim.devices.sensor import SENSOR_SIZE, SensorDevice
from sim.robot import Robot

WITH_POSE = "scan_pose"
"""The property by which scans come with the robot's pose (Player's SCANPOSE)."""
SCAN, SCAN_POSE = 1, 2
"""Subtypes of the laser's data."""
PART = layouts.data(Interface.LASER, SCAN)
TAIL, TAIL_WITH_POSE = PART.tail, layouts.data(Interface.LASER, SCAN_POSE).tail

SLACK = 1e-3
"""Of a step between two rays: angles travel as float32, which know a ray's place to about 1e-5."""


@dataclass(frozen=True)
class Cut:
    """Which rays of a scan are served: first to last in steps, as far as `max_range`."""

    first: int
    last: int
    step: int
    max_range: float
    intensity: bool = False


class Laser(SensorDevice):
    """A scan on Player's laser interface.

    A client may narrow it, thin it out and shorten it (SET_CONFIG): whatever it asks for is cut
    to what the sensor of the world file can do, and the reply says what it is now.
    """

    addr = DeviceAddr(Interface.LASER, 0)

    def __init__(self, context: Context, encodings: Encodings, robot: Robot, sensor: int) -> None:
        super().__init__(context, encodings, robot, sensor)
        assert isinstance(self.group.readings, Scans)
        self.whole = Cut(0, self.scans.ranges.shape[1] - 1, 1, self.scans.max_range)
        self.cut = self.whole
        self.with_pose = False

    @property
    def scans(self) -> Scans:
        readings = self.group.readings  # another object after a robot has entered
        assert isinstance(readings, Scans)
        return readings

    def publish(self) -> Iterable[tuple[int, bytes]]:
        scan = self.payload("scans") if self.cut is self.whole else self.encode()
        if not self.with_pose:
            return ((SCAN, scan),)
        pose = self.context.scenery.odometry.poses[self.robot.index].tolist()
        number = TAIL.unpack(scan[-TAIL.size :])
        return ((SCAN_POSE, scan[: -TAIL.size] + TAIL_WITH_POSE.pack(*number, *pose)),)

    def encode(self) -> bytes:
        """The part of the scan that has been configured."""
        scans, cut = self.scans, self.cut
        rays = slice(cut.first, cut.last + 1, cut.step)
        seen = scans.ranges[self.row, rays]
        hit = (scans.hits[self.row, rays] >= 0) & (seen <= cut.max_range)
        part = PART.rows(1, ranges=len(seen), intensity=len(seen) if cut.intensity else 0)
        part["min_angle"], part["max_angle"], part["resolution"] = self.angles()
        part["max_range"] = cut.max_range
        part["ranges"] = told(np.minimum(seen, cut.max_range), hit, cut.max_range)
        if cut.intensity:
            part["intensity"] = hit
        return part.tobytes()

    def angles(self) -> tuple[float, float, float]:
        """The first ray's bearing, the last one's, and the angle from ray to ray."""
        scans, cut = self.scans, self.cut
        right, step = -scans.fov / 2, scans.resolution
        return (right + cut.first * step, right + cut.last * step, cut.step * step)

    def request(self, name: str, values: Values) -> Values | None:
        if name == "geometry":
            return {"pose": flat_pose(*self.mount), "size": SENSOR_SIZE}
        if name == "set_config":
            cut = self.nearest(values)
            self.cut = self.whole if cut == self.whole else cut
            return self.configuration()
        if name == "get_config":
            return self.configuration()
        if name == "get_id":
            return {"serial_number": self.sensor}
        if name == "power":
            return None
        if name == "get_bool_property" and values["key"] == WITH_POSE:
            return {"key": WITH_POSE, "value": int(self.with_pose)}
        if name == "set_bool_property" and values["key"] == WITH_POSE:
            self.with_pose = bool(values["value"])
            return None
        raise Refused

    def configuration(self) -> Values:
        """What the scan is now."""
        least, most, step = self.angles()
        return {
            "min_angle": least,
            "max_angle": most,
            "resolution": step,
            "max_range": self.cut.max_range,
            "range_resolution": 0.0,
            "intensity": int(self.cut.intensity),
            "scanning_frequency": 1.0 / self.context.interval,
        }

    def nearest(self, wanted: Values) -> Cut:
        """The part of the scan that comes next to what a client wants; Refused where none does.

        Angles are cut to the sensor's, the resolution is taken to whole steps between rays (0:
        as fine as it gets), and a range above the sensor's, or 0, is the sensor's.
        """
        asked = [wanted[name] for name in ("min_angle", "max_angle", "resolution", "max_range")]
        if not finite(*asked):
            raise Refused
        least, most, fine, reach = map(limited, asked)
        if not (least <= most and fine >= 0 and reach >= 0):
            raise Refused
        scans = self.scans
        right, own = -scans.fov / 2, scans.resolution
        first = max(0, math.ceil((least - right) / own - SLACK))
        last = min(self.whole.last, math.floor((most - right) / own + SLACK))
        if first > last:
            raise Refused
        step = max(1, round(fine / own))
        last -= (last - first) % step
        reach = min(reach, scans.max_range) if reach > 0 else scans.max_range
        return Cut(first, last, step, reach, bool(wanted["intensity"]))
