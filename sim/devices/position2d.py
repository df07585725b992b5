"""position2d: odometry out, velocities and goals in."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from player import DeviceAddr
from player.codes import Interface
from sim.devices.device import Context, Refused, Values, flat_pose, sane

STATE = np.dtype([("pose", ">f8", 3), ("velocity", ">f8", 3), ("stall", ">u4")])

Pose = tuple[float, float, float]

DRIVE = "drive"
"""The key of all that sets a robot's motion: of several commands in a tick the last one wins."""


class StateEncoder:
    """The state messages of all robots, encoded together once per tick."""

    def __init__(self) -> None:
        self.rows: NDArray[Any] = np.zeros(0, STATE)
        self.data = b""

    def update(
        self,
        poses: NDArray[np.float64],
        velocities: NDArray[np.float64],
        stalls: NDArray[np.bool_],
    ) -> None:
        """Take odometry poses (n, 3), velocities in the robots' frames (n, 3), stalls (n,)."""
        if len(self.rows) != len(poses):
            self.rows = np.zeros(len(poses), STATE)
        self.rows["pose"] = poses
        self.rows["velocity"] = velocities
        self.rows["stall"] = stalls
        self.data = self.rows.tobytes()

    def payload(self, robot: int) -> bytes:
        """Robot's message."""
        return self.data[robot * STATE.itemsize : (robot + 1) * STATE.itemsize]


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

    def __init__(
        self, context: Context, robot: int, states: StateEncoder, size: tuple[float, float, float]
    ) -> None:
        self.context = context
        self.robot = robot
        self.states = states
        self.size = size
        self.addr = DeviceAddr(Interface.POSITION2D, 0)
        drive = context.models[robot].drive
        self.is_car = drive is not None and drive.kind == "car"

    def publish(self) -> Iterable[tuple[int, bytes]]:
        return ((1, self.states.payload(self.robot)),)

    def command(self, name: str, values: Values) -> None:
        robot, context = self.robot, self.context
        if name == "velocity":
            vx, vy, wz = twist = values["vel"]
            if sane(vx, vy, wz):
                context.later(robot, lambda: context.drive(robot, twist), DRIVE)
        elif name == "car" and self.is_car:
            if sane(values["velocity"], values["angle"]):
                context.later(robot, lambda: self.steer(values), DRIVE)
        elif name == "position" and not self.is_car:
            if sane(*values["pos"], *values["vel"]):
                context.later(robot, lambda: self.go_to(values), DRIVE)
        elif (
            name == "velocity_heading"
            and not self.is_car
            and sane(values["velocity"], values["heading"])
        ):
            context.later(robot, lambda: self.head(values), DRIVE)

    def go_to(self, values: Values) -> None:
        goal, speed = self.to_world(values["pos"]), values["vel"]
        self.context.undrive(self.robot)
        self.context.stage.command_position(self.robot, goal, abs(speed[0]), abs(speed[2]))

    def steer(self, values: Values) -> None:
        self.context.undrive(self.robot)
        self.context.stage.command_car(self.robot, values["velocity"], values["angle"])

    def head(self, values: Values) -> None:
        yaw = self.to_world((0.0, 0.0, values["heading"]))[2]
        self.context.undrive(self.robot)
        self.context.stage.command_heading(self.robot, values["velocity"], yaw)

    def request(self, name: str, values: Values) -> Values | None:
        context, robot = self.context, self.robot
        if name == "geometry":
            length, width, height = self.size
            return {"pose": flat_pose(), "size": (width, length, height)}
        if name == "motor_power":
            on = bool(values["state"])
            context.later(robot, lambda: context.stage.motors(robot, on), "motors")
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
        robot, odometry = self.robot, self.context.odometry
        self.context.later(robot, lambda: odometry.set_odometry(robot, pose), "odometry")

    def to_world(self, pose: Pose) -> Pose:
        """A pose in the odometry's frame, in the world's, as the last tick's odometry tells."""
        x, y, yaw = map(float, self.context.stage.poses[self.robot])
        reported = tuple(map(float, self.context.odometry.poses[self.robot]))
        return compose((x, y, yaw), compose(invert((reported[0], reported[1], reported[2])), pose))
