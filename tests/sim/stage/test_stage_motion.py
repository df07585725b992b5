"""Robots in the open do what they are told, within their limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from stage_worlds import robot, set_up

from sim.stage.drive import ARRIVED
from sim.stage.stage import Stage

OPEN = {"size": (100.0, 100.0)}


def one(model: dict[str, Any], pose: Any = (50, 50, 0)) -> Stage:
    """A stage of 100 x 100 m with one robot."""
    _, stage = set_up(**OPEN, models={"a": model})
    stage.add_robot("a", pose)
    return stage


def go(stage: Stage, ticks: int) -> None:
    for _ in range(ticks):
        stage.tick()


@settings(max_examples=20)
@given(
    speed=st.floats(-2.0, 2.0),
    turn=st.floats(-2.0, 2.0),
    yaw=st.floats(-3.1, 3.1),
    shape=st.sampled_from(["box", "circle", "polygon"]),
)
def test_in_the_open_a_robot_keeps_the_commanded_speed_within_one_percent(
    speed: float, turn: float, yaw: float, shape: str
) -> None:
    drive = {"max_speed": 2.0, "max_turn_rate": 180.0}
    _, stage = set_up(**OPEN, models={"a": robot(shape, drive)})
    stage.add_robot("a", (50, 50, yaw))
    stage.command([0], [[speed, 0.0, turn]])
    go(stage, 20)  # 1 s to reach 2 m/s at 2 m/s2, then some
    before, way = stage.poses[0].copy(), stage.distances[0]
    go(stage, 10)
    turned = math.remainder(stage.poses[0, 2] - before[2] - turn, math.tau)
    # One second; a path in pieces is shorter than the arc by (turn dt)^2 / 24 < 1e-4.
    assert stage.distances[0] - way == pytest.approx(abs(speed), rel=0.01, abs=1e-6)
    assert turned == pytest.approx(0.0, abs=0.01 * abs(turn) + 1e-6)
    assert stage.velocities[0] == pytest.approx([speed, 0.0, turn], rel=0.01, abs=1e-6)
    assert not stage.stalls[0]


def test_an_arc_of_many_steps_closes_on_its_circle() -> None:
    stage = one(robot())
    turn = math.tau / 12.0
    stage.command([0], [[0.5, 0.0, turn]])
    go(stage, 20)
    start = stage.poses[0].copy()
    go(stage, 120)
    # 12 s are one turn: a circle of 6 m. What is left is the rounding of 600 steps.
    assert np.hypot(*(stage.poses[0, :2] - start[:2])) < 1e-3


def test_a_robot_speeds_up_no_faster_than_its_acceleration() -> None:
    stage = one(robot(drive={"max_speed": 3.0, "max_acceleration": 1.0}))
    stage.command([0], [[3.0, 0.0, 0.0]])
    speeds = []
    for _ in range(40):
        stage.tick()
        speeds.append(stage.velocities[0, 0])
        assert not stage.stalls[0]  # speeding up is no stall
    assert np.diff(speeds).max() <= 0.1 + 1e-9  # 1 m/s2 for 0.1 s
    assert speeds[-1] == pytest.approx(3.0)


def test_a_differential_drive_cannot_go_sideways() -> None:
    stage = one(robot())
    stage.command([0], [[0.0, 0.4, 0.0]])
    go(stage, 10)
    assert stage.distances[0] == 0.0


def test_an_omnidirectional_drive_goes_any_way_at_most_at_its_speed() -> None:
    stage = one(robot(drive={"kind": "omnidirectional"}), (50, 50, 1.0))
    stage.command([0], [[3.0, 4.0, 0.0]])
    go(stage, 20)
    assert stage.velocities[0] == pytest.approx([0.3, 0.4, 0.0], abs=1e-9)


CAR = {"kind": "car", "wheelbase": 0.4, "max_steering": 30.0, "max_speed": 1.0}


def curvature(stage: Stage) -> float:
    return float(stage.velocities[0, 2] / stage.velocities[0, 0])


def test_a_car_drives_the_circle_that_it_steers() -> None:
    stage = one(robot(drive=CAR))
    stage.command_car(0, 0.5, math.radians(20.0))
    go(stage, 30)
    assert curvature(stage) == pytest.approx(math.tan(math.radians(20.0)) / 0.4, rel=1e-6)
    assert stage.velocities[0, 1] == pytest.approx(0.0, abs=1e-9)


def test_a_car_cannot_turn_tighter_than_its_steering() -> None:
    stage = one(robot(drive=CAR))
    stage.command([0], [[0.2, 0.0, 1.5]])
    tightest = math.tan(math.radians(30.0)) / 0.4
    for _ in range(30):
        stage.tick()
        assert abs(stage.velocities[0, 2]) <= tightest * abs(stage.velocities[0, 0]) + 1e-6
    stage.command([0], [[0.0, 0.0, 1.5]])
    go(stage, 20)
    assert stage.velocities[0] == pytest.approx([0, 0, 0], abs=1e-9)  # no turning on the spot


FORCES = {"max_force": 1e6, "max_torque": 1e6}


def test_a_car_that_would_turn_faster_than_it_may_drives_a_wider_circle() -> None:
    limits = {"max_speed": 2.0, "wheelbase": 0.3, "max_turn_rate": 90.0}
    stage = one(robot(drive={**CAR, **FORCES, **limits}))
    for steering in (30.0, -30.0):
        stage.command_car(0, 2.0, math.radians(steering))
        go(stage, 30)
        turn = math.copysign(math.pi / 2, steering)
        assert stage.velocities[0] == pytest.approx([2.0, 0.0, turn], abs=1e-6)
    stage.command([0], [[2.0, 0.0, 3.5]])
    go(stage, 30)
    assert stage.velocities[0] == pytest.approx([2.0, 0.0, math.pi / 2], abs=1e-6)


COMMANDS = st.lists(st.tuples(*[st.floats(-4.0, 4.0)] * 3), min_size=1, max_size=5)


@example(
    kind="car",
    limits=(0.298828125, 5.0, 1.5829169972000536, 254.0),
    commands=[(-1.0, 0.0, 0.0), (1.0, 0.0, 1.0)],
    steered=True,
)
@settings(max_examples=60, deadline=None)
@given(
    kind=st.sampled_from(["differential", "omnidirectional", "car"]),
    limits=st.tuples(
        st.floats(0.1, 3.0), st.floats(5.0, 400.0), st.floats(0.2, 5.0), st.floats(5.0, 800.0)
    ),
    commands=COMMANDS,
    steered=st.booleans(),
)
def test_no_drive_exceeds_any_of_its_limits(
    kind: str,
    limits: tuple[float, float, float, float],
    commands: list[tuple[float, float, float]],
    steered: bool,
) -> None:
    """From every tick to the next; 1e-6 is the rounding of a hundred steps of physics."""
    axles = {"wheelbase": 0.3, "max_steering": 40.0} if kind == "car" else {}
    names = ("max_speed", "max_turn_rate", "max_acceleration", "max_turn_acceleration")
    drive = {"kind": kind, **dict(zip(names, limits, strict=True)), **axles, **FORCES}
    stage = one(robot(drive=drive))
    speed, turn = limits[0], math.radians(limits[1])
    gain, turn_gain = limits[2], math.radians(limits[3])
    before = np.zeros(3)
    for command in [*commands, (0.0, 0.0, 0.0)]:
        if kind == "car" and steered:
            stage.command_car(0, command[0], command[2])
        else:
            stage.command([0], [command])
        for _ in range(8):
            stage.tick()
            vx, vy, wz = stage.velocities[0]
            assert math.hypot(vx, vy) <= speed + 1e-6
            assert abs(wz) <= turn + 1e-6
            assert math.hypot(vx - before[0], vy - before[1]) <= 0.1 * gain + 1e-6
            assert abs(wz - before[2]) <= 0.1 * turn_gain + 1e-6
            if kind == "car":
                assert abs(wz) <= math.tan(math.radians(40.0)) / 0.3 * abs(vx) + 1e-6
            before[:] = vx, vy, wz


def test_only_a_car_is_steered_and_a_car_is_not_sent_to_poses() -> None:
    with pytest.raises(ValueError, match="no steering"):
        one(robot()).command_car(0, 0.5, 0.1)
    with pytest.raises(ValueError, match="is a car"):
        one(robot(drive=CAR)).command_position(0, (1, 1, 0))


@pytest.mark.parametrize("kind", ["differential", "omnidirectional"])
@pytest.mark.parametrize("goal", [(53.0, 51.0, 1.0), (48.0, 50.0, -3.0), (50.0, 50.5, 0.0)])
def test_a_robot_sent_to_a_pose_arrives_and_stays(
    kind: str, goal: tuple[float, float, float]
) -> None:
    stage = one(robot(drive={"kind": kind}))
    stage.command_position(0, goal)
    go(stage, 200)
    x, y, yaw = stage.poses[0]
    # It brakes from within the tolerance, at walking pace: half of it more at most.
    assert math.hypot(x - goal[0], y - goal[1]) < 1.5 * ARRIVED
    assert math.remainder(yaw - goal[2], math.tau) == pytest.approx(0.0, abs=1e-3)
    assert stage.velocities[0] == pytest.approx([0, 0, 0], abs=1e-3)


def test_a_journey_keeps_to_the_speed_it_was_given() -> None:
    stage = one(robot())
    stage.command_position(0, (55.0, 50.0, 0.0), speed=0.2)
    fastest = 0.0
    for _ in range(50):
        stage.tick()
        fastest = max(fastest, stage.velocities[0, 0])
    assert fastest == pytest.approx(0.2, rel=1e-6)


def test_a_heading_is_turned_to_and_held() -> None:
    stage = one(robot())
    stage.command_heading(0, 0.3, 2.5)
    go(stage, 60)
    assert stage.poses[0, 2] == pytest.approx(2.5, abs=1e-3)
    assert stage.velocities[0, 0] == pytest.approx(0.3)


def test_motors_that_are_off_obey_nothing_until_they_are_on() -> None:
    stage = one(robot())
    stage.motors(0, False)
    stage.command([0], [[0.5, 0.0, 0.0]])
    go(stage, 10)
    assert stage.distances[0] == 0.0
    assert not stage.stalls[0]
    stage.motors(0, True)
    go(stage, 10)
    assert stage.velocities[0, 0] == pytest.approx(0.5)


def test_a_robot_without_a_drive_stands() -> None:
    stage = one({**robot(), "drive": None})
    stage.command([0], [[0.5, 0.0, 1.0]])
    go(stage, 10)
    assert stage.distances[0] == 0.0


def test_a_weak_drive_accelerates_by_its_force_alone() -> None:
    stage = one(robot(drive={"max_force": 5.0}, mass=10.0))
    stage.command([0], [[0.5, 0.0, 0.0]])
    go(stage, 5)
    # 5 N on 10 kg for 25 steps of 0.02 s
    assert stage.velocities[0, 0] == pytest.approx(0.25, abs=1e-6)


def test_joints_and_forces_move_a_robot_alike() -> None:
    """Near a wall a robot is moved by joints, far from all by forces: the way is the same."""
    ways = []
    for y in (50.0, 1.0):
        drive = {"kind": "omnidirectional", "max_speed": 1.0, "max_force": 15.0}
        stage = one(robot(drive=drive), (50, y, 0))
        stage.command([0], [[0.7, 0.0, 0.4]])
        way = []
        for tick in range(30):
            if tick == 15:
                stage.command([0], [[-0.2, 0.0, -1.0]])
            stage.tick()
            way.append(stage.poses[0] - [50, y, 0])
        ways.append(way)
    assert np.allclose(*ways, atol=1e-12)


def test_a_settled_robot_is_a_wall() -> None:
    _, stage = set_up(models={"a": robot(), "b": robot(drive={"max_force": 5000})})
    stage.add_robot("a", (5, 5, 0))
    stage.add_robot("b", (3, 5, 0))
    stage.command([0, 1], [[0.5, 0.0, 0.0]] * 2)
    stage.settle(0)
    go(stage, 60)
    assert stage.poses[0] == pytest.approx([5, 5, 0], abs=0)
    assert stage.poses[1, 0] == pytest.approx(4.5, abs=0.02)
    assert stage.stalls.tolist() == [False, True]
    assert stage.settled.tolist() == [True, False]


def test_a_robot_put_elsewhere_goes_on_from_there() -> None:
    stage = one(robot())
    stage.command([0], [[0.5, 0.0, 0.0]])
    go(stage, 10)
    way = stage.distances[0]
    stage.set_pose(0, (20.0, 30.0, 7.0))
    assert stage.poses[0] == pytest.approx([20, 30, 7 - math.tau])
    assert stage.velocities[0].tolist() == [0, 0, 0]
    go(stage, 10)
    assert 0.3 < stage.distances[0] - way < 0.5  # the jump is no way gone
    assert np.hypot(*(stage.poses[0, :2] - [20, 30])) == pytest.approx(stage.distances[0] - way)


def test_robots_may_come_at_any_time_and_keep_their_numbers() -> None:
    _, stage = set_up(**OPEN, models={"a": robot()})
    for number in range(40):
        assert stage.add_robot("a", (2.0 + 2 * number, 50, 1.5)) == number
        stage.command([number], [[0.1, 0.0, 0.0]])
        stage.tick()
    assert stage.poses[:, 0] == pytest.approx(2.0 + 2 * np.arange(40), abs=0.3)
    assert np.all(np.diff(stage.distances) < 0)  # who came first has gone farthest


def test_commands_that_are_no_numbers_are_refused() -> None:
    stage = one(robot())
    with pytest.raises(ValueError, match="finite"):
        stage.command([0], [[math.nan, 0, 0]])
    with pytest.raises(ValueError, match="finite"):
        stage.command_position(0, (math.inf, 0, 0))
    with pytest.raises(ValueError, match="three finite"):
        stage.set_pose(0, (1, 2))
    with pytest.raises(IndexError, match="no robot 3"):
        stage.settle(3)


@settings(max_examples=50)
@given(turns=st.floats(-50, 50))
def test_yaws_are_wrapped(turns: float) -> None:
    _, stage = set_up(models={"a": robot()})
    stage.add_robot("a", (5, 5, turns))
    for _ in range(2):
        assert -math.pi < stage.poses[0, 2] <= math.pi
        assert math.remainder(stage.poses[0, 2] - turns, math.tau) == pytest.approx(0, abs=1e-12)
        stage.tick()


BOX = {"shape": "box", "size": (1.0, 1.0), "pose": (5.0, 5.0, 0), "movable": False}


def crowded() -> Stage:
    """Two robots of 0.5 x 0.4 m, a box that stands and one that can be pushed."""
    obstacles = [BOX, {**BOX, "pose": (8.0, 5.0, 0), "movable": True}]
    _, stage = set_up(models={"a": robot()}, obstacles=obstacles)
    stage.add_robot("a", (2.0, 2.0, 0.0))
    stage.add_robot("a", (4.0, 2.0, 0.0))
    return stage


@pytest.mark.parametrize(
    "pose",
    [(5, 5, 0), (4.3, 5, 0), (8.7, 5, 0), (4.0, 2.0, 0), (0.2, 5, 0), (11, 5, 0), (-1, 1, 0)],
)
def test_no_robot_is_put_into_anything(pose: tuple[float, float, float]) -> None:
    stage = crowded()
    with pytest.raises(ValueError, match="robot 0 has no room"):
        stage.set_pose(0, pose)
    assert stage.poses[0] == pytest.approx([2, 2, 0])


def test_a_robot_that_rests_on_something_may_be_put_where_it_is() -> None:
    stage = crowded()
    stage.set_pose(0, (4.2, 5.0, 0.0))
    stage.command([0], [[0.5, 0.0, 0.0]])
    go(stage, 20)
    assert stage.stalls[0]
    stage.set_pose(0, stage.poses[0])


def test_a_place_that_something_was_pushed_away_from_is_free() -> None:
    stage = crowded()
    stage.set_pose(0, (7.0, 5.0, 0.0))
    stage.command([0], [[0.5, 0.0, 0.0]])
    go(stage, 40)
    assert stage.movable_poses[0, 0] > 8.5
    stage.set_pose(1, (7.0, 3.0, 0.0))
    stage.set_pose(0, (2.0, 2.0, 0.0))
    stage.set_pose(1, (7.6, 5.0, 0.0))


def test_robots_are_put_down_together_and_who_has_no_room_stays_in_the_way() -> None:
    stage = crowded()
    assert stage.set_poses({0: (4.0, 2.0, 0.0), 1: (2.0, 2.0, 0.0)}) == []  # a swap
    assert stage.poses[:, 0] == pytest.approx([4.0, 2.0])
    # the first has no room in the box, stays, and so the second cannot take its place
    assert stage.set_poses({0: (5.0, 5.0, 0.0), 1: (4.0, 2.0, 0.0)}) == [0, 1]
    assert stage.set_poses({0: (6.0, 8.0, 0.0), 1: (6.0, 8.0, 0.0)}) == [1]
    assert stage.poses[:, 0] == pytest.approx([6.0, 2.0])
