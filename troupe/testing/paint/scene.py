"""One look of a painting robot at others that stand in its arena, without a world that runs."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.paint.geometry import Pose, rectangle
from controllers.paint.sight.scan import GREEN, RED, Scan, take_scan
from sensors.rays import bearings_of, cast
from sensors.scene import Scene

REGION = rectangle(16.0, 21.0)
BODY = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


class Patch(NamedTuple):
    """A run of one colour in the image: 0xRRGGBB and its first and last column."""

    color: int
    left: int
    right: int


def look(robots: NDArray[np.float64], yaw: float, own_frame: bool = False) -> Scan:
    """What the first of the robots (n, 3) scans when it heads `yaw`.

    The scan is placed in the arena's frame, or in that of the robot, with its origin at the robot.
    """
    scene = Scene()
    walls = scene.add_entity(color=RED)
    corners = REGION.corners
    scene.add_segments(walls, np.hstack([corners, np.roll(corners, -1, axis=0)]))
    for robot in robots:
        scene.add_polygon(scene.add_entity(color=GREEN, pose=robot), BODY)
    scene.refresh()
    x, y = (float(v) for v in robots[0, :2])
    eye = np.array([[x, y, yaw]])
    ranges, _ = cast(scene, eye, np.array([1]), math.pi, 180, 20.0)
    _, hits = cast(scene, eye, np.array([1]), math.pi, 160, 20.0)
    colors = np.array([0, RED, *[GREEN] * len(robots)])[hits[0, ::-1] + 1]
    blobs = [Patch(int(color), k, k) for k, color in enumerate(colors) if color]
    pose = Pose(0.0, 0.0, yaw - float(robots[0, 2])) if own_frame else Pose(x, y, yaw)
    return take_scan(pose, ranges[0], bearings_of(math.pi, 180), 20.0, blobs, 160)
