"""position2d: odometry out, velocities and goals in."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import partial

from player import DeviceAddr
from player.codes import Interface
from sim.devices.device import (
    FARTHEST,
    Context,
    Refused,
    Values,
    finite,
    flat_pose,
    heading,
    limited,
    sane,
    scaled,
)
from sim.devices.encoding import Encodings
from sim.devices.rounds import Standing
from sim.robot import Robot
from sim.stage.geometry import extent, size_of

Pose = tuple[float, float, float]

NUMBERS: dict[str, Callable[[Values], tuple[float, ...]]] = {
    "velocity": lambda values: tuple(values["vel"]),
    "position": lambda values: (*values["pos"], *values["vel"]),
    "car": lambda values: (values["velocity"], values["angle"]),
    "velocity_heading": lambda values: (values["velocity"], values["heading"]),
}
"""What the commands say of where to and how fast."""

DRIVE = "drive"
"""The key of all that sets a robot's motion: of several commands in a tick the last one wins."""


def compose(a: Pose, b: Pose) -> Pose:
    """Pose `b`, given in the frame of `a`, in the frame that `a` is given in."""
    cos, sin = math.cos(a[2]), math.sin(a[2])
    return (a[0] + cos * b[0] - sin * b[1], a[1] + sin * b[0] + cos * b[1], a[2] + b[2])


def invert(a: Pose) -> Pose:
    """The pose of the frame that `a` is given in, in the frame of `a`."""
    cos, sin = math.cos(a[2]), math.sin(a[2])
    return (-cos * a[0] - sin * a[1], sin * a[0] - cos * a[1], -a[2])


class Position2d:
    """A robot's drive and odometry."""

    def __init__(self, context: Context, encodings: Encodings, robot: Robot) -> None:
        self.context = context
        self.stage, self.odometry = context.scenery.stage, context.scenery.odometry
        self.robot = robot
        self.states = encodings.states
        self.addr = DeviceAddr(Interface.POSITION2D, 0)
        drive = robot.model.drive
        self.kind = "differential" if drive is None else drive.kind
        self.obeys: dict[str, Callable[[Values], None]] = {"velocity": self.move}
        if self.kind == "car":
            self.obeys["car"] = self.steer
        else:
            self.obeys |= {"position": self.go_to, "velocity_heading": self.head}

    def standing(self) -> Standing:
        """What it always tells."""
        return Standing(1, self.states, self.robot.index)

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ((1, self.states.payload(self.robot.index)),)

    def command(self, name: str, values: Values) -> None:
        """Obey, within the drive's limits; at what is no number the robot stops."""
        if name == "velocity":
            (vx, vy, wz), most = values["vel"], FARTHEST
            if most >= vx >= -most and most >= vy >= -most and most >= wz >= -most:
                self.context.put_off(self.robot, (vx, vy, wz), DRIVE)
                return
        obey = self.obeys.get(name)
        if obey is None:
            return
        numbers = NUMBERS[name](values)
        if finite(*numbers):
            self.context.later(self.robot, partial(obey, values), DRIVE)
            return
        self.context.later(self.robot, self.stop, DRIVE)
        told = ", ".join(f"{number:g}" for number in numbers)
        self.context.complain(
            self.robot, f"the command {name} ({told}), which is no number: the robot stops"
        )

    def stop(self) -> None:
        self.context.drive(self.robot, (0.0, 0.0, 0.0))

    def move(self, values: Values) -> None:
        vx, vy, wz = twist = values["vel"]
        if max(twist) > FARTHEST or min(twist) < -FARTHEST:
            if self.kind == "omnidirectional":
                vx, vy = scaled(vx, vy)
            elif self.kind == "car":
                vx, wz = scaled(vx, wz)  # the ratio is the circle that it drives
            twist = (limited(vx), limited(vy), limited(wz))
        self.context.drive(self.robot, twist)

    def go_to(self, values: Values) -> None:
        (x, y, yaw), speed = values["pos"], values["vel"]
        goal = self.to_world((*scaled(x, y), heading(yaw)))
        self.context.undrive(self.robot)
        self.stage.command_position(self.robot.index, goal, abs(speed[0]), abs(speed[2]))

    def steer(self, values: Values) -> None:
        self.context.undrive(self.robot)
        self.stage.command_car(self.robot.index, values["velocity"], values["angle"])

    def head(self, values: Values) -> None:
        yaw = self.to_world((0.0, 0.0, heading(values["heading"])))[2]
        self.context.undrive(self.robot)
        self.stage.command_heading(self.robot.index, values["velocity"], yaw)

    def request(self, name: str, values: Values) -> Values | None:
        context, robot = self.context, self.robot
        if name == "geometry":
            length, width, height = size_of(robot.model.body)
            least, most = extent(robot.model.body)
            x, y = map(float, (least + most) / 2)  # the body's middle need not be its origin
            return {"pose": flat_pose(x, y), "size": (width, length, height)}
        if name == "motor_power":
            on = bool(values["state"])
            context.later(robot, lambda: self.stage.motors(robot.index, on), "motors")
            return None
        if name == "position_mode":
            return None  # velocity or position: each command says itself which it is
        if name == "set_odometry":
            pose = values["pose"]
            if not sane(*pose):
                raise Refused
            self.set_odometry(pose)
            return None
        if name == "reset_odometry":
            self.set_odometry((0.0, 0.0, 0.0))
            return None
        raise Refused

    def set_odometry(self, pose: Pose) -> None:
        robot, odometry = self.robot, self.odometry
        self.context.later(robot, lambda: odometry.set_odometry(robot.index, pose), "odometry")

    def to_world(self, pose: Pose) -> Pose:
        """A pose in the odometry's frame, in the world's, as the last tick's odometry tells."""
        x, y, yaw = map(float, self.stage.poses[self.robot.index])
        reported = tuple(map(float, self.odometry.poses[self.robot.index]))
        return compose((x, y, yaw), compose(invert((reported[0], reported[1], reported[2])), pose))
