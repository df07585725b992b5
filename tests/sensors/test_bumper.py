"""The bumper: which switch closes."""

import numpy as np
import pytest
from pydantic import ValidationError
from sensing import Stage

from sensors.registry import settings_for
from sensors.view import Contacts


def touch(stage, *contacts):
    """Sense with contacts (robot, x, y)."""
    stage.suite.contacts = Contacts(
        np.array([c[0] for c in contacts], np.int64),
        np.array([c[1:] for c in contacts], float).reshape(-1, 2),
    )
    stage.sense()


def test_four_switches_are_ahead_left_behind_and_right():
    stage = Stage()
    stage.robot(2, 3, np.pi / 2, {"type": "bumper"})
    for k, (x, y) in enumerate([(2, 3.5), (1.5, 3), (2, 2.5), (2.5, 3)]):
        touch(stage, (0, x, y))
        assert np.flatnonzero(stage.data().bits[0]).tolist() == [k]
    touch(stage)
    assert not stage.data().bits.any()


def test_a_contact_closes_the_switches_of_its_own_robot_alone():
    stage = Stage()
    stage.robot(0, 0, 0, {"type": "bumper", "count": 8}, {"type": "bumper", "count": 8})
    stage.robot(5, 0, 0)
    stage.robot(9, 0, 0, {"type": "bumper", "count": 8})
    touch(stage, (2, 9, 0.5), (1, 5.5, 0), (2, 8.5, 0))
    assert np.flatnonzero(stage.data(2).bits[0]).tolist() == [2, 4]
    assert not stage.data(0, 0).bits.any()
    touch(stage, (0, 0.5, 0))
    assert stage.data(0, 0).bits[0].tolist() == stage.data(0, 1).bits[0].tolist()
    assert stage.data(0, 1).bits[0, 0]
    assert not stage.data(2).bits.any()


def test_parts_reach_where_they_are_told_and_share_their_borders():
    stage = Stage()
    stage.robot(0, 0, 0, {"type": "bumper", "parts": [[-90, 0], [0, 90], [170, 190]]})
    np.testing.assert_allclose(stage.suite.groups[0].readings.arcs[2], np.radians([170, 190]))
    for (x, y), closed in {
        (0.5, -0.1): [0],
        (0.5, 0.0): [0, 1],
        (0.0, 0.5): [1],
        (-0.5, 0.01): [2],
        (-0.5, -0.01): [2],
        (-0.5, -0.4): [],
    }.items():
        touch(stage, (0, x, y))
        assert np.flatnonzero(stage.data().bits[0]).tolist() == closed


@pytest.mark.parametrize("count", [1, 2, 3, 7, 360])
def test_equal_switches_leave_no_gap(count):
    stage = Stage()
    stage.robot(0, 0, 0.7, {"type": "bumper", "count": count})
    for angle in np.linspace(-4, 4, 100):
        touch(stage, (0, np.cos(angle), np.sin(angle)))
        assert 1 <= stage.data().bits.sum() <= 2


def test_contacts_may_change_while_a_bumper_is_not_wanted():
    stage = Stage()
    stage.robot(0, 0, 0, {"type": "bumper"})
    touch(stage, (0, 0.5, 0))
    stage.suite.contacts = Contacts.none()
    stage.sense(1, wanted=np.array([False]))
    assert stage.data().bits[0, 0]
    assert stage.suite.reading(0, 0).time == 0.0
    stage.sense(2)
    assert not stage.data().bits.any()


@pytest.mark.parametrize(
    ("mistake", "message"),
    [
        ({"parts": [[90, 0]]}, "counter-clockwise"),
        ({"parts": [[0, 361]]}, "360 degrees at most"),
        ({"parts": [[0, 90]], "count": 4}, "not both"),
        ({"count": 0}, "greater than or equal to 1"),
    ],
)
def test_impossible_parts_are_mistakes(mistake, message):
    with pytest.raises(ValidationError, match=message):
        settings_for({"type": "bumper"} | mistake)
