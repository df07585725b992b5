"""A world with everything that can be served, and its geometry as numbers of the tests' own."""

from __future__ import annotations

import math

WORLD = """\
size: [10, 10]
models:
  complete:
    body: {shape: box, size: [1.0, 0.8], height: 1.0, color: green}
    simulation: full
    fiducial: 7
    sensors:
      - {type: laser, pose: [0.2, 0, 0], range: 8, fov: 180, samples: 181}
      - {type: ranger, elements: [[0.5, 0, 0], [0, 0.4, 90], [-0.5, 0, 180], [0, -0.4, -90]],
         range: 5, fov: 10}
      - {type: blobfinder, range: 20, fov: 180, image: [160, 120], colors: [red, green, blue]}
      - {type: fiducial, range: 8, fov: 360}
      - {type: bumper}
    actuators: [{type: sprayer, size: [1.0, 1.0]}]
  plain:
    body: {shape: circle, radius: 0.4, height: 1.0, color: blue}
    fiducial: 9
    sensors: [{type: laser, samples: 5}]
robots:
  - {name: one, model: complete, pose: [3, 4, 30], controller: hand}
  - {name: two, model: plain, pose: [6.5, 5.5, -100], controller: hand}
obstacles: [{shape: box, size: [1, 1], pose: [2, 8, 0], color: green}]
controllers: {hand: {external: true}}
"""

SIZE = 10.0
ONE = (3.0, 4.0, math.radians(30))
TWO = (6.5, 5.5, math.radians(-100))
RADIUS = 0.4  # of two's body
BOX = (1.5, 7.5, 2.5, 8.5)  # the obstacle's x, y from and to

Segment = tuple[float, float, float, float]


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[Segment]:
    return [(x0, y0, x1, y0), (x1, y0, x1, y1), (x1, y1, x0, y1), (x0, y1, x0, y0)]


WALLS = rectangle(0, 0, SIZE, SIZE) + rectangle(*BOX)


def placed(pose: tuple[float, float, float], x: float, y: float) -> tuple[float, float]:
    """A point of a robot's frame in the world."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    return pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y


def ray(
    x: float, y: float, heading: float, circles: list[tuple[float, float, float]]
) -> tuple[float, bool]:
    """How far it is to the next wall or circle (x, y, radius), and whether that is a circle."""
    dx, dy = math.cos(heading), math.sin(heading)
    nearest, is_circle = math.inf, False
    for x0, y0, x1, y1 in WALLS:
        ex, ey = x1 - x0, y1 - y0
        det = ex * dy - ey * dx
        if abs(det) < 1e-12:
            continue
        along = (ex * (y0 - y) - ey * (x0 - x)) / det
        part = (dx * (y0 - y) - dy * (x0 - x)) / det
        if along > 0 and -1e-9 <= part <= 1 + 1e-9 and along < nearest:
            nearest, is_circle = along, False
    for cx, cy, radius in circles:
        ahead = (cx - x) * dx + (cy - y) * dy
        aside = (cx - x) * dy - (cy - y) * dx
        if ahead > 0 and abs(aside) < radius:
            reach = ahead - math.sqrt(radius**2 - aside**2)
            if reach < nearest:
                nearest, is_circle = reach, True
    return nearest, is_circle
