"""Bodies that can meet nobody in a tick move as if they were alone."""

from __future__ import annotations

import numpy as np
import pytest
from stage_worlds import robot, set_up

from sim.stage.stage import Stage

OPEN = {"size": (100.0, 100.0), "boundary": None}
OMNI = {"kind": "omnidirectional", "max_speed": 2.0, "max_force": 40.0}


def inside(stage: Stage) -> list[bool]:
    """Which movers, movable obstacles first, are in Chipmunk's space."""
    found: list[bool] = stage._movers["inside"][: stage._movables + stage.count].tolist()
    return found


def test_what_others_do_far_away_changes_nothing_at_all() -> None:
    ways = []
    for crowd in (False, True):
        _, stage = set_up(**OPEN, models={"a": robot(drive={"max_speed": 1.0})})
        stage.add_robot("a", (20, 20, 0.3))
        stage.command([0], [[0.7, 0.0, 0.2]])
        if crowd:  # two that press against each other: the steps are cut for them
            for x, yaw in ((70.0, 0.0), (71.0, np.pi)):
                stage.add_robot("a", (x, 70, yaw))
            stage.command([1, 2], [[1.0, 0.0, 0.5]] * 2)
        way = []
        for _ in range(60):
            stage.tick()
            way.append(stage.poses[0].copy())
        assert inside(stage) == [False, True, True][: stage.count]
        ways.append(np.array(way))
    assert np.array_equal(*ways)


def test_who_comes_near_to_things_and_leaves_them_keeps_to_its_way() -> None:
    posts = [{"shape": "circle", "radius": 0.3, "pose": (x, 50.9, 0)} for x in (20.0, 45.0, 70.0)]
    ways, been = [], set()
    for obstacles in ([], posts):
        _, stage = set_up(**OPEN, models={"a": robot(drive=OMNI)}, obstacles=obstacles)
        stage.add_robot("a", (5, 50, 0.2))
        stage.command_position(0, (90, 50, 0.2), speed=1.5)
        way = []
        for _ in range(560):
            stage.tick()
            way.append(stage.poses[0].copy())
            if obstacles:
                been.add((round(stage.poses[0, 0] / 12.5), *inside(stage)))
        ways.append(np.array(way))
        assert stage.contact_counts[0] == 0
    # It was in the space at each of the posts, and out of it between them.
    assert {place for place, there in been if there} >= {2, 4, 6}
    assert {place for place, there in been if not there} >= {1, 3, 5, 7}
    # Joints find the same velocities as the impulse, but for the rounding of 560 ticks.
    assert np.allclose(*ways, atol=1e-9)


def test_what_slides_alone_is_braked_as_beside_a_wall() -> None:
    ways = []
    wall = {"shape": "box", "size": (40, 0.2), "pose": (50, 50.7, 0)}
    for more in ([], [wall]):
        puck = {"shape": "circle", "radius": 0.3, "pose": (40, 50, 0), "movable": True}
        _, stage = set_up(
            **OPEN,
            models={"a": robot(drive=OMNI)},
            obstacles=[{**puck, "mass": 1.0, "friction": 0.01}, *more],
        )
        stage.add_robot("a", (39, 50, 0))
        stage.command([0], [[0.6, 0.0, 0.0]])  # no step is cut for less than 0.75 m/s
        for _ in range(30):
            stage.tick()
        stage.set_pose(0, (10, 10, 0))  # what it pushed slides on without it
        stage.command([0], [[0.0, 0.0, 0.0]])
        way = []
        for _ in range(150):
            stage.tick()
            way.append(stage.movable_poses[0].copy())
        assert inside(stage)[0] == bool(more)
        assert np.array_equal(way[-1], way[-2])  # it lies
        ways.append(np.array(way))
    # Either way it loses 0.01 x 9.81 m/s2 x 0.1 s a tick, until it lies.
    for way in ways:
        assert np.diff(way[:50, 0], 2) == pytest.approx(-0.01 * 9.81 * 0.1**2, abs=1e-9)
        assert way[-1, 0] - way[0, 0] == pytest.approx(0.6**2 / (2 * 0.0981), abs=0.1)


def test_what_is_held_stays_so_at_whatever_heights() -> None:
    """The holder passes above what it holds, so that neither could meet anything."""
    puck = {"shape": "circle", "radius": 0.1, "pose": (50.4, 50, 0), "movable": True}
    arm = robot(drive=OMNI, z=1.0, height=0.5)
    _, stage = set_up(**OPEN, models={"a": arm}, obstacles=[{**puck, "mass": 0.1, "height": 0.2}])
    stage.add_robot("a", (50, 50, 0))
    for _ in range(30):
        stage.tick()
    assert inside(stage) == [False, False]
    stage.hold(0, 0)
    stage.command([0], [[0.5, 0.2, 0.0]])
    for _ in range(60):
        stage.tick()
    assert inside(stage) == [True, True]
    assert stage.poses[0, 0] > 52
    assert stage.movable_poses[0] - stage.poses[0] == pytest.approx([0.4, 0, 0], abs=0.01)
    stage.let_go(0)
    stage.command([0], [[0.0, 0.0, 0.0]])
    for _ in range(40):
        stage.tick()
    assert inside(stage) == [False, False]
