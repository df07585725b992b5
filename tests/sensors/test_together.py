"""What a tick of sensing needs is gathered once, and anew whenever it may be something else."""

import numpy as np
import pytest
from sensing import BLUE, RED, Stage

from sensors.view import Contacts

LASER = {"type": "laser", "samples": 5, "range": 8}
CAMERA = {"type": "blobfinder", "image": [5, 4], "range": 8, "colors": ["red", "blue"]}


@pytest.fixture
def stage() -> Stage:
    """A robot that looks along x at a red box 3 m away, with a wall 5 m away behind it."""
    stage = Stage()
    stage.red = stage.box(3.5, 0, color=RED)
    stage.wall(5, -9, 5, 9)
    stage.robot(0, 0, 0, LASER, CAMERA)
    stage.sense()
    return stage


def ahead(stage: Stage) -> float:
    return float(stage.data(0, 0).ranges[0, 2])


def test_a_tick_in_which_nothing_is_new_goes_by_the_same_plan(stage: Stage) -> None:
    plan = stage.suite._plan
    stage.scene.poses[stage.red, 0] += 0.5
    stage.sense(1)
    assert stage.suite._plan is plan
    assert ahead(stage) == pytest.approx(3.5)


def test_another_colour_is_seen_at_once(stage: Stage) -> None:
    stage.scene.colors[stage.red] = BLUE
    stage.sense(1)
    assert stage.data(0, 1).seen(0)["color"].tolist().count(BLUE) == 1


def test_what_comes_is_hidden_or_is_a_wall_that_moves_is_seen_at_once(stage: Stage) -> None:
    near = stage.box(1.5, 0, color=BLUE)
    stage.sense(1)
    assert ahead(stage) == pytest.approx(1.0)
    stage.scene.hide(near)
    stage.sense(2)
    assert ahead(stage) == pytest.approx(3.0)
    stage.scene.poses[stage.red + 1, 0] -= 3.0  # the wall
    stage.sense(3)
    assert ahead(stage) == pytest.approx(2.0)


def test_a_robot_that_comes_senses_and_those_before_it_go_on(stage: Stage) -> None:
    for k in range(20):  # as many as no array has room for
        stage.robot(-2 - 3 * k, 0, np.pi, LASER, CAMERA)
        stage.sense(1 + k)
    assert ahead(stage) == pytest.approx(3.0)
    assert float(stage.data(1, 0).ranges[0, 2]) == pytest.approx(2.5)


def test_of_sensors_cast_together_each_may_be_wanted_alone(stage: Stage) -> None:
    stage.scene.poses[stage.red, 0] += 1.0
    stage.sense(1, wanted=np.array([True, False]))
    assert ahead(stage) == pytest.approx(4.0)
    assert stage.suite.reading(0, 1).time == 0.0
    stage.sense(2, wanted=np.array([False, True]))
    assert (stage.suite.reading(0, 0).time, stage.suite.reading(0, 1).time) == (0.1, 0.2)
    stage.sense(3, wanted=np.array([False, False]))
    assert stage.suite.reading(0, 1).time == 0.2


def test_contacts_are_looked_for_only_where_a_bumper_asks() -> None:
    asked = []

    def contacts() -> Contacts:
        asked.append(True)
        return Contacts(np.array([0]), np.array([[0.5, 0.0]]))

    stage = Stage()
    stage.robot(0, 0, 0, LASER, {"type": "bumper", "count": 4})
    stage.suite.contacts = contacts
    stage.sense(1, wanted=np.array([True, False]))
    assert not asked
    stage.sense(2, wanted=np.array([True, True]))
    assert stage.data(0, 1).bits.tolist() == [[True, False, False, False]]
