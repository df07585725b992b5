"""simulation: properties that a robot sets on itself, the time, and for tools any robot's pose."""

from __future__ import annotations

import json
import math
import re
import struct
from collections.abc import Iterable
from typing import Any, NoReturn

from player import DeviceAddr
from player.codes import Interface
from sim import strictjson
from sim.devices.device import Action, Context, Refused, Values, sane
from sim.robot import Robot

Pose = tuple[float, float, float]

COLOR = struct.Struct("<4f")
TIME = struct.Struct("<Q")

MOST_PROPERTIES = 256
"""Properties of one robot."""
LONGEST_VALUE = 1 << 16
"""Bytes of one property's value."""
LONGEST_KEY = 256
"""Characters of one property's name."""


class Simulation:
    """Access to the simulation for the clients of one robot, or of all robots at a shared port.

    With `simulation: report` in its model a robot may set and get its own properties and read
    the time; everything else is refused. With `full` it may read and set any robot's pose and
    properties, pause and reset. Clients of a shared port may do what any robot there may: which
    of them a client is, nobody can tell.
    """

    def __init__(self, context: Context, robot: Robot, full: bool) -> None:
        self.context = context
        self.robot = robot
        self.members = {robot: None}
        self.full = full
        self.told: dict[
            tuple[str, str], tuple[float, bytes]
        ] = {}  # when, and what, by name and key
        self.addr = DeviceAddr(Interface.SIMULATION, 0)

    def admit(self, robot: Robot, full: bool) -> None:
        """Another robot's clients come in here too."""
        self.members[robot] = None
        self.full |= full

    def later(self, target: Robot, what: str, action: Action) -> None:
        """Have something done to a robot at the next command phase, in the order of robots.

        That is the order of those who ask; at a shared port, of those who are meant.
        """
        asking = self.robot if self.alone else target
        self.context.later(asking, action, (what, target.index))

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ()

    def command(self, name: str, values: Values) -> None:
        if not self.full:
            return
        context = self.context
        if name == "pause":
            context.paused = not context.paused
        elif name == "reset":
            context.later(self.robot, lambda: setattr(context, "resets", 1), "reset")

    def request(self, name: str, values: Values) -> Values | None:
        if name in ("get_property", "set_property"):
            if not values["name"] and self.alone:  # a program that was started by hand knows none
                values = {**values, "name": self.robot.name}
            if name == "get_property":
                return self.get_property(values)
            self.set_property(values)
            return None
        if not self.full or "name" not in values:
            raise Refused
        who = values["name"]
        if name in ("set_pose2d", "set_pose3d"):
            pose = values["pose"]
            self.put(who, (pose[0], pose[1], pose[-1]))
            return None
        x, y, yaw = self.where(who)
        if name == "get_pose2d":
            return {"name": who, "pose": (x, y, yaw)}
        if name == "get_pose3d":
            return {
                "name": who,
                "pose": (x, y, self.height(who), 0.0, 0.0, yaw),
                "simtime": self.context.time * 1e6,
            }
        raise Refused

    @property
    def alone(self) -> bool:
        """Whether one robot's clients only come in here: they see at once what they have asked for.

        At a shared port that would depend on whose request came first, so there everybody sees what
        held at the last tick.
        """
        return len(self.members) == 1

    def target(self, name: str) -> Robot:
        """The robot of that name, if a client here may deal with it; raises Refused."""
        robot = self.context.by_name.get(name)
        if robot is None or (robot not in self.members and not self.full):
            raise Refused
        return robot

    def where(self, name: str) -> Pose:
        """Where a robot, or an obstacle with a name, is: x, y, yaw; raises Refused.

        Who has just had it put elsewhere finds it there.
        """
        context, stage = self.context, self.context.scenery.stage
        thing = context.things.get(name)
        if thing is not None:
            put = context.thing_puts.get(self.robot.index, {}) if self.alone else {}
            return put[name] if name in put else stage.thing_pose(thing.number)
        target = self.target(name)
        asked = context.puts.get(self.robot.index, {}) if self.alone else {}
        x, y, yaw = map(float, asked.get(target.index, stage.poses[target.index]))
        return x, y, yaw

    def height(self, name: str) -> float:
        """Metres above the floor at which a robot's body, or an obstacle with a name, begins."""
        thing = self.context.things.get(name)
        return float(self.target(name).model.body.z if thing is None else thing.z)

    def put(self, name: str, pose: Pose) -> None:
        """Have a robot, or an obstacle with a name, put at a pose at the next command phase.

        Raises Refused without room there. Where the others are is what held at the last tick, but
        for robots that this robot's clients have had put elsewhere since. What others ask for
        meanwhile is looked at when it is done.
        """
        context, stage = self.context, self.context.scenery.stage
        thing = context.things.get(name)
        target = None if thing is not None else self.target(name)
        asking = self.robot if self.alone or target is None else target
        asked = context.puts.setdefault(asking.index, {})
        moved = asked if self.alone else {}
        if not sane(*pose):
            raise Refused
        if target is not None:
            if not stage.fits(target.index, pose, moved):
                raise Refused
            asked[target.index] = pose
            return
        assert thing is not None
        if not stage.fits(stage.count + thing.number, pose, moved):
            raise Refused
        context.thing_puts.setdefault(asking.index, {})[name] = pose

    def get_property(self, values: Values) -> Values:
        key = values["property"]
        if key == "time":
            value = TIME.pack(round(self.context.time * 1e6))
        elif key == "color":
            value = color_bytes(self.target(values["name"]).color)
        else:
            target = self.target(values["name"])
            properties = target.record.properties
            if key not in properties and not self.just_told(values):
                raise Refused
            value = target.raw_properties.get(key) or json.dumps(properties.get(key)).encode()
        value = self.just_told(values) or value
        # Player's client copies as many bytes as it sent: never give it fewer
        value = value.ljust(len(values["value"]), b"\0")
        return {**values, "value": value}

    def just_told(self, values: Values) -> bytes:
        """What a client has set since the last tick, which is not carried out yet; else empty.

        Who sets a property and then reads it finds it set.
        """
        time, value = self.told.get((values["name"], values["property"]), (-1.0, b""))
        return value if time == self.context.time and self.alone else b""

    def set_property(self, values: Values) -> None:
        target = self.target(values["name"])
        key, data = values["property"], bytes(values["value"])
        if key == "time":
            raise Refused
        if key == "color":
            try:
                color = parse_color_value(data)
            except ValueError as error:
                self.refuse(target, key, error)
            self.told[values["name"], key] = (self.context.time, color_bytes(color))
            self.later(target, "color", lambda: self.paint(target, color))
            return
        if len(data) > LONGEST_VALUE or len(key) > LONGEST_KEY:
            raise Refused
        raw = b""
        try:
            value = parse_json(data)
        except ValueError as error:
            if b"\0" not in data:
                self.refuse(target, key, error)
            raw, value = data, f"0x{data.hex()}"  # what a C program has in memory, and no text
        names = target.property_names
        if key not in names and len(names) >= MOST_PROPERTIES:
            raise Refused
        names.add(key)
        self.told[values["name"], key] = (self.context.time, raw or json.dumps(value).encode())
        self.later(target, f"property {key}", lambda: remember(target, key, value, raw))

    def refuse(self, target: Robot, key: str, error: ValueError) -> NoReturn:
        """Say why a value is not taken: a NACK tells its client no more than that it is not."""
        self.context.complain(target, f"a value of the property {key!r} that is refused: {error}")
        raise Refused

    def paint(self, target: Robot, color: int) -> None:
        """Give a robot's body another colour: cameras see it from the next tick on."""
        self.context.scenery.set_color(target, color)
        target.record.properties["color"] = f"#{color:06x}"


def remember(target: Robot, key: str, value: Any, raw: bytes) -> None:
    """Put down a property of a robot; `raw`: what its clients read of one that is no JSON."""
    target.record.properties[key] = value
    target.raw_properties[key] = raw


def parse_json(data: bytes) -> Any:
    """A property's value: JSON text; raises ValueError for anything else."""
    return strictjson.loads(data.rstrip(b"\0").decode())


def color_bytes(color: int) -> bytes:
    """A colour as Stage has it: red, green, blue, alpha as floats in 0..1."""
    return COLOR.pack((color >> 16) / 255, (color >> 8 & 255) / 255, (color & 255) / 255, 1.0)


def parse_color_value(data: bytes) -> int:
    """A colour in Stage's layout of four floats, or as JSON text `"#rrggbb"`; else ValueError."""
    if len(data) == COLOR.size and not data.startswith(b'"'):
        parts: tuple[float, ...] = COLOR.unpack(data)[:3]
        if not all(math.isfinite(part) for part in parts):
            raise ValueError("a part of the colour is no number")
        red, green, blue = (round(255 * min(1.0, max(0.0, part))) for part in parts)
        return red << 16 | green << 8 | blue
    text = parse_json(data)
    if not (isinstance(text, str) and re.fullmatch("#[0-9a-fA-F]{6}", text)):
        raise ValueError(f"a colour is four floats or #rrggbb, not {text!r:.40}")
    return int(text[1:], 16)


def devices(context: Context, robot: Robot) -> Iterable[Simulation]:
    """Every robot's program can report; what else it may do its model says."""
    return [Simulation(context, robot, robot.model.simulation == "full")]
