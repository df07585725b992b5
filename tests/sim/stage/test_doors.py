"""Doors: step n ends at n periods, and who enters then depends on how step n began."""

from __future__ import annotations

from typing import Any

import pytest
from stage_worlds import robot, world

from sim.stage.doors import Doors
from sim.stage.layout import Layout, build_layout
from sim.stage.stage import Stage

DOOR = {"name": "s", "at": (5.0, 5.0), "model": "a", "period": 1.0}
TICKS = 10
"""Ticks of 0.1 s in a step of 1 s."""


def set_up(tmp_path: Any, **keys: Any) -> tuple[Layout, Stage, Doors]:
    made = world(**{"doors": [DOOR], "models": {"a": robot()}, **keys})
    layout = build_layout(made, tmp_path)
    doors = Doors(layout, made.models, made.clock.interval)
    return layout, Stage(layout, made.models, made.clock), doors


def enter(layout: Layout, stage: Stage, doors: Doors) -> list[int]:
    """What happens at the doors after a tick: robots enter, and then a step may begin."""
    entering = doors.advance()
    for door in entering:
        cell = layout.doors[door]
        stage.add_robot(cell.model, (*cell.centre, cell.heading))
    doors.begin(stage)
    return entering


def test_where_nobody_lingers_robots_enter_at_odd_steps(tmp_path: Any) -> None:
    layout, stage, doors = set_up(tmp_path)
    doors.begin(stage)
    entries = []
    for tick in range(1, 8 * TICKS + 1):
        # Within a step, whoever stands in the cell moves on to a place of its own.
        if tick % TICKS == 5:
            for number in range(stage.count):
                stage.set_pose(number, (1.0 + number, 1.0, 0.0))
        stage.tick()
        if enter(layout, stage, doors):
            entries.append(tick)
    assert entries == [1 * TICKS, 3 * TICKS, 5 * TICKS, 7 * TICKS]
    assert doors.steps == [[1, 3, 5, 7]]


def test_a_robot_that_stays_in_the_cell_keeps_the_door_shut(tmp_path: Any) -> None:
    layout, stage, doors = set_up(tmp_path)
    doors.begin(stage)
    for _ in range(6 * TICKS):
        stage.tick()
        enter(layout, stage, doors)
    assert doors.steps == [[1]]
    assert doors.filled(stage, [0])
    assert not doors.filled(stage, [])


@pytest.mark.parametrize(("stands_there", "steps"), [(False, [1]), (True, [])])
def test_the_cell_must_be_free_when_the_step_begins_not_when_it_ends(
    tmp_path: Any, stands_there: bool, steps: list[int]
) -> None:
    _, stage, doors = set_up(tmp_path)
    there, away = (5.2, 5.0, 0.0), (2.0, 2.0, 0.0)
    stage.add_robot("a", there if stands_there else away)
    doors.begin(stage)
    for tick in range(1, 2 * TICKS):
        if tick == TICKS // 2:  # within step 1 it leaves, or comes
            stage.set_pose(0, away if stands_there else there)
        stage.tick()
        doors.advance()
        doors.begin(stage)
    assert doors.steps == [steps]


def test_a_pushed_obstacle_in_the_cell_counts_and_a_touch_does_not(tmp_path: Any) -> None:
    box = {"shape": "box", "size": (1.0, 1.0), "movable": True}
    for x, free in [(5.7, False), (5.75, True)]:
        layout, stage, doors = set_up(tmp_path, obstacles=[{**box, "pose": (x, 5.0, 0)}])
        doors.begin(stage)
        for _ in range(TICKS):
            stage.tick()
            doors.advance()
        assert (doors.steps == [[1]]) == free
        assert layout.doors[0].size == pytest.approx((0.5, 0.4))


def test_doors_keep_their_own_time(tmp_path: Any) -> None:
    pair = [DOOR, {**DOOR, "name": "t", "at": (8.0, 8.0), "period": 0.4}]
    layout, stage, doors = set_up(tmp_path, doors=pair)
    doors.begin(stage)
    found = []
    for tick in range(1, TICKS + 1):
        stage.tick()
        found += [(tick, door) for door in enter(layout, stage, doors)]
    assert found == [(4, 1), (10, 0)]
