"""simulation: properties that a robot sets on itself, the time, and for tools any robot's pose."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Iterable
from typing import Any

from player import DeviceAddr
from player.codes import Interface
from sim.devices.device import Context, Refused, Values, flat_pose

COLOR = struct.Struct("<4f")
TIME = struct.Struct("<Q")


class Simulation:
    """A robot's access to the simulation.

    With `simulation: report` in its model a robot may set and get its own properties and read
    the time; everything else is refused. With `full` it may read and set any robot's pose and
    properties, pause and reset.
    """

    def __init__(self, context: Context, robot: int, full: bool) -> None:
        self.context = context
        self.robot = robot
        self.full = full
        self.addr = DeviceAddr(Interface.SIMULATION, 0)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ()

    def command(self, name: str, values: Values) -> None:
        if not self.full:
            return
        context = self.context
        if name == "pause":
            context.paused = not context.paused
        elif name == "reset":
            context.later(self.robot, lambda: setattr(context, "resets", context.resets + 1))

    def request(self, name: str, values: Values) -> Values | None:
        if name == "get_property":
            return self.get_property(values)
        if name == "set_property":
            self.set_property(values)
            return None
        if not self.full or "name" not in values:
            raise Refused
        target = self.target(values["name"])
        context = self.context
        x, y, yaw = map(float, context.stage.poses[target])
        if name == "get_pose2d":
            return {"name": values["name"], "pose": (x, y, yaw)}
        if name == "get_pose3d":
            return {
                "name": values["name"],
                "pose": flat_pose(x, y, yaw),
                "simtime": context.time * 1e6,
            }
        if name in ("set_pose2d", "set_pose3d"):
            pose = values["pose"]
            goal = (pose[0], pose[1], pose[-1])
            if not all(map(math.isfinite, goal)):
                raise Refused
            context.later(self.robot, lambda: context.put(target, goal))
            return None
        raise Refused

    def target(self, name: str) -> int:
        """The robot of that name that this robot may deal with; raises Refused."""
        robot = self.context.robots.get(name)
        if robot is None or (robot != self.robot and not self.full):
            raise Refused
        return robot

    def get_property(self, values: Values) -> Values:
        key = values["property"]
        if key == "time":
            value = TIME.pack(round(self.context.time * 1e6))
        elif key == "color":
            value = color_bytes(self.context.colors[self.target(values["name"])])
        else:
            properties = self.context.records[self.target(values["name"])].properties
            if key not in properties:
                raise Refused
            value = json.dumps(properties[key]).encode()
        # Player's client copies as many bytes as it sent: never give it fewer
        value = value.ljust(len(values["value"]), b"\0")
        return {**values, "value": value}

    def set_property(self, values: Values) -> None:
        target = self.target(values["name"])
        key, data = values["property"], bytes(values["value"])
        if key == "time":
            raise Refused
        if key == "color":
            color = parse_color_value(data)
            self.context.later(self.robot, lambda: self.paint(target, color))
            return
        value = parse_json(data)
        properties = self.context.records[target].properties
        self.context.later(self.robot, lambda: properties.__setitem__(key, value))

    def paint(self, target: int, color: int) -> None:
        """Give a robot's body another colour: cameras see it from the next tick on."""
        self.context.colors[target] = color
        self.context.repaint(target, color)
        self.context.records[target].properties["color"] = f"#{color:06x}"


def parse_json(data: bytes) -> Any:
    """A property's value: JSON text; raises Refused for anything else (NaN and infinities too)."""

    def no_constant(name: str) -> Any:
        raise ValueError(name)

    try:
        return json.loads(data.rstrip(b"\0").decode(), parse_constant=no_constant)
    except (ValueError, RecursionError):
        raise Refused from None


def color_bytes(color: int) -> bytes:
    """A colour as Stage has it: red, green, blue, alpha as floats in 0..1."""
    return COLOR.pack((color >> 16) / 255, (color >> 8 & 255) / 255, (color & 255) / 255, 1.0)


def parse_color_value(data: bytes) -> int:
    """A colour in Stage's layout of four floats, or as JSON text `"#rrggbb"`; raises Refused."""
    if len(data) == COLOR.size and not data.startswith(b'"'):
        parts = COLOR.unpack(data)[:3]
        if not all(math.isfinite(part) for part in parts):
            raise Refused
        red, green, blue = (round(255 * min(1.0, max(0.0, part))) for part in parts)
        return int(red << 16 | green << 8 | blue)
    text = parse_json(data)
    if not (isinstance(text, str) and len(text) == 7 and text[0] == "#"):
        raise Refused
    try:
        return int(str(text[1:]), 16)
    except ValueError:
        raise Refused from None
