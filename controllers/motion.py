"""Motion that controllers share: angles, turning to a heading, driving to a point.

Everything here is a pure function of a pose and a goal, in one frame (a robot's odometry, say):
metres, seconds, radians counter-clockwise. What comes back is a twist for
`Position2dProxy.set_speed`.
"""

from __future__ import annotations

import math
from typing import NamedTuple


class Twist(NamedTuple):
    """Forward speed and sideways speed (to the left) in m/s, turn rate in rad/s."""

    vx: float
    vy: float
    vyaw: float


REST = Twist(0.0, 0.0, 0.0)


def wrap(angle: float) -> float:
    """The same angle in (-pi, pi]."""
    wrapped = math.remainder(angle, math.tau)
    return math.pi if wrapped == -math.pi else wrapped


BRAKING = 1.5
"""m/s2 and rad/s2 with which to slow down: below what drives usually can (2 m/s2, 6 rad/s2)."""


def approach(error: float, most: float, interval: float, braking: float = BRAKING) -> float:
    """A speed that brings `error` to zero without passing it.

    `error` and the speed are of one kind (m and m/s, or rad and rad/s); `most` limits the speed.
    From far the speed is that from which `braking` just stops in time, one `interval` late;
    from near it is half of the error per interval.
    """
    way = abs(error)
    late = braking * interval
    stopping = math.sqrt(late * late + 2.0 * braking * way) - late
    return math.copysign(min(most, stopping, 0.5 * way / interval), error)


def turn_to(yaw: float, heading: float, max_turn_rate: float, interval: float = 0.1) -> float:
    """The turn rate (rad/s) that turns from `yaw` to `heading` the short way."""
    return approach(wrap(heading - yaw), max_turn_rate, interval)


def drive_to(
    pose: tuple[float, float, float],
    goal: tuple[float, float],
    max_speed: float,
    max_turn_rate: float,
    interval: float = 0.1,
) -> Twist:
    """The twist by which a differential robot gets to a point: turn first, then drive.

    It drives forward only while the goal lies within 30 degrees of its heading, slower the
    further aside. At the goal (within a millimetre) it rests.
    """
    dx, dy = goal[0] - pose[0], goal[1] - pose[1]
    distance = math.hypot(dx, dy)
    if distance < 1e-3:
        return REST
    aside = wrap(math.atan2(dy, dx) - pose[2])
    turn = approach(aside, max_turn_rate, interval)
    if abs(aside) > math.radians(30):
        return Twist(0.0, 0.0, turn)
    return Twist(approach(distance * math.cos(aside), max_speed, interval), 0.0, turn)


def slide_to(
    pose: tuple[float, float, float],
    goal: tuple[float, float],
    heading: float,
    max_speed: float,
    max_turn_rate: float,
    interval: float = 0.1,
) -> Twist:
    """The twist by which an omnidirectional robot gets to a point on a straight line.

    It turns to `heading` on the way; its speed is at most `max_speed` in any direction.
    """
    dx, dy = goal[0] - pose[0], goal[1] - pose[1]
    distance = math.hypot(dx, dy)
    turn = turn_to(pose[2], heading, max_turn_rate, interval)
    if distance == 0.0:
        return Twist(0.0, 0.0, turn)
    speed = approach(distance, max_speed, interval)
    along, across = dx / distance * speed, dy / distance * speed
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    return Twist(cos * along + sin * across, -sin * along + cos * across, turn)
