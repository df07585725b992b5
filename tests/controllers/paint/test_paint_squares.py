"""Bounds of seen robots hold their centres, however they are turned."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.paint.sight.scan import see_robots
from controllers.paint.sight.squares import Square, fit_square, may_be_one
from controllers.paint.sight.tracks import LAG
from troupe.testing.paint.scene import REGION, look

robots = st.tuples(st.floats(1.0, 15.0), st.floats(1.0, 20.0), st.floats(-math.pi, math.pi))


def sights(poses: np.ndarray, yaw: float) -> list[Square]:
    """What a robot at the first pose's place, heading `yaw`, sees of the others."""
    scan = look(poses, yaw)
    return see_robots(scan, REGION.depth(scan.points))


def apart(poses: np.ndarray) -> bool:
    gaps = np.hypot(*(poses[:, None, :2] - poses[None, :, :2]).transpose(2, 0, 1))
    return bool((gaps + 10.0 * np.eye(len(poses))).min() > 1.45)


def beyond(square: Square, pose: np.ndarray) -> float:
    """How far a centre is out of a square's bounds, m."""
    (x0, x1), (y0, y1) = square.x, square.y
    return max(x0 - pose[0], pose[0] - x1, y0 - pose[1], pose[1] - y1)


@settings(max_examples=300)
@given(st.lists(robots, min_size=2, max_size=5), st.floats(-math.pi, math.pi))
def test_certain_sightings_hold_the_centre_within_what_pairing_allows(
    places: list[tuple[float, float, float]], yaw: float
) -> None:
    poses = np.array(places)
    if not apart(poses):
        return
    for square in sights(poses, yaw):
        if square.certain:
            assert min(beyond(square, pose) for pose in poses[1:]) <= LAG


@settings(max_examples=300)
@given(
    st.tuples(st.floats(2.0, 14.0), st.floats(2.0, 19.0)),
    st.floats(1.6, 12.0), st.floats(-0.4, 0.4), st.booleans(), st.floats(-0.009, 0.009),
)  # fmt: skip
def test_a_standing_robot_that_is_nearly_level_is_bounded_exactly(
    eye: tuple[float, float], distance: float, rise: float, leftwards: bool, yaw: float
) -> None:
    x = eye[0] + (-distance if leftwards else distance)
    if not 0.6 < x < 15.4:
        return
    poses = np.array([[*eye, 0.0], [x, eye[1] + rise, 0.0]])
    (square,) = sights(poses, yaw + (math.pi if leftwards else 0.0))
    assert beyond(square, poses[1]) < 1e-6  # rounding: the rays are exact
    assert square.x[1] - square.x[0] < 1e-6  # the upright face gives x
    # The rays beside it bound its height by their spacing, 1 degree, at its far side.
    assert square.y[1] - square.y[0] <= math.radians(1.0) * (distance + 1.0)


@settings(max_examples=200)
@given(
    st.integers(2, 10), st.integers(0, 5), st.floats(1.31, 1.75),
    st.floats(3.0, 14.0), st.floats(1.0, 20.0), st.sampled_from([0.0, math.pi]),
)  # fmt: skip
def test_a_column_of_robots_seen_at_a_slant_is_not_cut_at_the_wrong_places(
    count: int, first: int, spacing: float, x: float, y: float, yaw: float
) -> None:
    # Rays may miss the gaps between robots that stand above each other by a wall, left or right.
    heights = [h for k in range(count) if (h := 0.6 + (first + k) * spacing) < 20.4]
    own, wall = (x, 0.6) if yaw else (16.0 - x, 15.4)
    poses = np.array([[own, y, 0.0], *[[wall, h, 0.0] for h in heights]])
    for square in sights(poses, yaw):
        if square.certain:
            assert min(beyond(square, pose) for pose in poses[1:]) <= LAG


def test_a_corner_of_a_leaning_robot_is_not_taken_for_one_above() -> None:
    # Two points at the view's edge, on the upper face of a robot that leans by 6 degrees.
    points = np.array([[3.3715, 0.0028], [3.6569, 0.0317]])
    square = fit_square(points, (2.041, 0.0), (None, None))
    assert square is not None
    assert not square.certain
    assert beyond(square, np.array([3.533, -0.483])) <= 0.05  # the step of the tilts tried, 2 deg


def test_two_points_and_a_corner_of_a_turning_robot_are_not_an_upright_one() -> None:
    # Three points at the view's edge; a robot that stands upright half a body lower fits as well.
    points = np.array([[2.9856, -0.3914], [2.9853, -0.2142], [3.0234, -0.0373]])
    square = fit_square(points, (-7.0996, 0.0), (None, None))
    assert square is not None
    assert not square.straight
    assert beyond(square, np.array([3.543, 0.0])) <= 0.05  # the step of the tilts tried, 2 deg


def test_sightings_whose_bounds_meet_may_be_one_robot() -> None:
    whole = Square((3.0, 3.0), (2.0, 2.1), True, True, 0.0)
    piece = Square((2.9, 3.6), (1.5, 2.0), False, False, 0.0)
    beside = Square((4.05, 4.05), (2.0, 2.1), True, True, 0.0)
    assert may_be_one(whole, piece)
    assert not may_be_one(whole, beside)
