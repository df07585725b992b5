"""blobfinder: runs of one colour in an image."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from player import DeviceAddr, layouts
from player.codes import Interface
from sensors.readings import Blobs
from sim.devices.device import Context, Refused, Values
from sim.devices.encoding import Encodings
from sim.devices.rounds import Standing
from sim.devices.sensor import SensorDevice
from sim.robot import Robot

MOST_CHANNELS = 32
"""Channels of colour that a blobfinder can be told (as many as the CMUcam of old had)."""
FIELD_OF_VIEW = "fov"
"""The property that tells the image's width as an angle, radians: blobs travel without it."""


BLOBS = layouts.data(Interface.BLOBFINDER)


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

    def __init__(self, context: Context, encodings: Encodings, robot: Robot, sensor: int) -> None:
        super().__init__(context, encodings, robot, sensor)
        colors: tuple[int, ...] = getattr(self.group.settings, "colors", ())
        self.channels = {number: exactly(color) for number, color in enumerate(colors)}
        self.told = False

    def standing(self) -> Standing | None:
        """All blobs, unless a client has chosen their colours."""
        plain = not self.told
        return Standing(1, self.encoder("blobs"), self.row) if plain else None

    def publish(self) -> Iterable[tuple[int, bytes]]:
        if not self.told:
            return ((1, self.payload("blobs")),)
        readings = self.group.readings
        assert isinstance(readings, Blobs)
        seen = self.chosen(readings.seen(self.row))
        message = BLOBS.rows(1, blobs=len(seen))
        message["width"], message["height"] = readings.width, readings.height
        message["blobs"] = seen
        return ((1, message.tobytes()),)

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


@cache
def exactly(color: int) -> Channel:
    """The channel that takes one colour 0xRRGGBB alone."""
    red, green, blue = color >> 16 & 255, color >> 8 & 255, color & 255
    return Channel((red, red), (green, green), (blue, blue))
