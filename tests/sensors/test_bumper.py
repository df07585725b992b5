"""The bumper: which switch closes."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from sensing import Stage

from sensors.registry import settings_for
from sensors.view import Contacts


def touch(stage, *contacts):
    """Sense with contacts: points (robot, x, y), or stretches (robot, x1, y1, x2, y2)."""
    stage.suite.contacts = Contacts(
        np.array([c[0] for c in contacts], np.int64),
        np.array([c[1:3] for c in contacts], float).reshape(-1, 2),
        np.array([c[-2:] for c in contacts], float).reshape(-1, 2),
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


def closed(stage):
    return np.flatnonzero(stage.data().bits[0]).tolist()


def test_a_stretch_closes_every_switch_that_it_meets_from_end_to_end():
    stage = Stage()
    stage.robot(0, 0, 0, {"type": "bumper", "count": 36})
    touch(stage, (0, 0.5, -0.5, 0.5, 0.5))  # bearings -45 to 45; switch k is 10 k - 5 to 10 k + 5
    assert closed(stage) == [0, 1, 2, 3, 4, 5, 31, 32, 33, 34, 35]
    touch(stage, (0, -0.5, 0.1, -0.5, -0.1))  # over the bearing of 180 degrees, either way round
    assert closed(stage) == [17, 18, 19]
    touch(stage, (0, -0.5, -0.1, -0.5, 0.1))
    assert closed(stage) == [17, 18, 19]
    touch(stage, (0, 0.5, 0.01, 0.5, 0.02), (0, -0.02, 0.5, 0.02, 0.5))
    assert closed(stage) == [0, 9]


def test_a_flat_contact_in_the_middle_of_a_side_closes_the_switch_there():
    stage = Stage()
    narrow = {"type": "bumper", "parts": [[-10, 10], [10, 44], [44, 46], [46, 90]]}
    stage.robot(3, 4, np.pi / 2, narrow)
    touch(stage, (0, 2.5, 4.5, 3.5, 4.5))  # the whole front, up to the corners
    assert closed(stage) == [0, 1, 2]
    touch(stage, (0, 2.5, 4.5, 2.5, 3.5))  # the whole left side
    assert closed(stage) == [2, 3]
    touch(stage, (0, 2.5, 4.5, 2.5, 4.5))  # a corner
    assert closed(stage) == [2]


def test_bearings_count_from_the_bumpers_own_place():
    stage = Stage()
    stage.robot(0, 0, 0, {"type": "bumper", "pose": [0.4, 0, 90], "count": 4})
    touch(stage, (0, 0.5, -0.05, 0.5, 0.05))
    assert closed(stage) == [3]  # to the right of a bumper that looks left
    touch(stage, (0, 0.4, -0.5, 0.4, 0.5))  # through the place itself: at every bearing
    assert closed(stage) == [0, 1, 2, 3]


@settings(max_examples=200, deadline=None)
@given(
    st.tuples(*[st.floats(-1, 1)] * 4),
    st.tuples(*[st.floats(-1, 1)] * 2, st.floats(-4, 4)),
    st.floats(-720, 720),
    st.floats(0.1, 360),
)
def test_a_switch_closes_just_when_some_point_of_the_stretch_lies_in_its_arc(
    stretch, pose, begin, width
):
    stage = Stage()
    stage.robot(*pose, {"type": "bumper", "parts": [[begin, begin + width]]})
    touch(stage, (0, *stretch))
    a, b = (complex(*end) - complex(*pose[:2]) for end in (stretch[:2], stretch[2:]))
    points = a + np.linspace(0, 1, 3000) * (b - a)
    assume(np.abs(points).min() > 1e-6)  # where it touches the place itself has no bearing
    turn = np.diff(np.angle(points * np.exp(-1j * pose[2])))
    # A bearing may lie between two of the points, by as much as it changes from one to the next.
    step = np.degrees(np.abs((turn + np.pi) % (2 * np.pi) - np.pi).max()) + 1e-6
    past = (np.degrees(np.angle(points * np.exp(-1j * pose[2]))) - begin) % 360
    inside = (past <= width - step) & (past >= step)
    near = (past <= width + step) | (past >= 360 - step)
    if inside.any():
        assert closed(stage) == [0]
    if not near.any():
        assert closed(stage) == []


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
