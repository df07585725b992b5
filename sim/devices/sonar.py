"""sonar: a ring of elements, on the interface that old programs ask for."""

from __future__ import annotations

import math
from collections.abc import Iterable

from player import DeviceAddr
from player.codes import Interface
from sensors.readings import Elements
from sim.devices.device import Refused, Values, flat_pose
from sim.devices.rounds import Standing
from sim.devices.sensor import SensorDevice


class Sonar(SensorDevice):
    """A ring of elements on Player's old sonar interface."""

    addr = DeviceAddr(Interface.SONAR, 0)

    def standing(self) -> Standing:
        """What it always tells."""
        return Standing(1, self.encoder("sonar"), self.row)

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
