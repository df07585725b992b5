"""How exactly Paint's observe step places robots: random scenes, one look each."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from controllers.paint.sight.scan import Scan, see_robots
from controllers.paint.sight.squares import Square
from troupe.testing.paint.scene import REGION, look

OUTSIDE = 0.1  # m: so far beyond its bounds a robot counts as out of them


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
        squares, scan = see(robots, rng.uniform(-math.pi, math.pi))
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


def see(robots: np.ndarray, yaw: float) -> tuple[list[Square], Scan]:
    """What the first robot sees of the others when it looks in a direction."""
    scan = look(robots, yaw)
    return see_robots(scan, REGION.depth(scan.points)), scan
