"""Polygons in world files are convex, and counter-clockwise after reading."""

from __future__ import annotations

from math import cos, pi, sin

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from pydantic_core import PydanticCustomError

from sim.worldfile.shapes import convex

Corners = list[tuple[float, float]]


def cross(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@st.composite
def on_a_circle(draw: st.DrawFn, least: int = 3) -> Corners:
    """Corners on a circle, counter-clockwise and not too near each other: convex by nature."""
    degrees = draw(st.lists(st.integers(0, 119), min_size=least, max_size=9, unique=True))
    radius = draw(st.floats(0.01, 1000))
    x, y = draw(st.tuples(st.floats(-100, 100), st.floats(-100, 100)))
    angles = [3 * degree * pi / 180 for degree in sorted(degrees)]
    return [(x + radius * cos(angle), y + radius * sin(angle)) for angle in angles]


@given(on_a_circle(), st.integers(0, 8), st.booleans())
def test_a_convex_polygon_is_taken_in_any_order_and_comes_out_counter_clockwise(
    corners: Corners, first: int, clockwise: bool
) -> None:
    written = corners[first % len(corners) :] + corners[: first % len(corners)]
    if clockwise:
        written.reverse()
    found = list(convex(written))
    assert sorted(found) == sorted(corners)
    n = len(found)
    assert all(cross(found[i], found[(i + 1) % n], found[(i + 2) % n]) > 0 for i in range(n))


@given(on_a_circle(least=4), st.data())
def test_corners_out_of_order_are_refused(corners: Corners, data: st.DataObject) -> None:
    shuffled = data.draw(st.permutations(corners))
    ring = shuffled[shuffled.index(corners[0]) :] + shuffled[: shuffled.index(corners[0])]
    assume(ring not in (corners, [corners[0], *reversed(corners[1:])]))
    with pytest.raises(PydanticCustomError):
        convex(shuffled)


@given(on_a_circle(least=4), st.integers(0, 8), st.floats(0.1, 0.9))
def test_a_corner_bent_inwards_is_refused(corners: Corners, which: int, depth: float) -> None:
    n = len(corners)
    i = which % n
    before, here, after = corners[i - 1], corners[i], corners[(i + 1) % n]
    opposite = corners[(i + n // 2) % n]
    assume(opposite not in (before, after))
    middle = ((before[0] + after[0]) / 2, (before[1] + after[1]) / 2)
    bent = tuple(m + depth * 0.5 * (o - m) for m, o in zip(middle, opposite, strict=True))
    assume(cross(before, bent, after) < -1e-6 * max(abs(here[0]), 1.0))  # type: ignore[arg-type]
    with pytest.raises(PydanticCustomError):
        convex([*corners[:i], bent, *corners[i + 1 :]])  # type: ignore[list-item]


def test_corners_on_a_straight_edge_are_allowed() -> None:
    assert len(convex([(0, 0), (1, 0), (2, 0), (2, 2), (0, 2)])) == 5


def test_a_star_whose_turns_all_go_left_is_refused() -> None:
    star = [(cos(4 * pi * k / 5), sin(4 * pi * k / 5)) for k in range(5)]
    with pytest.raises(PydanticCustomError, match="not convex"):
        convex(star)
