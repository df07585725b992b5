"""aio: plain numbers, such as those of a sensor of one's own."""

from __future__ import annotations

from collections.abc import Iterable

from player import DeviceAddr, layouts
from player.codes import Interface
from sensors.readings import Scalars
from sim.devices.device import Refused, Values
from sim.devices.sensor import SensorDevice

STATE = layouts.data(Interface.AIO)


class Aio(SensorDevice):
    """Plain numbers on Player's aio interface."""

    addr = DeviceAddr(Interface.AIO, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        readings = self.group.readings
        assert isinstance(readings, Scalars)
        values = readings.values[self.row]
        message = STATE.rows(1, voltages=len(values))
        message["voltages"] = values
        return ((1, message.tobytes()),)

    def request(self, name: str, values: Values) -> Values | None:
        raise Refused
