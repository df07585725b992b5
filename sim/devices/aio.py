"""aio: plain numbers, such as those of a sensor of one's own."""

from __future__ import annotations

import struct
from collections.abc import Iterable

from player import DeviceAddr
from player.codes import Interface
from sensors.readings import Scalars
from sim.devices.device import Refused, Values
from sim.devices.sensor import SensorDevice

COUNTS = struct.Struct(">II")


class Aio(SensorDevice):
    """Plain numbers on Player's aio interface."""

    addr = DeviceAddr(Interface.AIO, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        readings = self.group.readings
        assert isinstance(readings, Scalars)
        values = readings.values[self.row].astype(">f4")
        return ((1, COUNTS.pack(len(values), len(values)) + values.tobytes()),)

    def request(self, name: str, values: Values) -> Values | None:
        raise Refused
