"""Layouts: boundary outside, regions, obstacles, doors, and what is free."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stage_worlds import clipped, overlap, robot, world

from sim.stage.geometry import circle_polygon, is_convex, separation, signed_area, wrapped
from sim.stage.layout import Layout, build_layout
from sim.worldfile.mistakes import WorldError


def build(**keys: Any) -> Layout:
    return build_layout(world(**keys), Path())


@st.composite
def convex_polygons(draw: st.DrawFn) -> tuple[tuple[float, float], ...]:
    """Corners on a circle of 3 m about (5, 5), counter-clockwise, no two near each other."""
    count = draw(st.integers(3, 8))
    shares = np.array(draw(st.lists(st.floats(1.0, 3.0), min_size=count, max_size=count)))
    turns = np.cumsum(shares) / shares.sum() * math.tau + draw(st.floats(0, 6))
    return tuple((5 + 3 * math.cos(t), 5 + 3 * math.sin(t)) for t in turns)


def test_the_boundary_stands_outside_and_has_no_gap() -> None:
    layout = build(size=(16.0, 21.0), boundary={"thickness": 0.3})
    room = np.array([[0, 0], [16, 0], [16, 21], [0, 21]], dtype=float)
    assert len(layout.solids) == 4
    area = 0.0
    for solid in layout.solids:
        assert overlap(solid.vertices, room) < 1e-12
        assert is_convex(solid.vertices)
        assert signed_area(solid.vertices) > 0
        area += signed_area(solid.vertices)
    # They fill the whole frame: no gap at the corners, and no piece twice.
    assert area == pytest.approx(16.6 * 21.6 - 16 * 21)
    assert [look.color for look in layout.looks] == [0xFF0000]
    assert len(layout.segments) == 4


@settings(max_examples=50)
@given(region=convex_polygons())
def test_walls_along_a_region_stand_outside_of_it_and_close_it(region: Any) -> None:
    layout = build(region=region, boundary={"shape": "region", "thickness": 0.2})
    inner = np.array(region)
    assert len(layout.solids) == len(region)
    walls = [solid.vertices for solid in layout.solids]
    for wall in walls:
        assert is_convex(wall)
        assert overlap(wall, inner) < 1e-9
    # Just outside of each edge and each corner there is wall.
    outwards = inner - [5, 5]
    outwards /= np.hypot(*outwards.T)[:, None]
    for corner, out in zip(inner, outwards, strict=True):
        spot = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.01 + corner + 0.05 * out
        shared = sum(max(0.0, signed_area(c)) for w in walls if len(c := clipped(spot, w)) > 2)
        assert shared == pytest.approx(4e-4, rel=1e-6)


@settings(max_examples=50)
@given(region=convex_polygons(), seed=st.integers(0, 100))
def test_inside_is_in_the_region_and_in_no_obstacle(region: Any, seed: int) -> None:
    obstacles = [
        {"shape": "box", "size": (1, 2), "pose": (5, 5, 30)},
        {"shape": "circle", "radius": 0.5, "pose": (3.5, 6, 0), "movable": True},
    ]
    layout = build(region=region, obstacles=obstacles)
    points = np.random.default_rng(seed).uniform(0, 10, (200, 2))
    truth = []
    for x, y in points:
        edges = zip(region, (*region[1:], region[0]), strict=True)
        within = all((c - a) * (y - b) - (d - b) * (x - a) >= 0 for (a, b), (c, d) in edges)
        z = complex(x - 5, y - 5) * np.exp(-1j * math.radians(30))
        in_box = abs(z.real) < 0.5 and abs(z.imag) < 1
        in_circle = math.hypot(x - 3.5, y - 6) < 0.5
        truth.append(within and not in_box and not in_circle)
    found = layout.inside(points)
    # A circle is a polygon of its area: it differs by 0.2 % of its radius (1 mm) at most.
    sure = np.abs(np.hypot(points[:, 0] - 3.5, points[:, 1] - 6) - 0.5) > 0.002
    assert np.array_equal(found[sure], np.array(truth)[sure])


def test_what_stands_is_solid_and_what_moves_is_not() -> None:
    layout = build(
        boundary=None,
        obstacles=[
            {"shape": "box", "size": (2, 1), "pose": (3, 4, 90), "color": "#112233", "height": 0.4},
            {"shape": "circle", "radius": 1, "pose": (7, 7, 0), "movable": True, "mass": 3.0},
        ],
    )
    (solid,) = layout.solids
    assert np.ptp(solid.vertices, axis=0) == pytest.approx([1, 2])
    assert (solid.look.color, solid.look.height) == (0x112233, 0.4)
    assert [layout.looks[n].color for n in layout.segment_looks] == [0x112233] * 4
    (movable,) = layout.movables
    assert (movable.pose, movable.mass) == ((7.0, 7.0, 0.0), 3.0)
    assert len(layout.segments) == 4  # sensors see the movable one as a body of its own


def test_a_circle_s_polygon_has_its_area() -> None:
    polygon = circle_polygon(2.0)
    assert signed_area(polygon) == pytest.approx(math.pi * 4.0)
    # One minus the cosine of half a side's angle, to either side of the circle.
    assert np.abs(np.hypot(*polygon.T) - 2.0).max() < 2.0 * 0.0022


def maze(tmp_path: Path, text: str, **keys: Any) -> Layout:
    (tmp_path / "maze.txt").write_text(text)
    made = world(
        **{"size": None, **keys},
        map={"file": "maze.txt", "cell": 1.5, "color": "#00ff00"},
        models={"a": robot()},
    )
    return build_layout(made, tmp_path)


def test_the_size_of_a_world_follows_from_its_text_map(tmp_path: Path) -> None:
    layout = maze(tmp_path, "####\n#..#\n####\n")
    assert layout.size == (6.0, 4.5)
    assert layout.cell == 1.5
    assert layout.grid is not None
    assert layout.grid.tolist()[1] == [True, False, False, True]
    with pytest.raises(WorldError, match="does not fit the map"):
        maze(tmp_path, "####\n#..#\n####\n", size=(6.0, 9.0))


DOOR = {"name": "s", "at": "S", "model": "a", "heading": 90, "period": 4.0}


def test_a_door_stands_where_the_map_has_its_letter(tmp_path: Path) -> None:
    layout = maze(tmp_path, "####\n#.S#\n#..#\n####\n", doors=[DOOR])
    (door,) = layout.doors
    assert door.centre == pytest.approx((3.75, 3.75))
    assert door.size == (1.5, 1.5)
    assert door.heading == pytest.approx(math.pi / 2)
    assert layout.inside([door.centre])[0]


def test_doors_take_the_letters_in_reading_order(tmp_path: Path) -> None:
    doors = [{**DOOR, "name": "s"}, {**DOOR, "name": "t"}]
    first, second = maze(tmp_path, "####\n#.S#\n#S.#\n####\n", doors=doors).doors
    assert first.centre[1] > second.centre[1]
    with pytest.raises(WorldError, match="an S of its own") as caught:
        maze(tmp_path, "####\n#.S#\n#..#\n####\n", doors=doors)
    assert caught.value.mistakes[0].where == ("doors", 0, "at")


def test_a_door_at_a_point_takes_the_map_s_cell_or_the_body_s_room(tmp_path: Path) -> None:
    at_point = {**DOOR, "at": (2.0, 2.0), "heading": 90}
    (in_map,) = maze(tmp_path, "####\n#..#\n####\n", doors=[at_point]).doors
    assert in_map.centre == pytest.approx((2.25, 2.25))
    (free,) = build(doors=[at_point], models={"a": robot()}).doors
    assert free.centre == (2.0, 2.0)
    assert free.size == pytest.approx((0.4, 0.5))  # the robot's 0.5 x 0.4, turned by 90 degrees
    with pytest.raises(WorldError, match="in a wall"):
        maze(tmp_path, "####\n#..#\n####\n", doors=[{**at_point, "at": (0.1, 0.1)}])


@settings(max_examples=50)
@given(one=convex_polygons(), two=convex_polygons(), dx=st.floats(-7, 7), dy=st.floats(-7, 7))
def test_separation_is_the_distance_or_minus_the_depth(
    one: Any, two: Any, dx: float, dy: float
) -> None:
    a, b = np.array(one), np.add(two, [dx, dy])
    gap = separation(a, b)
    shared = clipped(a, b)
    if gap > 1e-9:
        assert len(shared) < 3
        # Sampled along both outlines the nearest points are no nearer, and hardly farther.
        t = np.linspace(0, 1, 60)[:, None, None]
        lines = [(p + t * (np.roll(p, -1, axis=0) - p)).reshape(-1, 2) for p in (a, b)]
        least = np.hypot(*(lines[0][:, None] - lines[1][None]).transpose(2, 0, 1)).min()
        assert gap - 1e-9 <= least <= gap + 0.1  # samples lie at most 0.1 m apart
    elif gap < -1e-9:
        assert len(shared) >= 3


@given(angle=st.floats(-1e3, 1e3))
def test_wrapped_angles_are_the_same_angle(angle: float) -> None:
    turned = float(wrapped(angle))
    assert -math.pi < turned <= math.pi
    assert math.remainder(turned - angle, math.tau) == pytest.approx(0.0, abs=1e-9)
