"""What controllers share of perception, on scenes whose answer is plain."""

from __future__ import annotations

import itertools
import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from controllers.perception import (
    column_bearing,
    free_ahead,
    segments,
    sightings,
)
from player import Blob

BEARINGS = np.linspace(-math.pi / 2, math.pi / 2, 180)
GREEN, RED = 0x00FF00, 0xFF0000


def scan(*things: tuple[int, int, float], far: float = 20.0) -> np.ndarray:
    """Ranges with things at (first ray, last ray, range); nothing elsewhere."""
    ranges = np.full(180, far)
    for first, last, distance in things:
        ranges[first : last + 1] = distance
    return ranges


def points_of(ranges: np.ndarray) -> np.ndarray:
    return np.stack([ranges * np.cos(BEARINGS), ranges * np.sin(BEARINGS)], axis=1)


def test_the_image_runs_from_left_to_right() -> None:
    assert column_bearing(0, 160, math.pi) == math.pi / 2
    assert column_bearing(159, 160, math.pi) == -math.pi / 2
    assert abs(column_bearing(79.5, 160, math.pi)) < 1e-12


def test_a_sighting_has_its_blobs_bearings_and_only_one_colour() -> None:
    blobs = [
        Blob(0, GREEN, 0, 20, 60, 10, 30, 0, 0, 5.0),
        Blob(0, RED, 0, 100, 60, 90, 110, 0, 0, 9.0),
    ]
    (seen,) = sightings(blobs, GREEN, 160, math.pi)
    assert seen.left == column_bearing(10, 160, math.pi)
    assert seen.right == column_bearing(30, 160, math.pi)
    assert seen.right < seen.bearing < seen.left
    assert seen.range == 5.0


@given(
    st.lists(st.tuples(st.integers(0, 179), st.integers(0, 30), st.floats(0.5, 19.0)), max_size=6)
)
def test_segments_are_the_readings_that_hit_cut_where_the_range_jumps(
    things: list[tuple[int, int, float]],
) -> None:
    ranges = scan(*((first, min(179, first + more), at) for first, more, at in things))
    found = segments(points_of(ranges), ranges, 20.0)
    covered = [i for one in found for i in range(one.first, one.last + 1)]
    assert covered == [i for i in range(180) if ranges[i] < 20.0]
    for one in found:
        assert np.ptp(ranges[one.first : one.last + 1]) < 20.0
        assert np.abs(np.diff(ranges[one.first : one.last + 1])).max(initial=0.0) <= 0.5
    for one, other in itertools.pairwise(found):
        if one.last + 1 == other.first:
            assert abs(ranges[one.last] - ranges[other.first]) > 0.5


def test_two_robots_that_are_one_blob_are_two_segments() -> None:
    ranges = scan((60, 70, 4.0), (71, 78, 6.0))
    found = segments(points_of(ranges), ranges, 20.0)
    both = Blob(0, GREEN, 0, 0, 0, 160 - 70, 160 - 53, 0, 0, 5.0)
    (seen,) = sightings([both], GREEN, 160, math.pi)
    assert [(one.first, one.last) for one in found] == [(60, 70), (71, 78)]
    assert all(seen.right < BEARINGS[(one.first + one.last) // 2] < seen.left for one in found)
    x, y = found[0].centre
    assert abs(math.hypot(x, y) - 4.0) < 0.02  # the mean of an arc of 0.2 rad lies 0.7 % inside


def test_what_stands_beside_the_way_does_not_block_it() -> None:
    beside = points_of(scan((0, 20, 1.0)))  # right of the robot, more than 0.8 m aside
    assert np.abs(beside[:21, 1]).min() > 0.8
    assert free_ahead(scan((0, 20, 1.0)), BEARINGS, 0.8) == free_ahead(scan(), BEARINGS, 0.8)
    assert free_ahead(scan((85, 95, 3.0)), BEARINGS, 0.8) < 3.0 + 1e-9


def test_nothing_in_the_field_of_view_is_a_free_way() -> None:
    assert free_ahead(np.zeros(0), np.zeros(0), 0.5) == math.inf
