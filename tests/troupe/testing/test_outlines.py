"""How far apart shapes are, beside a search over the points of their edges."""

from __future__ import annotations

import math

import numpy as np
import pytest

from troupe.testing.outlines import Outline, placed, separation, within

BOX = np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]])
KITE = np.array([[0.8, 0.0], [0.0, 0.5], [-0.7, 0.0], [0.0, -0.4]])
SHAPES: list[Outline] = [BOX, KITE, 0.6]
STEP = 0.02
"""Metres between the points of the edges."""


def edge(outline: Outline, pose: np.ndarray) -> np.ndarray:
    """Points (k, 2) along an outline, closer to each other than STEP."""
    if isinstance(outline, float):
        angles = np.arange(0.0, math.tau, STEP / outline)
        return outline * np.stack([np.cos(angles), np.sin(angles)], axis=1) + pose[:2]
    corners = placed(outline, pose[None])[0]
    part = np.linspace(0.0, 1.0, 120)[:, None, None]
    return (corners + part * (np.roll(corners, -1, axis=0) - corners)).reshape(-1, 2)


@pytest.mark.parametrize("one", range(3))
@pytest.mark.parametrize("other", range(3))
def test_the_distance_of_two_shapes_is_that_of_their_nearest_points(one: int, other: int) -> None:
    rng = np.random.default_rng([one, other])
    poses = np.column_stack([rng.uniform(-2.5, 2.5, (40, 2)), rng.uniform(-4, 4, 40)])
    origin = np.tile([0.3, -0.2, 0.5], (40, 1))
    found = separation(SHAPES[one], poses, SHAPES[other], origin)
    assert (found < 0.0).sum() > 2
    for pose, gap in zip(poses[found > 0.0], found[found > 0.0], strict=True):
        a, b = edge(SHAPES[one], pose), edge(SHAPES[other], origin[0])
        nearest = np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1)).min()
        assert gap - 1e-9 <= nearest <= gap + STEP


@pytest.mark.parametrize("one", range(3))
@pytest.mark.parametrize("other", range(3))
def test_shapes_that_overlap_touch_when_moved_apart_by_the_depth_and_not_by_less(
    one: int, other: int
) -> None:
    rng = np.random.default_rng([one, other, 1])
    poses = np.column_stack([rng.uniform(-1.0, 1.0, (60, 2)), rng.uniform(-4, 4, 60)])
    origin = np.zeros((60, 3))
    depth = -separation(SHAPES[one], poses, SHAPES[other], origin)
    for pose, deep in zip(poses[depth > 1e-3], depth[depth > 1e-3], strict=True):
        angles = np.linspace(-math.pi, math.pi, 721)
        ways = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
        there = np.zeros_like(ways)

        def after(
            metres: float, pose: np.ndarray = pose, ways: np.ndarray = ways,
            there: np.ndarray = there,
        ) -> float:  # fmt: skip
            moved = separation(SHAPES[one], pose + metres * ways, SHAPES[other], there)
            return float(moved.max())

        assert after(0.999 * deep) < 0.0
        assert after(1.001 * deep + 1e-4) > 0.0


@pytest.mark.parametrize("shape", range(3))
def test_in_an_arena_the_nearest_wall_counts(shape: int) -> None:
    arena = np.array([[0.0, 0.0], [6.0, 1.0], [5.0, 5.0], [-1.0, 4.0]])
    rng = np.random.default_rng(shape)
    poses = np.column_stack([rng.uniform((0, 0), (5, 5), (30, 2)), rng.uniform(-4, 4, 30)])
    found = within(SHAPES[shape], poses, arena)
    assert (found < 0.0).any()
    for pose, gap in zip(poses, found, strict=True):
        points = edge(SHAPES[shape], pose)
        walls = zip(arena, np.roll(arena, -1, axis=0), strict=True)
        heights = [
            ((b - a)[0] * (points - a)[:, 1] - (b - a)[1] * (points - a)[:, 0]) / math.dist(a, b)
            for a, b in walls
        ]
        assert gap - 1e-9 <= np.min(heights) <= gap + STEP
