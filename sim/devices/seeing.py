"""blobfinder, fiducial, bumper and aio: what a robot sees, touches and measures."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable
from typing import Any

import numpy as np

from player import DeviceAddr
from player.codes import Interface
from sensors.readings import Bits, Blobs, Fiducials, Scalars
from sim.devices.device import Context, Refused, Values, flat_pose
from sim.devices.ranging import SENSOR_SIZE

COUNTS = struct.Struct(">II")
BLOBS = struct.Struct(">IIII")
BLOB = np.dtype(
    [(name, ">u4") for name in ["id", "color", "area", "x", "y", "left", "right", "top", "bottom"]]
    + [("range", ">f4")]
)
FIDUCIAL = np.dtype([("id", ">i4"), ("pose", ">f8", 6), ("uncertainty", ">f8", 6)])


class SensorDevice:
    """A sensor slot of one robot."""

    def __init__(self, context: Context, robot: int, slot: int) -> None:
        self.context = context
        self.robot = robot
        self.slot = slot
        self.group, self.row = context.suite.place(robot, slot)

    @property
    def sensor(self) -> int:
        """The sensor's number among its robot's."""
        return self.slot

    @property
    def mount(self) -> tuple[float, ...]:
        return flat_pose(*map(float, self.group.settings.mount))

    def command(self, name: str, values: Values) -> None:
        """There are no commands."""


class Blobfinder(SensorDevice):
    """Runs of one colour in an image."""

    addr = DeviceAddr(Interface.BLOBFINDER, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        readings = self.group.readings
        assert isinstance(readings, Blobs)
        seen: Any = readings.seen(self.row)
        head = BLOBS.pack(readings.width, readings.height, len(seen), len(seen))
        return ((1, head + seen.astype(BLOB).tobytes()),)

    def request(self, name: str, values: Values) -> Values | None:
        raise Refused  # colours are the world file's; Stage refuses these requests too


class FiducialFinder(SensorDevice):
    """Marked things in sight."""

    addr = DeviceAddr(Interface.FIDUCIAL, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        readings = self.group.readings
        assert isinstance(readings, Fiducials)
        seen: Any = readings.seen(self.row)
        rows = np.zeros(len(seen), FIDUCIAL)
        rows["id"] = seen["id"]
        rows["pose"][:, 0] = seen["x"]
        rows["pose"][:, 1] = seen["y"]
        rows["pose"][:, 5] = seen["yaw"]
        return ((1, COUNTS.pack(len(rows), len(rows)) + rows.tobytes()),)

    def request(self, name: str, values: Values) -> Values | None:
        readings = self.group.readings
        assert isinstance(readings, Fiducials)
        if name == "geometry":
            return {"pose": self.mount, "size": SENSOR_SIZE, "fiducial_size": (0.1, 0.1)}
        if name == "get_fov":
            return {
                "min_range": 0.0,
                "max_range": readings.max_range,
                "view_angle": readings.fov,
            }
        if name == "get_id":
            return {"id": self.context.models[self.robot].fiducial or 0}
        raise Refused


class Bumper(SensorDevice):
    """Switches around the body."""

    addr = DeviceAddr(Interface.BUMPER, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        readings = self.group.readings
        assert isinstance(readings, Bits)
        bits = readings.bits[self.row].astype(np.uint8).tobytes()
        return ((1, COUNTS.pack(len(bits), len(bits)) + bits + bytes(-len(bits) % 4)),)

    def request(self, name: str, values: Values) -> Values | None:
        readings = self.group.readings
        assert isinstance(readings, Bits)
        if name != "geometry":
            raise Refused
        count = readings.bits.shape[1]
        arcs = readings.arcs
        if arcs is None:
            arcs = np.array([[k, k + 1] for k in range(count)]) * (2 * math.pi / count)
        rows = []
        for start, end in arcs:
            middle, span = 0.5 * (start + end), end - start
            pose = flat_pose(REACH * math.cos(middle), REACH * math.sin(middle), float(middle))
            rows.append((*pose, REACH * float(span), REACH))
        return {"bumpers": rows}


REACH = 0.5
"""Metres: the nominal radius at which a bumper's segments are said to lie."""


class AnalogInput(SensorDevice):
    """Plain numbers on Player's aio interface."""

    addr = DeviceAddr(Interface.AIO, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        readings = self.group.readings
        assert isinstance(readings, Scalars)
        values = readings.values[self.row].astype(">f4")
        return ((1, COUNTS.pack(len(values), len(values)) + values.tobytes()),)

    def request(self, name: str, values: Values) -> Values | None:
        raise Refused
