"""Plane geometry of bodies: hulls enclose."""

from __future__ import annotations

from hypothesis import assume, given
from hypothesis import strategies as st

from troupe.importers.stage.polygons import area, cleaned, cross, hull, is_convex

POINTS = st.tuples(st.integers(-20, 20), st.integers(-20, 20)).map(lambda p: (p[0] / 2, p[1] / 2))


@given(st.lists(POINTS, min_size=3, max_size=20))
def test_a_hull_is_convex_and_holds_every_point(points) -> None:
    ring = hull(points)
    assume(len(ring) >= 3)
    sides = list(zip(ring, [*ring[1:], ring[0]], strict=True))
    assert all(cross(a, b, p) >= -1e-9 for a, b in sides for p in points)
    assert set(ring) <= set(points)


def test_corners_on_a_line_and_corners_that_repeat_are_cleaned_away() -> None:
    square = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (0.0, 2.0)]
    tidy = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]
    assert cleaned(square) == tidy
    assert set(cleaned(square[::-1])) == set(tidy)
    assert area(cleaned(square[::-1])) == 4.0
    assert is_convex(tidy)
