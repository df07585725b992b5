"""fiducial: marks in sight, by their ids, and the mark that a robot carries itself."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from player import DeviceAddr, layouts
from player.codes import Interface
from sensors.readings import Fiducials
from sim.devices.device import Context, Refused, Values, flat_pose
from sim.devices.sensor import SENSOR_SIZE, SensorDevice
from sim.robot import Robot
from sim.stage.geometry import size_of

FIDUCIALS = layouts.data(Interface.FIDUCIAL)
NONE = FIDUCIALS.head.pack(0, 0)

LARGEST_ID = 0x7FFF_FFFF
"""Ids travel as signed numbers in what a finder sees."""


def carried_id(context: Context, robot: Robot, name: str, values: Values) -> Values:
    """Answer a request about the id that a robot carries: to read it, or to set it."""
    if name == "get_id":
        return {"id": robot.fiducial}
    if name != "set_id" or values["id"] > LARGEST_ID:
        raise Refused
    fiducial = values["id"]

    robot.fiducial = fiducial  # known to its own clients alone, until others look
    context.later(robot, lambda: context.scenery.set_fiducial(robot, fiducial), "fiducial")
    return {"id": fiducial}


class FiducialFinder(SensorDevice):
    """Marked things in sight."""

    addr = DeviceAddr(Interface.FIDUCIAL, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        readings = self.group.readings
        assert isinstance(readings, Fiducials)
        seen: Any = readings.seen(self.row)
        message = FIDUCIALS.rows(1, fiducials=len(seen))
        for name in ("id", "x", "y", "yaw"):
            message["fiducials"][name] = seen[name]
        return ((1, message.tobytes()),)

    def request(self, name: str, values: Values) -> Values | None:
        readings = self.group.readings
        assert isinstance(readings, Fiducials)
        if name == "geometry":
            return {
                "pose": flat_pose(*self.mount),
                "size": SENSOR_SIZE,
                "fiducial_size": (0.1, 0.1),
            }
        if name == "get_fov":
            return {
                "min_range": getattr(self.group.settings, "min_range", 0.0),
                "max_range": readings.max_range,
                "view_angle": readings.fov,
            }
        return carried_id(self.context, self.robot, name, values)


class Marker:
    """The id of a robot that carries one and has no finder itself: it never sees anything."""

    def __init__(self, context: Context, robot: Robot) -> None:
        self.context = context
        self.robot = robot
        self.addr = DeviceAddr(Interface.FIDUCIAL, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ((1, NONE),)

    def command(self, name: str, values: Values) -> None:
        """There are no commands."""

    def request(self, name: str, values: Values) -> Values | None:
        if name == "geometry":
            length, width, height = size_of(self.robot.model.body)
            size = (width, length, height)
            return {"pose": flat_pose(), "size": size, "fiducial_size": (width, length)}
        return carried_id(self.context, self.robot, name, values)
