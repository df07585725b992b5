"""How exactly Paint's observe step places robots: random scenes, one look each."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from controllers.paint.geometry import Pose, rectangle
from controllers.paint.observe import GREEN, RED, Scan, see_robots, take_scan
from controllers.paint.squares import Square
from sensors.rays import bearings_of, cast
from sensors.scene import Scene

REGION = rectangle(16.0, 21.0)
BODY = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
OUTSIDE = 0.1  # m: so far beyond its bounds a robot counts as out of them


@dataclass(frozen=True)
class Patch:
    """A run of one colour in the image."""

    color: int
    left: int
    right: int


@dataclass
class Errors:
    """Distances (m) of seen centres from the true ones, and of the points' plain means."""

    distance: list[float] = field(default_factory=list)
    plain: list[float] = field(default_factory=list)
    outside: int = 0

    def quantile(self, share: float, plain: bool = False) -> float:
        """The error that a share of the sightings does not exceed, m."""
        return float(np.quantile(self.plain if plain else self.distance, share))


def errors(scenes: int, tilted: bool, seed: int = 1) -> Errors:
    """Errors over random scenes of four robots; `tilted`: turned any way, else along the axes."""
    rng = np.random.default_rng(seed)
    found = Errors()
    for _ in range(scenes):
        robots = place(rng, tilted)
        squares, scan = look(robots, rng.uniform(-math.pi, math.pi))
        for square in squares:
            gaps = np.hypot(*(robots[1:, :2] - square.centre).T)
            true = robots[1 + int(np.argmin(gaps)), :2]
            found.distance.append(float(gaps.min()))
            beyond = [
                max(low - v, v - high)
                for (low, high), v in zip((square.x, square.y), true, strict=True)
            ]
            found.outside += max(beyond) > OUTSIDE
            on_it = np.hypot(*(scan.points - true).T) < 0.75
            found.plain.append(float(np.hypot(*(scan.points[on_it].mean(axis=0) - true))))
    return found


def place(rng: np.random.Generator, tilted: bool) -> np.ndarray:
    """Poses (4, 3) of robots that are 0.5 m apart and from the walls."""
    while True:
        xy = rng.uniform((1.0, 1.0), (15.0, 20.0), (4, 2))
        gaps = np.abs(xy[:, None] - xy[None]).max(axis=2) + 10.0 * np.eye(4)
        if gaps.min() > 1.5:
            break
    quarter = math.pi / 2 * rng.integers(0, 4, 4)
    return np.column_stack([xy, rng.uniform(-math.pi, math.pi, 4) if tilted else quarter])


def look(robots: np.ndarray, yaw: float) -> tuple[list[Square], Scan]:
    """What the first robot sees of the others when it looks in a direction."""
    scene = Scene()
    walls = scene.add_entity(color=RED)
    corners = REGION.corners
    scene.add_segments(walls, np.hstack([corners, np.roll(corners, -1, axis=0)]))
    for robot in robots:
        scene.add_polygon(scene.add_entity(color=GREEN, pose=robot), BODY)
    scene.refresh()
    eye = np.array([[robots[0, 0], robots[0, 1], yaw]])
    ranges, _ = cast(scene, eye, np.array([1]), math.pi, 180, 20.0)
    _, hits = cast(scene, eye, np.array([1]), math.pi, 160, 20.0)
    colors = np.array([0, RED, *[GREEN] * len(robots)])[hits[0, ::-1] + 1]
    blobs = [Patch(int(c), k, k) for k, c in enumerate(colors) if c]
    pose = Pose(float(eye[0, 0]), float(eye[0, 1]), yaw)
    scan = take_scan(pose, ranges[0], bearings_of(math.pi, 180), 20.0, blobs, 160)
    return see_robots(scan, REGION.depth(scan.points)), scan
