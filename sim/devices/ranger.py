"""ranger: ranges, from one origin or from many."""

from __future__ import annotations

from collections.abc import Iterable

from player import DeviceAddr
from player.codes import Interface
from sensors.readings import Elements, Intensities, Scans
from sim.devices.device import Context, Refused, Values, flat_pose
from sim.devices.encoding import Encodings
from sim.devices.rounds import Standing
from sim.devices.sensor import SENSOR_SIZE, SensorDevice
from sim.robot import Robot


class Ranger(SensorDevice):
    """A scan, or elements each with an origin of its own, on Player's ranger interface.

    Intensities follow the ranges if they have been turned on: a sensor's own, which are on from
    the start, or for a plain scan 1 where a ray has hit something and 0 elsewhere.
    """

    addr = DeviceAddr(Interface.RANGER, 0)

    def __init__(self, context: Context, encodings: Encodings, robot: Robot, sensor: int) -> None:
        super().__init__(context, encodings, robot, sensor)
        self.with_intensities = isinstance(self.group.readings, Intensities)

    def standing(self) -> Standing | None:
        """Ranges alone, unless a client has asked for intensities."""
        if self.with_intensities:
            return None
        return Standing(1, self.encoder("ranges"), self.row)

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
                "size": self.size,
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
