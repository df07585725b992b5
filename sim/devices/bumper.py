"""bumper: switches around the body."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from player import DeviceAddr, layouts
from player.codes import Interface
from sensors.readings import Bits
from sim.devices.device import Context, Refused, Values, flat_pose
from sim.devices.encoding import Encodings
from sim.devices.sensor import SensorDevice
from sim.robot import Robot
from sim.stage.geometry import size_of

STATE = layouts.data(Interface.BUMPER)


class Bumper(SensorDevice):
    """Switches around the body."""

    addr = DeviceAddr(Interface.BUMPER, 0)

    def __init__(self, context: Context, encodings: Encodings, robot: Robot, sensor: int) -> None:
        super().__init__(context, encodings, robot, sensor)
        length, width, _ = size_of(robot.model.body)
        self.radius = 0.5 * max(length, width)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        readings = self.group.readings
        assert isinstance(readings, Bits)
        bits = readings.bits[self.row]
        message = STATE.rows(1, bumpers=len(bits))
        message["bumpers"] = bits
        return ((1, message.tobytes()),)

    def request(self, name: str, values: Values) -> Values | None:
        """A segment per switch: an arc of the circle that is as wide as the body."""
        readings = self.group.readings
        assert isinstance(readings, Bits)
        if name != "geometry":
            raise Refused
        count = readings.bits.shape[1]
        arcs = readings.arcs
        if arcs is None:
            arcs = np.array([[k, k + 1] for k in range(count)]) * (2 * math.pi / count)
        rows = []
        for start, end in arcs.tolist():
            middle, span = 0.5 * (start + end), end - start
            pose = flat_pose(self.radius * math.cos(middle), self.radius * math.sin(middle), middle)
            rows.append((*pose, self.radius * span, self.radius))
        return {"bumpers": rows}
