"""The world lies in the frame where and as large as it should."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.video.errors import VideoError
from sim.video.projection import (
    LARGEST,
    SHIFT,
    STRIP_HEIGHT,
    check_size,
    default_size,
    parse_size,
    project,
    to_fixed,
)

lengths = st.floats(0.1, 2000)
worlds = st.tuples(lengths, lengths)


def test_the_papers_world_gets_640_by_840() -> None:
    assert default_size((16, 21)) == (640, 840)


@given(worlds)
def test_default_sizes_are_even_and_at_most_840(world: tuple[float, float]) -> None:
    size = default_size(world)
    assert check_size(size) == size
    assert max(size) == 840


@given(worlds, st.integers(32, 1000), st.integers(32, 1000))
def test_every_corner_of_the_world_lies_above_the_status_line(
    world: tuple[float, float], half_width: int, half_height: int
) -> None:
    size = (2 * half_width, 2 * half_height)
    projection = project(world, [], size)
    corners = np.array([[0, 0], [world[0], world[1]]], dtype=float)
    (left, bottom), (right, top) = projection.edges(corners)
    assert 0 <= left < right <= size[0]
    assert 0 <= top < bottom <= size[1] - STRIP_HEIGHT


@given(worlds)
def test_a_metre_is_as_long_upwards_as_sideways(world: tuple[float, float]) -> None:
    projection = project(world, [], (640, 480))
    origin, ahead, up = projection.edges(np.array([[0.0, 0], [1, 0], [0, 1]]))
    # Differences of numbers up to 10^3: their last bits are 1e-13.
    assert ahead - origin == pytest.approx([projection.scale, 0], abs=1e-9)
    assert up - origin == pytest.approx([0, -projection.scale], abs=1e-9)


def test_walls_around_the_world_are_in_the_picture() -> None:
    wall = np.array([[-0.2, -0.2], [16.2, -0.2], [16.2, 0], [-0.2, 0]])
    projection = project((16, 21), [wall], (640, 840))
    pixels = projection.edges(wall)
    assert (pixels >= 0).all()
    assert (pixels <= [640, 840 - STRIP_HEIGHT]).all()


def test_a_solid_far_outside_does_not_shrink_the_world() -> None:
    far = np.array([[1000.0, 1000], [1001, 1000], [1001, 1001]])
    assert (
        project((10, 10), [far], (640, 640)).scale > 0.8 * project((10, 10), [], (640, 640)).scale
    )


def test_a_pixels_centre_is_a_whole_number_for_opencv() -> None:
    # Pixel 7 reaches from edge 7 to edge 8; OpenCV calls its centre 7.
    assert to_fixed(np.array([[7.5, 0.5]])).tolist() == [[7 << SHIFT, 0]]


@pytest.mark.parametrize("odd", [np.nan, np.inf, -np.inf, 1e300])
def test_points_that_are_no_places_do_not_overflow(odd: float) -> None:
    fixed = to_fixed(np.array([[odd, -odd]]))
    assert (np.abs(fixed) < 2**20).all()


def test_a_size_is_read_as_people_write_it() -> None:
    assert parse_size("640x840") == (640, 840)
    assert parse_size(" 1280 X 720 ") == (1280, 720)


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("640", "WIDTHxHEIGHT"),
        ("axb", "WIDTHxHEIGHT"),
        ("-640x480", "WIDTHxHEIGHT"),
        ("641x480", "642x480"),
        ("640x481", "even"),
        ("0x480", "64 to"),
        ("640x99999", str(LARGEST)),
    ],
)
def test_a_size_that_cannot_be_says_what_would_do(text: str, hint: str) -> None:
    with pytest.raises(VideoError, match=hint):
        parse_size(text)
