"""The twist that leads somewhere: at most so fast, at most so far, slower towards the end."""

from __future__ import annotations

import math
from typing import NamedTuple

from controllers.motion import turn_to, wrap

from ..geometry import Pose

AIMED = math.radians(0.06)
"""A gaze is taken when it is off by less."""


class Limits(NamedTuple):
    """The drive's limits: m/s, rad/s, and the time from reading to reading, s."""

    speed: float
    turn_rate: float
    interval: float


class Motion(NamedTuple):
    """A twist in the robot's frame: m/s ahead, m/s to the left, rad/s."""

    ahead: float
    left: float
    turn: float


REST = Motion(0.0, 0.0, 0.0)

LIMITS = Limits(0.5, math.radians(90.0), 0.1)
"""The limits of the robots in the worlds that come with Troupe."""


def drive(
    pose: Pose, target: tuple[float, float], travel: float, limits: Limits, settle: float
) -> Motion:
    """The twist towards a target, at most `travel` metres on; slower over `settle` seconds."""
    dx, dy = target[0] - pose.x, target[1] - pose.y
    length = math.hypot(dx, dy)
    if length < 1e-6 or travel <= 0.0:
        return REST
    speed = min(limits.speed, travel / settle)
    vx, vy = dx / length * speed, dy / length * speed
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    return Motion(cos * vx + sin * vy, cos * vy - sin * vx, 0.0)


def turn(pose: Pose, gaze: float, limits: Limits) -> Motion:
    """The twist that turns on the spot towards a heading."""
    return Motion(0.0, 0.0, turn_to(pose.yaw, gaze, limits.turn_rate, limits.interval))


def looks_at(pose: Pose, gaze: float) -> bool:
    """Whether the robot's heading is the wanted one."""
    return abs(wrap(gaze - pose.yaw)) < AIMED
