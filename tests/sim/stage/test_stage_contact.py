"""Bodies that meet: nothing passes through anything, and overlaps stay below two centimetres."""

from __future__ import annotations

import hashlib
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stage_worlds import corners, deepest, overlap, robot, set_up, world

from sim.stage.layout import build_layout
from sim.stage.stage import Stage

DEEPEST = 0.02
"""m; the bound that the design of Troupe promises for two robots that touch."""
SHAPES = ("box", "circle", "polygon")


def run(stage: Stage, bodies: list[Any], ticks: int) -> float:
    """Let time go by; the deepest overlap at the end of any tick."""
    worst = 0.0
    for _ in range(ticks):
        stage.tick()
        worst = max(worst, deepest(stage, bodies))
    return worst


def test_the_tests_own_geometry_measures_overlaps() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    assert overlap(square, np.add(square, [0.99, 0.3])) == pytest.approx(0.01)
    assert overlap(square, np.add(square, [1.01, 0.3])) == 0.0
    diamond = np.array([[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]])
    assert overlap(square, np.add(diamond, [1.9, 0.5])) == pytest.approx(0.1)


@settings(max_examples=12)
@given(
    shapes=st.tuples(st.sampled_from(SHAPES), st.sampled_from(SHAPES)),
    speed=st.floats(0.1, 3.0),
    aside=st.floats(-0.3, 0.3),
    yaws=st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)),
    turns=st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
)
def test_robots_head_on_do_not_pass_through_each_other(
    shapes: tuple[str, str],
    speed: float,
    aside: float,
    yaws: tuple[float, float],
    turns: tuple[float, float],
) -> None:
    drive = {"max_speed": 3.0, "max_turn_rate": 200.0, "max_acceleration": 10.0}
    models = {f"m{k}": robot(shape, drive) for k, shape in enumerate(shapes)}
    _, stage = set_up(models=models)
    stage.add_robot("m0", (4.0, 5.0, yaws[0]))
    stage.add_robot("m1", (6.0, 5.0 + aside, math.pi + yaws[1]))
    stage.command([0, 1], [[speed, 0.0, turns[0]], [speed, 0.0, turns[1]]])
    bodies = [stage.models[f"m{k}"].body for k in range(2)]
    assert run(stage, bodies, 25) <= DEEPEST


def test_two_equal_robots_head_on_stop_and_stall() -> None:
    _, stage = set_up(models={"a": robot()})
    stage.add_robot("a", (4, 5, 0))
    stage.add_robot("a", (6, 5, math.pi))
    stage.command([0, 1], [[0.5, 0.0, 0.0]] * 2)
    worst = run(stage, [stage.models["a"].body] * 2, 60)
    assert worst <= DEEPEST
    assert stage.stalls.all()
    assert stage.contact_counts.tolist() == [1, 1]
    assert stage.poses[:, 0] == pytest.approx([4.75, 5.25], abs=0.02)
    assert np.abs(stage.velocities).max() < 0.01


def test_a_pushed_box_moves_and_comes_to_rest_and_stops_at_the_wall() -> None:
    obstacle = {"shape": "box", "size": (1, 1), "pose": (5, 5, 0), "movable": True, "mass": 5.0}
    layout, stage = set_up(models={"a": robot()}, obstacles=[obstacle])
    stage.add_robot("a", (3, 5, 0))
    bodies = [stage.models["a"].body, layout.movables[0].body]
    stage.command([0], [[0.5, 0.0, 0.0]])
    worst = run(stage, bodies, 60)
    moved = stage.movable_poses[0, 0]
    assert moved > 5.5
    assert not stage.stalls[0]  # 100 N against 0.5 x 5 kg x g = 25 N of friction
    stage.command([0], [[-0.5, 0.0, 0.0]])
    run(stage, bodies, 10)
    rested = stage.movable_poses[0].copy()
    run(stage, bodies, 10)
    assert np.array_equal(stage.movable_poses[0], rested)
    stage.command([0], [[0.5, 0.0, 0.0]])
    worst = max(worst, run(stage, bodies, 120))
    assert worst <= DEEPEST
    assert stage.movable_poses[0, 0] == pytest.approx(9.5, abs=DEEPEST)
    assert stage.stalls[0]


def test_a_heavy_box_is_not_moved() -> None:
    obstacle = {"shape": "circle", "radius": 0.5, "pose": (5, 5, 0), "movable": True, "mass": 50.0}
    _, stage = set_up(models={"a": robot()}, obstacles=[obstacle])
    stage.add_robot("a", (4, 5, 0))
    stage.command([0], [[0.5, 0.0, 0.0]])
    for _ in range(60):
        stage.tick()
    # 100 N against 0.5 x 50 kg x g = 245 N of friction
    assert stage.movable_poses[0] == pytest.approx([5, 5, 0], abs=0.01)
    assert stage.stalls[0]


@pytest.mark.parametrize("speed", [0.5, 3.0])
@pytest.mark.parametrize(("heavy", "light"), [(100.0, 10.0), (1000.0, 10.0), (10.0, 0.01)])
@pytest.mark.parametrize(("shape", "yaw"), [("box", 0.0), ("circle", 0.0), ("polygon", 0.4)])
def test_a_light_robot_between_a_heavy_one_and_a_wall_is_not_squashed(
    heavy: float, light: float, shape: str, yaw: float, speed: float
) -> None:
    """Each with the force for 100 m/s2; two light ones, the outer on the wall."""
    models = {
        name: robot(
            shape if name == "light" else "box",
            {"max_force": 100.0 * mass, "max_torque": 20.0 * mass, "max_speed": speed},
            mass=mass,
        )
        for name, mass in (("heavy", heavy), ("light", light))
    }
    _, stage = set_up(models=models)
    for x in (9.7, 9.1):
        stage.add_robot("light", (x, 5.0, yaw))
    stage.add_robot("heavy", (8.2, 5.0, 0.0))
    stage.command([2], [[speed, 0.0, 0.0]])
    bodies = [stage.models[name].body for name in ("light", "light", "heavy")]
    assert run(stage, bodies, 30) <= DEEPEST
    # What is pinched between slanted faces may slip out faster than it is pressed.
    assert np.hypot(*stage.velocities[:, :2].T).max() <= 3.0 * speed


def test_a_crowd_of_very_unequal_masses_does_not_overlap() -> None:
    rng = np.random.default_rng(6)
    masses = [10.0, 10_000.0, *(10.0 * 1000.0 ** rng.uniform(0, 1, 2))]
    models = {
        f"m{k}": robot(
            SHAPES[int(rng.integers(3))],
            {"max_force": 100.0 * mass, "max_torque": 30.0 * mass, "max_speed": 2.0},
            mass=mass,
        )
        for k, mass in enumerate(masses)
    }
    _, stage = set_up(size=(4.0, 4.0), models=models)
    for k in range(9):
        place = (np.array([k % 3, k // 3]) + 0.5) * 4.0 / 3.0
        stage.add_robot(f"m{k % 4}", (*place, rng.uniform(-3, 3)))
    bodies = [stage.models[f"m{k % 4}"].body for k in range(9)]
    for _ in range(4):
        stage.command(np.arange(9), rng.uniform([-2, -2, -3], [2, 2, 3], (9, 3)))
        assert run(stage, bodies, 10) <= DEEPEST


@pytest.mark.parametrize("kind", ["differential", "omnidirectional"])
def test_ten_robots_cannot_push_another_through_a_wall(kind: str) -> None:
    drive = {"kind": kind, "max_force": 400.0, "max_speed": 1.0}
    _, stage = set_up(models={"a": robot(drive=drive)})
    stage.add_robot("a", (9.6, 5, 0.3))
    for k in range(10):
        angle = math.pi / 2 + math.pi * (k + 0.5) / 10
        place = np.array([9.6, 5.0]) + 2.0 * np.array([math.cos(angle), math.sin(angle)])
        stage.add_robot("a", (*place, angle - math.pi))
    stage.command(np.arange(1, 11), [[1.0, 0.0, 0.0]] * 10)
    assert run(stage, [stage.models["a"].body] * 11, 80) <= DEEPEST
    assert stage.contact_counts[0] > 0
    assert corners(stage.models["a"].body, stage.poses[0])[:, 0].max() <= 10.0 + DEEPEST


@pytest.mark.parametrize(
    ("drive", "mass", "count", "size"),
    [
        ({"max_speed": 0.5}, 10.0, 200, 14.0),
        ({"max_speed": 2.0, "max_turn_rate": 360.0, "max_force": 1000.0}, 10.0, 60, 9.0),
        ({"max_speed": 1.0, "kind": "omnidirectional"}, 1.0, 60, 8.0),
    ],
)
def test_robots_that_drive_blindly_never_leave_a_closed_arena(
    drive: dict[str, Any], mass: float, count: int, size: float
) -> None:
    models = {shape: robot(shape, drive, mass=mass * (k + 1)) for k, shape in enumerate(SHAPES)}
    _, stage = set_up(size=(size, size), models=models)
    rng = np.random.default_rng(3)
    side = math.ceil(math.sqrt(count))
    bodies = []
    for k in range(count):
        place = (np.array([k % side, k // side]) + 0.5) * size / side
        stage.add_robot(SHAPES[k % 3], (*place, rng.uniform(-3, 3)))
        bodies.append(stage.models[SHAPES[k % 3]].body)
    fast = drive["max_speed"]
    for tick in range(60):
        if tick % 10 == 0:
            low, high = [-fast, -fast, -2.0], [1.5 * fast, fast, 2.0]
            stage.command(np.arange(count), rng.uniform(low, high, (count, 3)))
        stage.tick()
        for body, pose in zip(bodies, stage.poses, strict=True):
            points = corners(body, pose)
            assert points.min() > -DEEPEST
            assert points.max() < size + DEEPEST
        if tick % 6 == 5:
            assert deepest(stage, bodies) <= DEEPEST
    assert stage.contact_counts.sum() > count / 4  # they did meet


def test_a_fast_robot_does_not_tunnel_through_a_thin_wall() -> None:
    obstacle = {"shape": "box", "size": (0.02, 8), "pose": (6, 5, 0)}
    drive = {"max_speed": 20.0, "max_acceleration": 200.0, "max_force": 5000.0}
    _, stage = set_up(models={"a": robot(drive=drive)}, obstacles=[obstacle])
    stage.add_robot("a", (2, 5, 0))
    stage.command([0], [[20.0, 0.0, 0.0]])
    worst = run(stage, [stage.models["a"].body], 10)
    assert worst <= DEEPEST
    assert stage.poses[0, 0] < 6.0


@settings(max_examples=30, deadline=None)
@given(
    step=st.floats(0.01, 2.0),
    speed=st.floats(0.5, 10.0),
    radius=st.floats(0.005, 0.3),
    thickness=st.floats(0.001, 0.2),
    yaw=st.floats(-1.0, 1.0),
)
def test_nothing_passes_a_wall_at_any_clock(
    step: float, speed: float, radius: float, thickness: float, yaw: float
) -> None:
    """One is driven at the wall, and pushes another before it, which slides on the floor."""
    wall = {"shape": "box", "size": (thickness, 300.0), "pose": (5.0, 5.0, 0)}
    ball = {"shape": "circle", "radius": radius, "pose": (3.5, 5.5, 0), "movable": True}
    drive = {"max_speed": speed, "max_acceleration": 50.0, "max_force": 1000.0}
    _, stage = set_up(
        size=(200.0, 200.0),
        boundary=None,
        clock={"interval": step, "physics_step": step},
        obstacles=[wall, ball],
        models={"a": robot("circle", drive, radius=radius)},
    )
    stage.add_robot("a", (2.0, 5.0, yaw))
    stage.add_robot("a", (2.0, 5.5, 0.0))
    stage.command([0, 1], [[speed, 0.0, 0.0]] * 2)
    for _ in range(min(100, math.ceil(12.0 / speed / step) + 3)):
        stage.tick()
    assert stage.poses[:, 0].max() < 5.0
    assert stage.movable_poses[:, 0].max() < 5.0


@pytest.mark.parametrize(
    ("yaw", "force", "moves"),
    [(0.0, 60.0, False), (1.57, 60.0, False), (0.0, 150.0, True), (1.57, 150.0, True)],
)
def test_a_standing_robot_gives_way_only_to_more_than_its_own_force(
    yaw: float, force: float, moves: bool
) -> None:
    """Its wheels hold 100 N, along and across; it is hit at 0.5 m/s, which shoves it a little."""
    models = {"stands": robot(), "pushes": robot(drive={"max_force": force})}
    _, stage = set_up(models=models)
    stage.add_robot("stands", (5, 5, yaw))
    stage.add_robot("pushes", (4, 5, 0))
    stage.command([1], [[0.5, 0.0, 0.0]])
    for _ in range(60):
        stage.tick()
    assert (stage.poses[0, 0] > 5.1) == moves
    assert stage.stalls.tolist() == [False, not moves]  # the first wants nothing


def test_a_wall_at_an_angle_lets_a_robot_slide_along() -> None:
    _, stage = set_up(models={"a": robot("circle", friction=0.0)})
    stage.add_robot("a", (5, 9.5, math.radians(30)))
    stage.command([0], [[0.5, 0.0, 0.0]])
    for _ in range(30):
        stage.tick()
    assert stage.poses[0, 0] > 5.5
    assert stage.poses[0, 1] < 9.75 + DEEPEST


@pytest.mark.parametrize("against", ["boundary", "map", "obstacle", "robot"])
@pytest.mark.parametrize(
    ("own", "other", "slides"), [(2.0, 0.3, True), (2.0, 0.6, False), (4.0, 0.3, False)]
)
def test_the_friction_of_two_bodies_is_the_product_of_their_coefficients(
    tmp_path: Any, against: str, own: float, other: float, slides: bool
) -> None:
    """At 45 degrees a robot presses as hard as it drags: it slides if the product is below 1."""
    (tmp_path / "room.txt").write_text("\n".join(["#" * 10, *["#........#"] * 8, "#" * 10]))
    models = {
        "a": robot(drive={"kind": "omnidirectional", "max_torque": 1000.0}, friction=own),
        "b": robot(drive={"max_force": 1e4, "max_torque": 1e4}, size=(8.0, 1.0), friction=other),
    }
    top = {"boundary": 10.0, "map": 9.0, "obstacle": 8.0, "robot": 8.0}[against]
    box = {"shape": "box", "size": (8.0, 1.0), "pose": (5.0, 8.5, 0), "friction": other}
    made = world(
        boundary={"friction": other if against == "boundary" else 7.0},
        map={"file": "room.txt", "cell": 1.0, "friction": other} if against == "map" else None,
        obstacles=[box] if against == "obstacle" else [],
        models=models,
    )
    stage = Stage(build_layout(made, tmp_path), made.models, made.clock)
    stage.add_robot("a", (2.0, top - 0.2, 0.0))
    if against == "robot":
        stage.add_robot("b", (5.0, 8.5, 0.0))
        stage.settle(1)
    stage.command([0], [[0.3, 0.3, 0.0]])
    for _ in range(40):
        stage.tick()
    assert (stage.poses[0, 0] > 2.2) == slides


def test_robots_that_overlap_when_they_come_are_parted() -> None:
    _, stage = set_up(models={"a": robot()})
    stage.add_robot("a", (5, 5, 0))
    stage.add_robot("a", (5.3, 5.1, 0.2))
    for _ in range(30):
        stage.tick()
    assert deepest(stage, [stage.models["a"].body] * 2) <= DEEPEST


def test_nobody_gets_through_the_walls_of_an_image(tmp_path: Any) -> None:
    pixels = np.full((60, 60), 255, dtype=np.uint8)
    pixels[20, :40] = pixels[40, 20:] = 0  # walls of one pixel: 5 cm
    for k in range(20):
        pixels[20 + k, 45] = pixels[k, 10 + k // 2] = 0
    cv2.imwrite(str(tmp_path / "cave.png"), pixels)
    drive = {"max_speed": 2.0, "max_acceleration": 10.0, "max_force": 500.0}
    made = world(
        size=(3.0, 3.0),
        map={"file": "cave.png", "resolution": 0.05},
        models={"a": robot("circle", drive, radius=0.1), "b": robot(drive=drive, size=(0.2, 0.15))},
    )
    layout = build_layout(made, tmp_path)
    stage = Stage(layout, made.models, made.clock)
    rng = np.random.default_rng(2)
    places = [(0.3, 2.7), (1.2, 2.7), (0.4, 1.5), (1.5, 1.3), (2.7, 1.5), (0.5, 0.4), (2.2, 0.3)]
    for number, place in enumerate(places):
        stage.add_robot("ab"[number % 2], (*place, rng.uniform(-3, 3)))
    bodies = [made.models["ab"[number % 2]].body for number in range(len(places))]
    for tick in range(100):
        if tick % 10 == 0:
            twists = rng.uniform([0.5, 0.0, -1.5], [2.0, 0.0, 1.5], (len(places), 3))
            stage.command(np.arange(len(places)), twists)
        stage.tick()
        assert deepest(stage, bodies) <= DEEPEST
        # Half of a body is deeper than 2 cm: a centre in a wall would have gone through.
        assert layout.inside(stage.poses[:, :2]).all()
    assert (stage.contact_counts > 0).all()


def way() -> str:
    """The digest of a stage on which shapes of all kinds meet, one settles, and one comes late."""
    _, stage = set_up(size=(6.0, 6.0), models={shape: robot(shape) for shape in SHAPES})
    rng = np.random.default_rng(5)
    for k in range(25):
        place = (k % 5 + 0.7, k // 5 + 0.7)
        stage.add_robot(SHAPES[k % 3], (*place, rng.uniform(-3, 3)))
    digest = hashlib.sha256()
    for tick in range(40):
        if tick % 8 == 0:
            stage.command(np.arange(25), rng.uniform(-0.5, 0.5, (25, 3)))
        if tick == 20:
            stage.settle(7)
            stage.add_robot("box", (5.7, 5.7, 0.5))
        stage.tick()
        robots, points = stage.contact_points
        for array in (stage.poses, stage.velocities, stage.contact_counts, robots, points):
            digest.update(array.tobytes())
    return digest.hexdigest()


def test_a_stage_repeats_bit_by_bit_in_this_process_and_in_another() -> None:
    here = Path(__file__)
    code = f"import sys; sys.path[:0] = [{str(here.parent)!r}, {str(here.parents[3])!r}]\n"
    code += f"from {here.stem} import way; print(way())"
    environment = {**os.environ, "PYTHONHASHSEED": "17"}
    other = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert way() == way() == other.stdout.strip()
