"""A ring of sonars whose elements see as far and as wide as each of them does."""

import math

import numpy as np
import pytest
from pydantic import ValidationError
from sensing import Stage

from sensors.registry import settings_for

RING = {
    "type": "ranger",
    "elements": [[0, 0, 0], [0, 0, 90], [0, 0, 180], [0, 0, -90]],
    "range": [5, 2, 5, 3],
    "fov": [20, 20, 40, 20],
}


def test_each_element_measures_as_far_and_as_wide_as_it_sees() -> None:
    stage = Stage()
    stage.robot(0, 0, 0, RING)
    stage.wall(4, -9, 4, 9)  # ahead: within 5 m
    stage.wall(-9, 2.5, 9, 2.5)  # to the left: beyond 2 m
    stage.box(-2, 0.6, size=(0.2, 0.2))  # behind, 15 degrees aside: within 40 of width
    stage.wall(-9, -2.5, 9, -2.5)  # to the right: within 3 m
    stage.sense()
    corner = math.hypot(1.9, 0.5)
    np.testing.assert_allclose(stage.data().ranges[0], [4.0, 2.0, corner, 2.5], atol=1e-9)


def test_a_ring_of_equal_elements_measures_what_lists_of_equal_numbers_say() -> None:
    def measured(**told):
        stage = Stage()
        stage.robot(0, 0, 0.3, RING | {"noise": 0.05} | told)
        stage.wall(2, -9, 2, 9)
        stage.sense(7)
        return stage.data().ranges

    one = measured(range=4, fov=30)
    assert (one == measured(range=[4] * 4, fov=[30] * 4)).all()


def test_noise_leaves_each_element_its_own_end() -> None:
    stage = Stage()
    stage.robot(0, 0, 0, RING | {"noise": 2.0})
    stage.wall(1.9, -9, 1.9, 9)
    stage.wall(-9, 1.9, 9, 1.9)
    for tick in range(30):
        stage.sense(tick)
        ranges = stage.data().ranges[0]
        assert ranges[0] < 5
        assert ranges[1] < 2
        assert (ranges[2], ranges[3]) == (5, 3)  # nothing is there


@pytest.mark.parametrize(
    ("told", "says"),
    [
        ({"range": [5, 2]}, "one for each of 4 elements"),
        ({"fov": [5, 2, 4, 4, 4]}, "one for each of 4 elements"),
        ({"range": [5, 2, 0, 4]}, "greater than 0"),
        ({"fov": [5, 2, 400, 4]}, "less than or equal to 360"),
        ({"min_range": 2}, "min_range must be below range"),
    ],
)
def test_lists_that_do_not_fit_the_ring_are_told(told, says) -> None:
    with pytest.raises(ValidationError, match=says):
        settings_for(RING | told)
