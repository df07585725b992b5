"""Judges see what touches, who passes whom, how near all come, and where they have been."""

from __future__ import annotations

import math

import numpy as np
import pytest

from controllers.paint.constants import LEVEL
from troupe.testing import (
    Contact,
    Evidence,
    clearances,
    contacts,
    covered,
    distances,
    first_difference,
    passings,
)
from troupe.testing.evidence import Surroundings, Thing
from troupe.testing.paint.goals import SAME_HEIGHT, expected_goals
from troupe.testing.ranks import ranked

SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
ROOM = np.array([(0.0, 0.0), (16.0, 0.0), (16.0, 21.0), (0.0, 21.0)])
TURNED = math.pi / 4


def seen(
    ways: list[list[tuple[float, float, float]]], *standing: Thing, outline: object = SQUARE
) -> Evidence:
    """Squares in a room that stand, tick by tick of 0.1 s, at these poses."""
    poses = np.array(ways)
    names = [f"r{k}" for k in range(poses.shape[1])]
    return Evidence(
        names,
        [outline] * len(names),
        poses[0],
        0.1 * np.arange(1, len(ways) + 1),
        poses,
        Surroundings((16.0, 21.0), ROOM, standing),
    )


def test_bodies_touch_where_their_squares_overlap_and_walls_where_a_corner_is_outside() -> None:
    apart = [(2.0, 2.0, 0.0), (3.001, 2.0, 0.0), (8.0, 0.501, 0.0), (8.0, 3.0, TURNED)]
    assert contacts(seen([apart])) == []
    beside = [(2.0, 2.0, 0.0), (3.1, 2.0, TURNED), (8.0, 0.6, TURNED), (12.0, 9.0, 0.0)]
    found = contacts(seen([apart, beside, beside, apart, beside]))
    assert [(one.robot, one.other) for one in found] == [
        ("r0", "r1"), ("r2", "boundary"), ("r0", "r1"), ("r2", "boundary"),
    ]  # fmt: skip
    assert [(one.time, one.until) for one in found] == [
        pytest.approx((0.2, 0.3)), pytest.approx((0.2, 0.3)), (0.5, 0.5), (0.5, 0.5),
    ]  # fmt: skip
    assert found[0].depth == pytest.approx(0.5 + math.sqrt(0.5) - 1.1)
    assert contacts(seen([beside]), deeper_than=0.11) == []
    assert str(found[0]) == "r0 and r1 overlap by 0.1071 m, 0.2 to 0.3 s"


def test_the_blocks_of_a_map_are_one_thing_to_touch() -> None:
    blocks = [Thing("map", SQUARE, np.array([x, 5.0, 0.0])) for x in (4.0, 5.0)]
    sliding = [[(x, 5.9, 0.0)] for x in (3.8, 4.2, 4.8, 5.2)]
    assert contacts(seen(sliding, *blocks)) == [
        Contact(pytest.approx(0.1), pytest.approx(0.4), "r0", "map", pytest.approx(0.1))
    ]


def test_what_has_not_entered_yet_touches_nobody_and_has_no_distance() -> None:
    ways = [[(2.0, 2.0, 0.0), (math.nan,) * 3], [(2.0, 2.0, 0.0), (4.0, 2.0, 0.0)]]
    assert contacts(seen(ways)) == []
    gaps = distances(seen(ways))
    assert np.isnan(gaps[0]).sum() == 3
    assert gaps[1, 0, 1] == gaps[1, 1, 0] == pytest.approx(1.0)
    assert np.isnan(clearances(seen(ways))[0]).tolist() == [False, True]


def test_the_nearest_of_walls_and_obstacles_is_what_is_clear() -> None:
    post = Thing("obstacle 0", 0.4, np.array([5.0, 10.0, 0.0]))
    found = clearances(seen([[(2.0, 10.0, 0.0)], [(3.5, 10.0, 0.0)]], post))
    assert found[:, 0] == pytest.approx([1.5, 0.6])


def test_a_robot_that_passes_anothers_height_changes_the_order() -> None:
    (passing,) = rising([5.0, 5.9, 6.0001, 6.1], start=5.0)
    assert (passing.behind, passing.before) == ("r0", "r1")
    assert (passing.time, passing.until) == pytest.approx((0.4, 0.5))
    assert passing.by == pytest.approx(0.1)


def test_robots_that_start_level_may_exchange_a_centimetre_and_no_more() -> None:
    assert rising([5.999, 6.0, 6.009], start=5.999) == []
    assert len(rising([5.999, 6.0, 6.011], start=5.999)) == 1


def rising(heights: list[float], start: float) -> list:
    """Who passes whom where one robot rises from `start` through `heights` beside one at 6 m."""
    ways = [[(2.0, y, 0.0), (9.0, 6.0, 0.0)] for y in [start, *heights]]
    return passings(seen(ways), level=LEVEL, give=SAME_HEIGHT)


def test_along_x_it_is_the_other_axis_that_counts() -> None:
    ways = [[(2.0, 9.0, 0.0), (4.0, 3.0, 0.0)], [(6.0, 9.0, 0.0), (4.0, 3.0, 0.0)]]
    assert [one.behind for one in passings(seen(ways), along="x")] == ["r0"]
    assert passings(seen(ways), along="y") == []


def test_ranks_are_by_height_and_by_x_where_no_robot_can_tell_the_heights_apart() -> None:
    heights = [4.6111, 4.6034, 4.6021, 1.0]
    starts = np.array([(x, y, 0.0) for x, y in zip([8.2, 2.6, 4.7, 9.0], heights, strict=True)])
    order, level = ranked(starts, level=LEVEL)
    assert order.tolist() == [3, 1, 2, 0]
    assert level.tolist() == [False, True, False]
    assert expected_goals(starts, (0.0, 0.0), (16.0, 20.0))[:, 1].tolist() == [15.6, 5.6, 10.6, 0.6]


def test_floor_that_was_come_by_is_covered_and_what_stands_does_not_count() -> None:
    way = [[(x, 10.5, 0.0)] for x in np.arange(0.5, 16.0, 0.5)]
    share = covered(seen(way), 3.0, resolution=0.25)
    assert (np.diff(share) >= 0.0).all()
    assert share[-1] == pytest.approx(6.0 / 21.0, abs=0.02)
    block = Thing("obstacle 0", 6.0 * SQUARE * [3.0, 1.0], np.array([8.0, 3.0, 0.0]))
    assert covered(seen(way, block), 3.0)[-1] == pytest.approx(6.0 / 15.0, abs=0.03)


def test_the_first_difference_of_two_runs_is_told() -> None:
    a = seen([[(2.0, 2.0, 0.0), (5.0, 5.0, 0.0)], [(2.5, 2.0, 0.0), (5.0, 5.0, 0.0)]])
    b = seen([[(2.0, 2.0, 0.0), (5.0, 5.0, 0.0)], [(2.5, 2.0, 0.0), (5.0, 5.25, 0.0)]])
    assert first_difference(a, a) is None
    assert first_difference(a, b) == (0.2, "r1", (0.0, 0.25, 0.0))
    shorter = seen([[(2.0, 2.0, 0.0), (5.0, 5.0, 0.0)]])
    assert first_difference(a, shorter) == first_difference(shorter, a) == (0.2, None, None)
