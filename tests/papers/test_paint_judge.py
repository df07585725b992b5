"""The judge of Paint sees what touches, and when the order changes."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np

from tests.papers.paint_bench import expected_goals, ranked, touching, walls_of
from tests.papers.paint_judge import Judge

ROOM = np.array([(0.0, 0.0), (16.0, 0.0), (16.0, 21.0), (0.0, 21.0)])
TURNED = math.pi / 4


def test_bodies_touch_where_their_squares_overlap_and_walls_where_a_corner_is_outside() -> None:
    apart = np.array([(2.0, 2.0, 0.0), (3.001, 2.0, 0.0), (8.0, 0.501, 0.0), (8.0, 3.0, TURNED)])
    assert touching(apart, *walls_of(ROOM)) == set()
    beside = np.array([(2.0, 2.0, 0.0), (3.1, 2.0, TURNED), (8.0, 0.6, TURNED), (12.0, 9.0, 0.0)])
    assert touching(beside, *walls_of(ROOM)) == {(0, 1), (2, 4)}


def test_a_robot_that_passes_anothers_height_changes_the_order() -> None:
    judge = _judge_rising([5.0, 5.9, 6.0001, 6.1], start=5.0)
    assert judge.contacts == []
    assert [line.split(":")[0] for line in judge.swaps] == ["6.0 s", "6.1 s"]


def test_robots_that_start_level_may_exchange_a_centimetre_and_no_more() -> None:
    assert _judge_rising([5.999, 6.0, 6.009], start=5.999).swaps == []
    assert len(_judge_rising([5.999, 6.0, 6.011], start=5.999).swaps) == 1


def test_ranks_are_by_height_and_by_x_where_no_robot_can_tell_the_heights_apart() -> None:
    heights = [4.6111, 4.6034, 4.6021, 1.0]
    starts = np.array([(x, y, 0.0) for x, y in zip([8.2, 2.6, 4.7, 9.0], heights, strict=True)])
    order, level = ranked(starts)
    assert order.tolist() == [3, 1, 2, 0]
    assert level.tolist() == [False, True, False]
    assert expected_goals(starts, (0.0, 0.0), (16.0, 20.0))[:, 1].tolist() == [15.6, 5.6, 10.6, 0.6]


def _judge_rising(heights: list[float], start: float) -> Judge:
    """A judge that has watched one robot rise from `start` through `heights` beside one at 6 m."""
    judge = Judge(ROOM, (1.5, 1.5))
    robots = [
        SimpleNamespace(record=SimpleNamespace(start=pose), sprayers=[])
        for pose in ((2.0, start, 0.0), (9.0, 6.0, 0.0))
    ]
    for y in heights:
        judge.each_tick(
            SimpleNamespace(  # type: ignore[arg-type] - all that the judge looks at
                time=y,
                scenery=SimpleNamespace(stage=SimpleNamespace(poses=[(2, y, 0), (9, 6, 0)])),
                robots=robots,
            )
        )
    return judge
