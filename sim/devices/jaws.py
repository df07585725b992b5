"""The space between a gripper's paddles, and what lies in it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from sim.stage.geometry import Floats, pieces, placed, reach
from sim.stage.limits import SLOP
from sim.worldfile.schema import Gripper

Pose = tuple[float, float, float]

INNER, OUTER = 4, 8
"""The bits of the two light beams, as Stage's grippers have them: the one near the robot, and the
one near the paddles' tips."""
BEAMS = ((INNER, -0.25), (OUTER, 0.25))
"""Where they cross the space between the paddles: in paddles' lengths ahead of its middle."""


class Between(NamedTuple):
    """A body that breaks a beam. `number`: among those that were looked at."""

    number: int
    beams: int
    """The bits of the beams that it breaks."""
    fits: bool
    """Whether all of it lies between the paddles, so that they can close on it."""
    off: float
    """m from the middle of the space to the body's."""
    sides: tuple[float, float]
    """From where to where it reaches across the space, m, left is positive."""


class Jaws:
    """The space between the paddles of a gripper that is mounted on a robot.

    bodies (m,): those of the schema that may come to lie in it.
    """

    def __init__(self, mount: Gripper, bodies: Sequence[Any]) -> None:
        x, y, heading = mount.pose
        self.pose: Pose = (x, y, math.radians(heading))
        self.length, self.width = mount.space
        self.bodies = bodies
        self.spans = np.array([reach(body) for body in bodies])
        self.spans += math.hypot(self.length, self.width) / 2

    def lying(self, robot: Floats, poses: Floats) -> Iterator[Between]:
        """Those of the bodies, which are at poses (m, 3), that break a beam.

        robot (3,): the pose of the gripper's robot. All poses are x, y, yaw in the world.
        """
        middle = placed(np.array([self.pose[:2]]), robot)[0]
        yaw = float(robot[2]) + self.pose[2]
        far = np.hypot(poses[:, 0] - middle[0], poses[:, 1] - middle[1])
        cos, sin = math.cos(yaw), math.sin(yaw)
        for number in np.flatnonzero(far <= self.spans).tolist():
            x, y = float(poses[number, 0] - middle[0]), float(poses[number, 1] - middle[1])
            at = (cos * x + sin * y, cos * y - sin * x, float(poses[number, 2]) - yaw)
            parts = [
                (placed(part.vertices, at), round_at(part.circle, at))
                for part in pieces(self.bodies[number])
            ]
            beams = sum(bit for bit, ahead in BEAMS if self.broken(parts, ahead * self.length))
            if beams:
                low, high = across(parts)
                fits = max(high, -low) <= self.width / 2 + SLOP
                yield Between(number, beams, fits, float(far[number]), (low, high))

    def broken(self, parts: Sequence[tuple[Floats, Any]], x: float) -> bool:
        """Whether any of the parts of a body crosses the beam at x, in the space's frame."""
        half = self.width / 2
        for vertices, circle in parts:
            reach = chord(vertices, circle, x)
            if reach is not None and reach[0] <= half and reach[1] >= -half:
                return True
        return False


def round_at(circle: tuple[float, float, float] | None, pose: Pose) -> Any:
    """A circle (x, y, radius) of a body, where the body is at a pose."""
    if circle is None:
        return None
    (x, y), radius = placed(np.array([circle[:2]]), pose)[0], circle[2]
    return float(x), float(y), radius


def across(parts: Sequence[tuple[Floats, Any]]) -> tuple[float, float]:
    """The least and the greatest y of the parts of a body."""
    ends = [
        (circle[1] - circle[2], circle[1] + circle[2])
        if circle is not None
        else (float(vertices[:, 1].min()), float(vertices[:, 1].max()))
        for vertices, circle in parts
    ]
    return min(low for low, _ in ends), max(high for _, high in ends)


def chord(vertices: Floats, circle: Any, x: float) -> tuple[float, float] | None:
    """From which y to which a convex part lies on the line at x; None where it does not."""
    if circle is not None:
        half = circle[2] ** 2 - (x - circle[0]) ** 2
        return None if half < 0.0 else (circle[1] - math.sqrt(half), circle[1] + math.sqrt(half))
    start, end = vertices, np.roll(vertices, -1, axis=0)
    low, high = np.minimum(start[:, 0], end[:, 0]), np.maximum(start[:, 0], end[:, 0])
    met = (low <= x) & (x <= high)
    if not met.any():
        return None
    start, end = start[met], end[met]
    along = end[:, 0] - start[:, 0]
    part = np.divide(x - start[:, 0], along, out=np.zeros(len(along)), where=along != 0.0)
    ys = np.concatenate([start[:, 1] + part * (end[:, 1] - start[:, 1]), end[along == 0.0, 1]])
    return float(ys.min()), float(ys.max())
