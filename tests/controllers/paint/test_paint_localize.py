"""A robot finds the walls where they are, or does not yet: never elsewhere."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.paint.geometry import Region, rectangle
from controllers.paint.sight.localize import locate
from controllers.paint.sight.scan import red_points
from troupe.testing.paint.scene import look

SHAPE = rectangle(16.0, 21.0)
NOISE = 0.01  # m: standard deviation of a noisy laser's ranges

places = st.tuples(st.floats(1.0, 15.0), st.floats(1.0, 20.0))


def walls(region: Region) -> list[float]:
    return [region.left, region.right, region.bottom, region.top]


def true_walls(x: float, y: float, turned: bool) -> list[float]:
    found = [-x, 16.0 - x, -y, 21.0 - y]
    return [x - 16.0, x, y - 21.0, y] if turned else found


def crowd(own: tuple[float, float], others: list[tuple[float, float]], turned: bool) -> np.ndarray:
    """Poses (n, 3) of a robot and of those others that stand clear of it and of each other."""
    kept = [own]
    for place in others:
        if all(max(abs(place[0] - x), abs(place[1] - y)) > 1.1 for x, y in kept):
            kept.append(place)
    heading = math.pi if turned else 0.0
    return np.array([[x, y, heading] for x, y in kept])


@settings(max_examples=300)
@given(places, st.lists(places, max_size=15), st.booleans(), st.floats(-math.pi, math.pi))
def test_walls_are_found_where_they_are_or_not_yet(
    own: tuple[float, float], others: list[tuple[float, float]], turned: bool, gaze: float
) -> None:
    robots = crowd(own, others, turned)
    fit = locate(red_points(look(robots, gaze, own_frame=True)), SHAPE)
    if fit is not None:
        assert walls(fit.region) == pytest.approx(true_walls(*own, turned), abs=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_walls_are_found_in_a_crowd_with_noise(seed: int) -> None:
    rng = np.random.default_rng(seed)
    own = float(rng.uniform(1.0, 15.0)), float(rng.uniform(1.0, 20.0))
    others = [(float(x), float(y)) for x, y in rng.uniform((1.0, 1.0), (15.0, 20.0), (15, 2))]
    turned = bool(rng.integers(2))
    robots = crowd(own, others, turned)
    scans = [look(robots, robots[0, 2] + gaze, own_frame=True) for gaze in np.arange(4) * 1.57]
    points = np.concatenate([red_points(scan) for scan in scans])
    fit = locate(points + rng.normal(0.0, NOISE, points.shape), SHAPE)
    assert fit is not None
    # Each wall is hit by ten rays or more here, so it is off by a third of the noise; times 5.
    assert walls(fit.region) == pytest.approx(true_walls(*own, turned), abs=5 * NOISE / 3)


def test_a_far_wall_hit_by_a_few_rays_is_not_put_nearer() -> None:
    # Through the gaps of a crowd four rays hit the right wall; two of the upper wall's points fit
    # a wall 2 m nearer, if those beyond it are not looked at.
    upper = np.array([[x, 4.346] for x in np.linspace(-1.0, 12.913, 60)])
    lower = np.array([[x, -16.654] for x in np.linspace(2.0, 9.0, 33)])
    right = np.array([[14.913, y] for y in (-9.94, -9.57, -9.2, -5.91)])
    # In this order none of the four is among those that are tried as contacts of an edge.
    fit = locate(np.concatenate([lower, right, upper, upper[-1:]]), SHAPE)
    assert fit is not None
    assert fit.region.right == pytest.approx(14.913, abs=1e-9)


def test_the_last_point_of_one_wall_does_not_tell_where_the_next_one_is() -> None:
    # In a crowd a robot's first two looks, from one place, show one wall and nothing else.
    bearings = np.linspace(-math.pi / 2, math.pi / 2, 180)[1:-1]
    ranges = (8.2186 / np.cos(bearings)).astype(np.float32).astype(float)  # as on Player's wire
    wall = ranges[:, None] * np.stack([np.cos(bearings), np.sin(bearings)], axis=1)
    y = wall[:, 1]
    wall = wall[((y > -6.6) & (y < 6.4)) | ((y > 9.2) & (y < 9.8))]
    assert locate(np.concatenate([wall, wall]), SHAPE) is None
