"""Plane geometry of bodies: hulls enclose, and pieces fill."""

from __future__ import annotations

import math

from hypothesis import assume, given
from hypothesis import strategies as st

from troupe.importers.stage.polygons import area, convex_pieces, cross, hull, is_convex

POINTS = st.tuples(st.integers(-20, 20), st.integers(-20, 20)).map(lambda p: (p[0] / 2, p[1] / 2))


def star(radii: list[float]) -> list[tuple[float, float]]:
    """A simple polygon around the origin, convex or not, by radii at equal angles."""
    step = 2 * math.pi / len(radii)
    return [(r * math.cos(k * step), r * math.sin(k * step)) for k, r in enumerate(radii)]


@given(st.lists(POINTS, min_size=3, max_size=20))
def test_a_hull_is_convex_and_holds_every_point(points) -> None:
    ring = hull(points)
    assume(len(ring) >= 3)
    sides = list(zip(ring, [*ring[1:], ring[0]], strict=True))
    assert all(cross(a, b, p) >= -1e-9 for a, b in sides for p in points)
    assert set(ring) <= set(points)


@given(st.lists(st.floats(0.2, 5.0), min_size=4, max_size=12))
def test_pieces_are_convex_and_as_large_together_as_the_polygon(radii) -> None:
    polygon = star(radii)
    pieces = convex_pieces(polygon)
    assert all(is_convex(piece) for piece in pieces)
    # 1e-6: pieces thinner than rounding are left out
    assert math.isclose(sum(map(area, pieces)), area(polygon), rel_tol=1e-6)


@given(st.lists(st.floats(0.2, 5.0), min_size=4, max_size=12))
def test_the_way_round_does_not_matter(radii) -> None:
    polygon = star(radii)
    one, other = (sum(map(area, convex_pieces(p))) for p in (polygon, polygon[::-1]))
    assert math.isclose(one, other, rel_tol=1e-6)


def test_a_convex_polygon_stays_in_one_piece() -> None:
    square = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]
    assert convex_pieces(square) == [[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]]


def test_a_line_has_no_pieces() -> None:
    assert convex_pieces([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]) == []


def test_edges_that_cross_give_the_hull() -> None:
    bow = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 3.0)]
    assert sum(map(area, convex_pieces(bow))) > 0.0
