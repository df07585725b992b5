"""Bodies of several parts: seen, touched, pushed and placed as the one thing that they are."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.build import load_data
from sim.silhouette import silhouette
from sim.stage.geometry import (
    convex_pieces,
    faces,
    hull_of,
    is_convex,
    pieces,
    reach,
    signed_area,
)
from sim.worldfile import WorldError
from tests.sim.moved_world import Moved

RIGHT = "[-0.3, -0.4], [0.5, -0.4], [0.5, -0.2], [0, -0.2]"
FORK = f"{{shape: polygon, points: [{RIGHT}, [0, 0.2], [0.5, 0.2], [0.5, 0.4], [-0.3, 0.4]]}}"
BODY = f"{{shape: compound, mass: 4, color: orange, parts: [{FORK}]}}"
WORLD = """\
size: [12, 8]
models:
  fork: {{body: {body}, sensors: [{{type: laser, samples: 31, range: 9}}]}}
  dot:
    body: {{shape: circle, radius: 0.1, mass: 1}}
    sensors: [{{type: laser, samples: 31, range: 9, fov: 90}}]
robots:
  - {{name: fork, model: fork, pose: [3, 4, 0]}}
  - {{name: dot, model: dot, pose: {dot}}}
{more}
"""


def moved(folder: Path, dot: str = "[9, 4, 180]", more: str = "") -> Moved:
    return Moved(folder, WORLD.format(body=BODY, dot=dot, more=more))


def body_of(parts: list[dict]) -> object:
    world = {
        "size": [9, 9],
        "models": {"m": {"body": {"shape": "compound", "parts": parts}}},
    }
    return load_data(world).world.models["m"].body


def test_a_concave_outline_is_cut_into_convex_pieces_of_its_area() -> None:
    corners = [[0, 0], [3, 0], [3, 2], [2, 2], [2, 1], [1, 1], [1, 2], [0, 2]]
    for ring in (corners, corners[::-1]):
        body = body_of([{"shape": "polygon", "points": ring}])
        found = pieces(body)
        assert len(found) > 1
        assert sum(signed_area(piece.vertices) for piece in found) == pytest.approx(5)
        assert len(faces(body)) == 1


@given(st.lists(st.floats(0.2, 5.0), min_size=4, max_size=12))
@settings(max_examples=50)
def test_pieces_of_a_star_are_convex_and_as_large_together_as_it_is(radii) -> None:
    step = 2 * math.pi / len(radii)
    star = np.array([(r * math.cos(k * step), r * math.sin(k * step)) for k, r in enumerate(radii)])
    found = convex_pieces(star)
    assert all(is_convex(piece) for piece in found)
    assert sum(map(signed_area, found)) == pytest.approx(signed_area(star), rel=1e-6)


def test_reach_and_hull_hold_all_parts() -> None:
    body = body_of(
        [
            {"shape": "box", "size": [1, 0.2], "pose": [1, 0, 90]},
            {"shape": "circle", "radius": 0.3, "pose": [-2, 1, 0]},
        ]
    )
    assert reach(body) == pytest.approx(math.hypot(2, 1) + 0.3)
    hull = hull_of(body)
    turn = np.linspace(0, 2 * math.pi, 200)
    rim = np.stack([-2 + 0.3 * np.cos(turn), 1 + 0.3 * np.sin(turn)], axis=1)
    for start, end in zip(hull, np.roll(hull, -1, axis=0), strict=True):
        across = (end - start)[0] * (rim - start)[:, 1] - (end - start)[1] * (rim - start)[:, 0]
        assert (across >= -1e-9).all()


def test_a_small_robot_fits_into_the_opening_of_a_fork_and_is_stopped_by_its_ground(
    tmp_path,
) -> None:
    world = moved(tmp_path, "[3.3, 4, 180]")  # it starts between the tines
    world.drive([[0, 0, 0], [0.3, 0, 0]], 3)
    assert world.poses[1, 0] - world.poses[0, 0] == pytest.approx(0.1, abs=0.02)
    assert world.scenery.stage.contact_counts.tolist() == [1, 1]


def test_a_laser_sees_the_tines_and_what_is_between_them(tmp_path) -> None:
    world = moved(tmp_path)
    world.drive([[0, 0, 0], [0, 0, 0]], 0.1)
    ranges = world.data(1, 0).ranges[0]
    assert ranges[15] == pytest.approx(6.0, abs=1e-6)  # the ground of the opening, at x = 3
    tine = round((math.atan2(0.3, 5.5) + math.pi / 4) / (math.pi / 2 / 30))
    assert ranges[tine] == pytest.approx(5.5 / math.cos(math.radians(-45 + 3 * tine)), abs=1e-6)


def test_a_fork_carries_a_puck_ahead_and_one_that_stands_stops_robots(tmp_path) -> None:
    puck = (
        "obstacles:\n  - {shape: circle, radius: 0.15, pose: [3.3, 4, 0], movable: true, mass: 1}"
    )
    world = moved(tmp_path, more=puck)
    world.drive([[0.4, 0, 0], [0, 0, 0]], 5)
    ((x, y, _),) = world.scenery.stage.movable_poses
    assert 0.14 < x - world.poses[0, 0] < 0.16
    assert y == pytest.approx(4, abs=0.1)
    gate = f"obstacles:\n  - {{shape: compound, pose: [6, 4, 0], parts: [{FORK}]}}"
    world = moved(tmp_path, "[8, 4, 180]", more=gate)
    world.drive([[0.4, 0, 0], [0.4, 0, 0]], 8)
    assert world.poses[0, 0] == pytest.approx(6 - 0.3 - 0.5, abs=0.02)
    assert world.poses[1, 0] == pytest.approx(6 + 0.1, abs=0.02)  # within the opening


def test_a_compound_obstacle_is_pushed_as_one(tmp_path) -> None:
    cross = (
        "obstacles:\n  - {shape: compound, pose: [4.5, 4, 45], movable: true, mass: 2,\n"
        "     friction: 0.1, parts: [{shape: box, size: [1, 0.1]}, {shape: box, size: [0.1, 1]}]}"
    )
    world = moved(tmp_path, more=cross)
    world.drive([[0.4, 0, 0], [0, 0, 0]], 6)
    assert world.scenery.stage.movable_poses[0, 0] > 5
    assert world.scenery.stage.contact_counts[0] >= 1


def test_robots_start_in_an_opening_but_not_in_a_part(tmp_path) -> None:
    moved(tmp_path, "[3.3, 4, 0]")
    with pytest.raises(WorldError, match="starts in robot fork"):
        moved(tmp_path, "[3.3, 4.3, 0]")
    world = moved(tmp_path)
    assert world.scenery.stage.set_poses({1: (3.3, 4, 0)}) == []
    assert world.scenery.stage.set_poses({1: (3.3, 4.3, 0)}) == [1]


@pytest.mark.parametrize(
    ("points", "told"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "cross"),
        ([[0, 0], [1, 0]], "at least 3 corners"),
        ([[0, 0], [1, 0], [2, 0]], "no area"),
        ([[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]], "cross or touch"),
    ],
)
def test_outlines_that_bound_nothing_are_told(points, told) -> None:
    with pytest.raises(WorldError, match=told):
        body_of([{"shape": "polygon", "points": points}])


def test_a_part_that_is_wrong_is_told_with_its_place() -> None:
    with pytest.raises(WorldError) as raised:
        body_of([{"shape": "box", "size": [1, 1]}, {"shape": "circle", "radius": -1}])
    assert "models.m.body.parts.1.radius" in str(raised.value)


def test_a_picture_shows_all_parts_as_one_outline() -> None:
    body = body_of(
        [
            {"shape": "box", "size": [1, 0.2]},
            {"shape": "box", "size": [0.2, 1]},
            {"shape": "circle", "radius": 0.3},
        ]
    )
    drawn = silhouette(body)
    x, y = np.meshgrid(*[np.arange(-0.5, 0.5, 0.002) + 0.001] * 2)
    union = (x**2 + y**2 < 0.09) | (abs(x) < 0.1) | (abs(y) < 0.1)
    assert signed_area(drawn) == pytest.approx(union.sum() * 0.002**2, rel=0.01)
    assert np.ptp(drawn, axis=0) == pytest.approx([1, 1], abs=0.005)
    apart = body_of(
        [{"shape": "circle", "radius": 0.2}, {"shape": "box", "size": [1, 1], "pose": [2, 0, 0]}]
    )
    assert (silhouette(apart) == hull_of(apart)).all()
