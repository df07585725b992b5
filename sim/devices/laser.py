"""laser: a scan, whole or the part of it that a client has configured."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from player import DeviceAddr, layouts
from player.codes import Interface
from sensors.readings import Scans
from sim.devices.device import Context, Refused, Values, finite, flat_pose
from sim.devices.encoding import Encodings, told
from sim.devices.rounds import Standing
from sim.devices.sensor import SensorDevice
from sim.robot import Robot

WITH_POSE = "scan_pose"
"""The property by which scans come with the robot's pose (Player's SCANPOSE)."""
SCAN, SCAN_POSE = 1, 2
"""Subtypes of the laser's data."""
PART = layouts.data(Interface.LASER, SCAN)
TAIL, TAIL_WITH_POSE = PART.tail, layouts.data(Interface.LASER, SCAN_POSE).tail

SLACK = 1e-3
"""Of a step between two rays: angles travel as float32, which know a ray's place to about 1e-5."""
FLOAT = 1e-6
"""Relative: what a float32 may be off."""
COARSER = 0.01
"""Relative: Stage's resolution is the angle by the number of rays, not of steps between them."""
NEAREST = 1e-3
"""Metres: a scan that reaches no farther tells nothing."""


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

    A client may narrow it, thin it out and shorten it (SET_CONFIG), and the reply says what it is
    now. What the sensor of the world file cannot do is refused, as Player does.
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

    def standing(self) -> Standing | None:
        """Whole scans, unless a client has configured them."""
        plain = self.cut is self.whole and not self.with_pose
        return Standing(SCAN, self.encoder("scans"), self.row) if plain else None

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
            return {"pose": flat_pose(*self.mount), "size": self.size}
        if name == "set_config":
            cut = self.granted(values)
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

    def granted(self, wanted: Values) -> Cut:
        """The part of the scan that a client wants; Refused where the sensor cannot have it.

        A scan that begins or ends between two rays is cut to the rays within it, and a resolution
        of two rays and a half is taken to whole ones. What lies outside of the sensor's angles, is
        finer than its rays, leaves fewer than two of them, reaches farther than it does, or not as
        far as it can tell apart, is no part of it: libplayerc sends whatever stood in memory as
        the range.
        """
        names = ("min_angle", "max_angle", "resolution", "max_range", "range_resolution")
        asked = [float(wanted[name]) for name in names]
        if not finite(*asked):
            raise Refused
        least, most, fine, reach, apart = asked
        scans = self.scans
        right, own = -scans.fov / 2, scans.resolution
        if not own * (1 - COARSER) <= fine <= scans.fov * (1 + COARSER):
            raise Refused
        nearest = max(NEAREST, apart, getattr(self.group.settings, "min_range", 0.0))
        if not nearest <= reach <= scans.max_range * (1 + FLOAT):
            raise Refused
        if least < right - SLACK * own or most > -right + SLACK * own:
            raise Refused
        first = max(0, math.ceil((least - right) / own - SLACK))
        last = min(self.whole.last, math.floor((most - right) / own + SLACK))
        step = max(1, round(fine / own))
        last -= (last - first) % step
        if last - first < step:
            raise Refused
        reach = min(reach, scans.max_range)
        return Cut(first, last, step, reach, bool(wanted["intensity"]))
