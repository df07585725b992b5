"""dio: a robot's sprayer, which bit 0 turns on and off."""

from __future__ import annotations

from collections.abc import Iterable

from player import DeviceAddr, layouts
from player.codes import Interface
from sim.devices.device import Context, Refused, Values
from sim.robot import Robot

VALUES = layouts.data(Interface.DIO).head


class Dio:
    """A sprayer on Player's dio interface: bit 0 turns it on and off."""

    def __init__(self, context: Context, robot: Robot, index: int) -> None:
        self.context = context
        self.robot = robot
        self.index = index
        self.sprayer = robot.sprayers[index]
        self.addr = DeviceAddr(Interface.DIO, index)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ((1, VALUES.pack(1, int(self.sprayer.on))),)

    def command(self, name: str, values: Values) -> None:
        if name != "values" or values["count"] < 1:
            return
        on = bool(values["bits"] & 1)
        self.context.later(self.robot, lambda: self.turn(on), ("sprayer", self.index))

    def turn(self, on: bool) -> None:
        self.sprayer.on = on

    def request(self, name: str, values: Values) -> Values | None:
        raise Refused


def devices(context: Context, robot: Robot) -> Iterable[Dio]:
    """One for each of the robot's sprayers."""
    return [Dio(context, robot, index) for index in range(len(robot.sprayers))]
