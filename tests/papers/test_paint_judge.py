"""The judge of Paint sees what touches, and when the order changes."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np

from tests.papers.paint_bench import touching, walls_of
from tests.papers.paint_judge import Judge

ROOM = np.array([(0.0, 0.0), (16.0, 0.0), (16.0, 21.0), (0.0, 21.0)])
TURNED = math.pi / 4


def test_bodies_touch_where_their_squares_overlap_and_walls_where_a_corner_is_outside() -> None:
    apart = np.array([(2.0, 2.0, 0.0), (3.001, 2.0, 0.0), (8.0, 0.501, 0.0), (8.0, 3.0, TURNED)])
    assert touching(apart, *walls_of(ROOM)) == set()
    beside = np.array([(2.0, 2.0, 0.0), (3.1, 2.0, TURNED), (8.0, 0.6, TURNED), (12.0, 9.0, 0.0)])
    assert touching(beside, *walls_of(ROOM)) == {(0, 1), (2, 4)}


def test_a_robot_that_passes_anothers_height_changes_the_order() -> None:
    judge = Judge(ROOM)
    records = [SimpleNamespace(start=(2.0, 5.0, 0.0)), SimpleNamespace(start=(9.0, 6.0, 0.0))]
    for y in (5.0, 5.9, 6.1):
        judge.each_tick(
            SimpleNamespace(  # type: ignore[arg-type] - all that the judge looks at
                time=y,
                scenery=SimpleNamespace(stage=SimpleNamespace(poses=[(2, y, 0), (9, 6, 0)])),
                context=SimpleNamespace(records=records, spraying={}),
            )
        )
    assert judge.contacts == []
    assert [line.split(":")[0] for line in judge.swaps] == ["6.1 s"]
