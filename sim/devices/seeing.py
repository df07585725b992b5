"""blobfinder and fiducial: what a robot sees, and the mark that it carries itself."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from player import DeviceAddr
from player.codes import Interface
from sensors.readings import Blobs, Fiducials
from sim.devices.batch import BLOB, BLOBS, Encoders
from sim.devices.device import Context, Refused, Values, flat_pose
from sim.devices.ranging import SENSOR_SIZE
from sim.robot import Robot

COUNTS = struct.Struct(">II")
FIDUCIAL = np.dtype([("id", ">i4"), ("pose", ">f8", 6), ("uncertainty", ">f8", 6)])

MOST_CHANNELS = 32
"""Channels of colour that a blobfinder can be told (as many as the CMUcam of old had)."""
FIELD_OF_VIEW = "fov"
"""The property that tells the image's width as an angle, radians: blobs travel without it."""
LARGEST_ID = 0x7FFF_FFFF
"""Ids travel as signed numbers in what a finder sees."""


class SensorDevice:
    """A sensor slot of one robot."""

    def __init__(self, context: Context, robot: Robot, slot: int) -> None:
        self.context = context
        self.robot = robot
        self.slot = slot
        self.group, self.row = context.scenery.suite.place(robot.index, slot)

    @property
    def sensor(self) -> int:
        """The sensor's number among its robot's."""
        return self.slot

    @property
    def mount(self) -> tuple[float, ...]:
        return flat_pose(*map(float, self.group.settings.mount))

    def command(self, name: str, values: Values) -> None:
        """There are no commands."""


@dataclass(frozen=True)
class Channel:
    """The colours that one channel of a blobfinder takes: least and most red, green and blue."""

    red: tuple[int, int]
    green: tuple[int, int]
    blue: tuple[int, int]

    def takes(self, colors: NDArray[Any]) -> NDArray[np.bool_]:
        """Which of the colours 0xRRGGBB are the channel's."""
        taken = np.ones(len(colors), np.bool_)
        for shift, (least, most) in ((16, self.red), (8, self.green), (0, self.blue)):
            part = colors >> shift & 255
            taken &= (part >= least) & (part <= most)
        return taken


class Blobfinder(SensorDevice):
    """Runs of one colour in an image.

    The camera tells apart the colours of the world file, one channel each. A client may give a
    channel other bounds (SET_COLOR), as with Player's colour trackers: of what the camera tells
    apart, those that no channel takes are not reported any more, and a blob's id is the first
    channel that takes it. A camera for all colours has no channels until it is told some.
    """

    addr = DeviceAddr(Interface.BLOBFINDER, 0)

    def __init__(self, context: Context, encoders: Encoders, robot: Robot, slot: int) -> None:
        super().__init__(context, robot, slot)
        self.encoders = encoders
        self.encoder = encoders.blobs_of(self.group)
        colors: tuple[int, ...] = getattr(self.group.settings, "colors", ())
        self.channels = {number: exactly(color) for number, color in enumerate(colors)}
        self.told = False

    def publish(self) -> Iterable[tuple[int, bytes]]:
        if not self.told:
            return ((1, self.encoder.payload(self.row, self.encoders.tick)),)
        readings = self.group.readings
        assert isinstance(readings, Blobs)
        seen = self.chosen(readings.seen(self.row))
        head = BLOBS.pack(readings.width, readings.height, len(seen), len(seen))
        return ((1, head + seen.astype(BLOB).tobytes()),)

    def chosen(self, seen: Any) -> Any:
        """The blobs that a channel takes, with its number."""
        seen = seen.copy()
        ids = np.full(len(seen), -1)
        for number in sorted(self.channels, reverse=True):
            ids[self.channels[number].takes(seen["color"])] = number
        seen["id"] = np.maximum(ids, 0)
        return seen[ids >= 0]

    def request(self, name: str, values: Values) -> Values | None:
        if name == "get_double_property" and values["key"] == FIELD_OF_VIEW:
            fov = getattr(self.group.settings, "fov", None)
            if fov is None:  # a camera of a user's own need not have one
                raise Refused
            return {"key": FIELD_OF_VIEW, "value": math.radians(fov)}
        if name == "set_color":
            number = values["channel"]
            bounds = [
                (values[f"{color}_min"], values[f"{color}_max"])
                for color in ("red", "green", "blue")
            ]
            if number >= MOST_CHANNELS or any(least > most for least, most in bounds):
                raise Refused
            self.channels[number] = Channel(*bounds)
            self.told = True
            return None
        if name == "get_color":
            # Player has no field for the channel in this request: the first one is meant
            if not self.channels:
                raise Refused
            number = min(self.channels)
            channel = self.channels[number]
            return {"channel": number} | {
                f"{color}_{end}": value
                for color in ("red", "green", "blue")
                for end, value in zip(("min", "max"), getattr(channel, color), strict=True)
            }
        raise Refused  # the camera has no imager to be set


def exactly(color: int) -> Channel:
    """The channel that takes one colour 0xRRGGBB alone."""
    red, green, blue = color >> 16 & 255, color >> 8 & 255, color & 255
    return Channel((red, red), (green, green), (blue, blue))


def carried_id(context: Context, robot: Robot, name: str, values: Values) -> Values:
    """Answer a request about the id that a robot carries: to read it, or to set it."""
    if name == "get_id":
        return {"id": robot.fiducial}
    if name != "set_id" or values["id"] > LARGEST_ID:
        raise Refused
    fiducial = values["id"]

    robot.fiducial = fiducial  # known to its own clients alone, until others look
    context.later(robot, lambda: context.scenery.remark(robot, fiducial), "fiducial")
    return {"id": fiducial}


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
        return carried_id(self.context, self.robot, name, values)


class Marker:
    """The id of a robot that carries one and has no finder itself: it never sees anything."""

    def __init__(self, context: Context, robot: Robot, size: tuple[float, float, float]) -> None:
        self.context = context
        self.robot = robot
        self.size = size
        self.addr = DeviceAddr(Interface.FIDUCIAL, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ((1, COUNTS.pack(0, 0)),)

    def command(self, name: str, values: Values) -> None:
        """There are no commands."""

    def request(self, name: str, values: Values) -> Values | None:
        if name == "geometry":
            length, width, height = self.size
            size = (width, length, height)
            return {"pose": flat_pose(), "size": size, "fiducial_size": (width, length)}
        return carried_id(self.context, self.robot, name, values)
