"""What stands in a world is seen as its file gives it: every shape, to 1e-9 m."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sensors.cones import cast_cones
from sensors.rays import bearings_of, cast
from tests.sim.moved_world import Moved
from troupe.testing import rays

NOWHERE = np.zeros(3)
ROOM = np.array([[0, 0], [12, 0], [12, 9], [0, 9]], float)
REGION = np.array([[1, 1], [11, 0.5], [11.5, 5], [7, 8.5], [0.5, 7]], float)
CELLS = ["........", ".##...#.", "..#.....", "..##....", "......#.", "#......."]
CELL = 1.5
BOX = np.array([[-1, -0.3], [1, -0.3], [1, 0.3], [-1, 0.3]])
KITE = np.array([[0.8, 0], [0, 0.5], [-0.7, 0], [0, -0.4]])
OBSTACLES = """\
obstacles:
  - {shape: circle, radius: 0.7, pose: [3, 4, 0]}
  - {shape: circle, radius: 0.1, pose: [5, 2, 30], color: red}
  - {shape: circle, radius: 1.2, pose: [9, 4, 0], height: 2}
  - {shape: circle, radius: 0.5, pose: [6, 6.5, 0], movable: true}
  - {shape: box, size: [2, 0.6], pose: [6, 4.5, 35]}
  - {shape: polygon, points: [[0.8, 0], [0, 0.5], [-0.7, 0], [0, -0.4]], pose: [7.5, 2, -70]}
"""
ROUND = [(3, 4, 0.7), (5, 2, 0.1), (9, 4, 1.2), (6, 6.5, 0.5)]


def standing(world: rays.Things) -> None:
    """The same obstacles for the other method."""
    for x, y, radius in ROUND:
        world.circle(1, np.array([x, y, 0.0]), radius)
    world.polygon(1, np.array([6, 4.5, np.radians(35)]), BOX)
    world.polygon(1, np.array([7.5, 2, np.radians(-70)]), KITE)


def walls(world: rays.Things, ring: np.ndarray) -> None:
    """A boundary along a ring: all beyond it is solid."""
    world.segments(0, NOWHERE, np.hstack([ring, np.roll(ring, -1, axis=0)]))
    world.inside(0, NOWHERE, ring, True)


@pytest.mark.parametrize("around", ["size", "region", "map", "nothing"])
def test_ranges_to_everything_that_stands_are_exact(around: str, tmp_path: Path) -> None:
    world = rays.Things()
    text = "size: [12, 9]\nduration: 1\n" + OBSTACLES
    standing(world)
    if around == "region":
        text += f"region: {REGION.tolist()}\nboundary: {{shape: region}}\n"
        walls(world, REGION)
    elif around == "nothing":
        text += "boundary: null\n"
    else:
        walls(world, ROOM)
    if around == "map":
        text += "map: {file: cells.txt, cell: 1.5}\n"
        for row, line in enumerate(CELLS):
            for column, letter in enumerate(line):
                if letter == "#":
                    corner = np.array([column, len(CELLS) - 1 - row])
                    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
                    world.polygon(0, NOWHERE, CELL * (corner + square))
    moved = Moved(tmp_path, text, **{"cells.txt": "\n".join(CELLS)})
    moved.drive([], 0.0)
    rng = np.random.default_rng(7)
    places = rng.uniform((-0.5, -0.5), (12.5, 9.5), (150, 2))
    for x, y, radius in ROUND:  # and close to what is round, where a polygon would be seen
        angles = rng.uniform(-np.pi, np.pi, 15)
        away = radius + rng.choice([1e-3, -1e-3, 1e-6, 0.05], 15)
        near = [x + away * np.cos(angles), y + away * np.sin(angles)]
        places = np.vstack([places, np.transpose(near)])
    origins = np.column_stack([places, rng.uniform(-np.pi, np.pi, len(places))])
    nobody = np.full(len(origins), -1)
    scene = moved.scenery.scene
    for fov, samples in ((2 * np.pi, 90), (0.3, 1)):
        ranges, hits = cast(scene, origins, nobody, fov, samples, 20.0)
        for k, origin in enumerate(origins):
            answer = rays.scan(world, origin, -1, bearings_of(fov, samples), 20.0)
            answer.owner[:] = hits[k]  # entities are numbered by colour and height
            rays.check_scan(answer, ranges[k], hits[k], 20.0)
    cones = np.empty(len(origins))
    cast_cones(scene.arrays, origins, nobody, 0.4, 20.0, cones)
    for origin, measured in zip(origins, cones, strict=True):
        low, high = rays.cone(world, origin, -1, 0.4, 20.0)
        assert low - 1e-9 <= measured <= high + 1e-9
