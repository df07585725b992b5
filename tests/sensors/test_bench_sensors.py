"""Benchmarks of the sensors' parts: `pytest tests/sensors/test_bench_sensors.py --benchmark-only`.

The crowd is 1000 boxes of 1 m at 0.01 robots/m2; each sees 180 rays, 180 degrees, 20 m. The time of
`test_rays_of_1000_robots` over 180 000 is that of a ray.
"""

import numpy as np
import pytest

from sensors.odometry import Odometry
from sensors.rays import cast
from sensors.registry import settings_for
from sensors.scene import Scene
from sensors.suite import Suite
from sensors.view import Contacts

BOX = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
KINDS = {
    "laser": {"type": "laser"},
    "noisy laser": {"type": "laser", "noise": 0.01},
    "blobfinder": {"type": "blobfinder", "colors": ["red", "green"]},
    "ranger": {"type": "ranger", "elements": [[0, 0, a] for a in range(-90, 91, 30)]},
    "fiducial": {"type": "fiducial"},
    "bumper": {"type": "bumper"},
}


def crowd(robots, density, *specs):
    """Robots at random places in a square room; returns its scene and suite."""
    side = (robots / density) ** 0.5
    rng = np.random.default_rng(1)
    scene = Scene()
    wall = scene.add_entity(color=0xFF0000)
    corners = np.array([[0, 0], [side, 0], [side, side], [0, side]])
    scene.add_segments(wall, np.hstack([corners, np.roll(corners, -1, axis=0)]))
    scene.add_solid(wall, corners[::-1])
    suite = Suite(scene, 1)
    for k in range(robots):
        pose = (*rng.uniform(0.5, side - 0.5, 2), rng.uniform(-np.pi, np.pi))
        entity = scene.add_entity(color=0x00FF00, fiducial=1, pose=pose)
        scene.add_polygon(entity, BOX)
        suite.add_robot(entity, f"r{k}", [settings_for(spec) for spec in specs])
    scene.refresh()
    return scene, suite


@pytest.mark.parametrize("density", [0.01, 0.1])
def test_rays_of_1000_robots(benchmark, density):
    scene, _ = crowd(1000, density)
    origins, own = scene.poses[1:].copy(), np.arange(1, 1001)
    out = cast(scene, origins, own, np.pi, 180, 20.0)
    rows = np.arange(1000)
    ranges, _ = benchmark(cast, scene, origins, own, np.pi, 180, 20.0, rows=rows, out=out)
    assert (ranges < 20.0).any()


def test_rays_in_a_map_of_5000_walls(benchmark):
    scene, _ = crowd(100, 0.05)
    rng = np.random.default_rng(2)
    start = rng.uniform(0, 45, (5000, 2))
    scene.add_segments(0, np.hstack([start, start + rng.uniform(-0.3, 0.3, start.shape)]))
    scene.refresh()
    origins, own = scene.poses[1:].copy(), np.arange(1, 101)
    ranges, _ = benchmark(cast, scene, origins, own, np.pi, 180, 20.0)
    assert (ranges < 20.0).any()


@pytest.mark.parametrize("kind", KINDS)
def test_sensing_of_1000_robots(benchmark, kind):
    scene, suite = crowd(1000, 0.01, KINDS[kind])
    suite.contacts = Contacts(np.arange(50), scene.poses[1:51, :2] + 0.5)
    benchmark(suite.sense, 1, 0.1)
    assert suite.groups[0].times.min() == 0.1


def test_a_tick_of_four_robots(benchmark):
    """Refresh, laser and blobfinder in a world of 16 m, with Python's part."""
    scene, suite = crowd(4, 4 / 256, KINDS["laser"], KINDS["blobfinder"])

    def tick():
        scene.refresh()
        suite.sense(1, 0.1)

    benchmark(tick)
    assert suite.groups[1].readings.counts.min() > 0


def test_refreshing_1000_bodies(benchmark):
    scene, _ = crowd(1000, 0.01)
    benchmark(scene.refresh)
    assert len(scene) == 1001


def test_odometry_of_1000_robots(benchmark):
    odometry = Odometry(1)
    for k in range(1000):
        odometry.add_robot(f"r{k}", (0, 0, 0), slip=0.02, turn=0.02)
    poses = np.ones((1000, 3))
    benchmark(odometry.update, poses, 0.1, 1)
    assert len(odometry.poses) == 1000
