"""power: a battery that a robot draws on, and that chargers fill while it touches them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import hypot

from player import DeviceAddr, layouts
from player.codes import Interface
from sim.devices.device import Context, Refused, Values
from sim.robot import Robot
from sim.stage.geometry import depth, reach
from sim.worldfile.models import Battery

STATE = layouts.data(Interface.POWER).head
KNOWN = 2 | 4 | 8 | 16
"""Watts, joules, percent, charging: no volts."""
NEAR = 0.01
"""Metres between bodies that touch well enough for a current."""


class Power:
    """A robot's battery. What is drawn from it depends on how fast the robot really moves.

    Nothing stops where it is empty: what a robot does then is its program's business.
    """

    def __init__(self, context: Context, robot: Robot, battery: Battery) -> None:
        self.context = context
        self.robot = robot
        self.battery = battery
        self.addr = DeviceAddr(Interface.POWER, 0)
        self.takes = True
        self.capacity = battery.capacity
        self.joules = self.capacity if battery.charge is None else battery.charge
        self.watts = 0.0
        self.charging = False
        self.span = reach(robot.model.body) + NEAR
        context.each_tick.append(self.tick)

    def tick(self) -> None:
        """An interval has gone by."""
        stage, battery, interval = self.context.scenery.stage, self.battery, self.context.interval
        vx, vy, wz = map(abs, stage.velocities[self.robot.index].tolist())
        self.watts = -(battery.idle + battery.driving * hypot(vx, vy) + battery.turning * wz)
        given = max(self.touched(), default=0.0) if self.takes else 0.0
        if battery.intake is not None:
            given = min(given, battery.intake)
        self.charging = given > 0.0
        self.watts += given
        self.joules = min(self.capacity, max(0.0, self.joules + self.watts * interval))

    def touched(self) -> Iterator[float]:
        """The watts of the chargers that the robot touches."""
        robot, pose = self.robot, self.context.scenery.stage.poses[self.robot.index]
        for charger in self.context.chargers:
            body, at = charger.body, charger.where(self.context.scenery.stage)
            if hypot(at[0] - pose[0], at[1] - pose[1]) > self.span + reach(body):
                continue
            if depth(robot.model.body, pose, body, at) >= -NEAR:
                yield body.charger

    def publish(self) -> Iterable[tuple[int, bytes]]:
        percent = 100.0 * self.joules / self.capacity
        told = STATE.pack(KNOWN, 0.0, percent, self.joules, self.watts, int(self.charging))
        return ((1, told),)

    def command(self, name: str, values: Values) -> None:
        return

    def request(self, name: str, values: Values) -> Values | None:
        if name != "set_charging_policy":
            raise Refused
        takes = bool(values["enable_input"])
        self.context.later(self.robot, lambda: setattr(self, "takes", takes), "charging policy")
        return None


def devices(context: Context, robot: Robot) -> Iterable[Power]:
    """Every robot whose model has a battery."""
    battery = robot.model.battery
    return [] if battery is None else [Power(context, robot, battery)]
