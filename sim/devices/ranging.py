"""ranger and sonar: ranges, from one origin or from many; and what all range finders share."""

from __future__ import annotations

import math
from collections.abc import Iterable

from player import DeviceAddr
from player.codes import Interface
from sensors.readings import Elements, Intensities, Scans
from sensors.suite import Group
from sim.devices.batch import Encoders
from sim.devices.device import Context, Refused, Values, flat_pose
from sim.robot import Robot

SENSOR_SIZE = (0.02, 0.02, 0.02)
"""Width, length, height in metres: what Stage says of an element; nothing depends on it."""


class RangingDevice:
    """A sensor slot of one robot, and its place in a batch."""

    def __init__(self, context: Context, encoders: Encoders, robot: Robot, slot: int) -> None:
        self.context = context
        self.encoders = encoders
        self.robot = robot
        self.slot = slot
        group, self.row = context.scenery.suite.place(robot.index, slot)
        self.group: Group = group

    @property
    def sensor(self) -> int:
        """The sensor's number among its robot's."""
        return self.slot

    @property
    def mount(self) -> tuple[float, float, float]:
        x, y, heading = self.group.settings.mount
        return (float(x), float(y), float(heading))

    def payload(self, name: str) -> bytes:
        return self.encoders.get(self.group, name).payload(self.row, self.encoders.tick)

    def command(self, name: str, values: Values) -> None:
        """There are no commands."""


class Ranger(RangingDevice):
    """A scan, or elements each with an origin of its own, on Player's ranger interface.

    Intensities follow the ranges if they have been turned on: a sensor's own, which are on from
    the start, or for a plain scan 1 where a ray has hit something and 0 elsewhere.
    """

    addr = DeviceAddr(Interface.RANGER, 0)

    def __init__(self, context: Context, encoders: Encoders, robot: Robot, slot: int) -> None:
        super().__init__(context, encoders, robot, slot)
        self.with_intensities = isinstance(self.group.readings, Intensities)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        yield 1, self.payload("ranges")
        if self.with_intensities:
            yield 3, self.payload("intensities")

    def request(self, name: str, values: Values) -> Values | None:
        readings = self.group.readings
        if name == "geometry":
            poses = [flat_pose()]
            if isinstance(readings, Elements):
                poses = [flat_pose(*map(float, pose)) for pose in readings.poses]
            return {
                "pose": flat_pose(*self.mount),
                "size": SENSOR_SIZE,
                "element_poses": poses,
                "element_sizes": [SENSOR_SIZE] * len(poses),
            }
        if name == "get_config":
            return self.configuration()
        if name == "intensity" and not isinstance(readings, Elements):
            self.with_intensities = bool(values["value"])
            return None
        if name == "power":
            return None
        raise Refused

    def configuration(self) -> Values:
        """Angles and ranges; a lone element's angles are where it looks, as clients take it."""
        readings = self.group.readings
        assert isinstance(readings, Scans | Elements | Intensities)
        rays = readings.ranges.shape[1]
        least, most, step = -readings.fov / 2, readings.fov / 2, readings.fov
        if not isinstance(readings, Elements):
            step = readings.fov / max(rays - 1, 1)
        elif rays == 1:
            least = most = float(readings.poses[0, 2])
        return {
            "min_angle": least,
            "max_angle": most,
            "angular_resolution": step,
            "min_range": getattr(self.group.settings, "min_range", 0.0),
            "max_range": readings.max_range,
            "range_resolution": 0.0,
            "frequency": 1.0 / self.context.interval,
        }


class Sonar(RangingDevice):
    """A ring of elements on Player's old sonar interface."""

    addr = DeviceAddr(Interface.SONAR, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ((1, self.payload("sonar")),)

    def request(self, name: str, values: Values) -> Values | None:
        readings = self.group.readings
        assert isinstance(readings, Elements)
        if name == "geometry":
            return {"poses": [self.element(*map(float, pose)) for pose in readings.poses]}
        if name == "power":
            return None
        raise Refused

    def element(self, x: float, y: float, heading: float) -> tuple[float, ...]:
        """An element's pose in the robot's frame: sonars have no pose as a whole."""
        mx, my, mh = self.mount
        cos, sin = math.cos(mh), math.sin(mh)
        return flat_pose(mx + cos * x - sin * y, my + sin * x + cos * y, mh + heading)
