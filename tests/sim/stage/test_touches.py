"""What is told of bodies that touch: how often, at which points, along which stretches."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from stage_worlds import corners, robot, set_up, world

from sim.stage.layout import build_layout
from sim.stage.stage import Stage

DEEPEST = 0.02
"""m; bodies that touch overlap by less."""


def test_only_what_begins_to_touch_counts() -> None:
    _, stage = set_up(models={"a": robot()})
    stage.add_robot("a", (9.0, 5, 0))
    stage.command([0], [[0.5, 0.0, 0.0]])
    for _ in range(60):
        stage.tick()
    assert stage.contact_counts[0] == 1  # it has been pressed to the wall since
    assert stage.touching[0]
    stage.command([0], [[-0.5, 0.0, 0.0]])
    for _ in range(10):
        stage.tick()
    assert not stage.touching[0]
    stage.command([0], [[0.5, 0.0, 0.0]])
    for _ in range(30):
        stage.tick()
    assert stage.contact_counts[0] == 2


def test_a_robot_that_slides_over_the_seams_of_a_map_touches_one_wall_once(
    tmp_path: Any,
) -> None:
    # The steps below the row of free cells make a wall of many blocks with one straight face.
    rows = ["#" * 12, "#" + "." * 10 + "#", "#" * 12, "#.#.#.#.#.##", "############"]
    (tmp_path / "seams.txt").write_text("\n".join(rows))
    made = world(size=None, map={"file": "seams.txt", "cell": 1.0}, models={"a": robot("circle")})
    stage = Stage(build_layout(made, tmp_path), made.models, made.clock)
    stage.add_robot("a", (1.5, 3.26, math.radians(-20)))
    stage.command([0], [[0.5, 0.0, 0.0]])
    for _ in range(120):
        stage.tick()
    assert stage.poses[0, 0] > 5.0
    assert stage.contact_counts[0] == 1


def test_contact_points_lie_on_both_bodies() -> None:
    _, stage = set_up(models={"a": robot()})
    stage.add_robot("a", (4.7, 5, 0))
    stage.add_robot("a", (5.3, 5.1, math.pi))
    stage.add_robot("a", (2, 2, 0))
    stage.command([0, 1], [[0.5, 0.0, 0.0]] * 2)
    for _ in range(10):
        stage.tick()
    robots, points = stage.contact_points
    assert robots.tolist() == [0, 0, 1, 1]  # two corners each, the same from either side
    assert np.array_equal(points[:2], points[2:])
    for body, pose in ((stage.models["a"].body, stage.poses[k]) for k in range(2)):
        outline = corners(body, pose)
        for point in points:
            edges = zip(outline, np.roll(outline, -1, axis=0), strict=True)
            off = [abs(np.linalg.det([q - p, point - p])) / math.dist(p, q) for p, q in edges]
            assert min(off) <= DEEPEST / 2  # midway through the overlap
    assert points[:, 1].min() == pytest.approx(4.9, abs=0.02)
    assert points[:, 1].max() == pytest.approx(5.2, abs=0.02)


def test_touching_stretches_lie_on_the_robots_own_outlines() -> None:
    kinds = {"a": robot(), "b": robot("circle"), "c": robot("polygon")}
    _, stage = set_up(models=kinds, obstacles=[{"shape": "box", "size": (1, 1), "pose": (5, 5, 9)}])
    for k, (x, y) in enumerate(
        [(4.2, 5.1), (5.8, 4.9), (5.0, 5.8), (4.9, 4.2), (3.4, 5), (6.6, 5)]
    ):
        heading = math.atan2(5 - y, 5 - x)
        stage.add_robot("abc"[k % 3], (x, y, heading))
    stage.command(np.arange(6), [[0.5, 0.0, 0.0]] * 6)
    for _ in range(25):
        stage.tick()
    robots, starts, ends = stage.stretches
    assert set(robots) == set(range(6))
    assert robots.tolist() == sorted(robots)
    for number, *stretch in zip(robots, starts, ends, strict=True):
        body, pose = stage.model(number).body, stage.poses[number]
        for point in stretch:
            if body.shape == "circle":
                off = math.dist(point, pose[:2]) - body.radius
            else:
                outline = corners(body, pose)
                edges = zip(outline, np.roll(outline, -1, axis=0), strict=True)
                off = min(
                    abs(np.linalg.det([q - p, point - p])) / math.dist(p, q) for p, q in edges
                )
            # Poses and contacts are those of one and the same step: only rounding is between them.
            assert abs(off) < 1e-9
        if body.shape == "circle":
            assert np.array_equal(*stretch)
    lengths = np.hypot(*(ends - starts).T)
    assert 0.1 < lengths[robots == 0].max() <= 0.4  # a flat side on a flat one
