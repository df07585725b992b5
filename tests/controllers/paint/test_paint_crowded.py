"""One robot of known rank in a tight place, beside others that only stand there."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from controllers.paint.acts.turning import turning
from controllers.paint.brain import Brain, Command, Reading, Settings
from controllers.paint.constants import SPRAYER
from controllers.paint.geometry import rectangle
from controllers.paint.memory import Phase
from controllers.paint.moves import look
from controllers.paint.moves.twist import looks_at
from controllers.paint.observe import observe
from controllers.paint.task import task_of
from troupe.testing.paint import bench
from troupe.testing.paint.bench import run

ROOM = rectangle(16.0, 21.0)
CORNERS = np.array([(0.0, 0.0), (16.0, 0.0), (16.0, 21.0), (0.0, 21.0)])


@pytest.mark.parametrize(("robots", "rank"), [(16, 1), (16, 16), (18, 1), (19, 1), (19, 19)])
def test_at_a_goal_along_a_wall_it_backs_off_turns_and_paints(robots: int, rank: int) -> None:
    goal = task_of(ROOM, rank, robots, SPRAYER[1]).goal
    neighbour = task_of(ROOM, 2 if rank == 1 else robots - 1, robots, SPRAYER[1]).goal
    start = (5.0, min(max(goal[1], 0.75), 20.25), 0.0)
    outcome = run(
        np.array([start, (*neighbour, 0.0)]),
        lambda i: Settings(robots),
        CORNERS,
        duration=300.0,
        ranks=[rank],
    )
    assert outcome.contacts == 0
    assert outcome.reports[0]["done_time"] > outcome.reports[0]["paint_time"]
    assert outcome.failures[0] == f"I never saw more than 2 of the {robots} robots; told wrong?"


@pytest.mark.parametrize("seed", range(3))
def test_who_was_held_up_and_made_room_goes_on_once_its_way_is_free(seed: int) -> None:
    goal = task_of(ROOM, 5, 16, SPRAYER[1]).goal

    def leave(time: float, poses: NDArray[np.float64]) -> None:
        if time > 40.0:
            poses[1, 0] = 14.0

    outcome = run(
        np.array([(8.0, goal[1], 0.0), (1.5, goal[1] - 1.2, 0.0)]),
        lambda i: Settings(16, paint=False),
        CORNERS,
        duration=200.0,
        seed=seed,
        ranks=[5],
        each_tick=leave,
    )
    assert outcome.finished == [True, True]
    assert outcome.contacts == 0
    assert outcome.reports[0]["goal_time"] > 40.0
    assert math.dist(outcome.poses[0, :2], goal) < 0.02


def test_nobody_backs_to_its_goal_past_a_robot_that_may_turn_beside_it() -> None:
    goal = task_of(ROOM, 4, 12, SPRAYER[1]).goal
    nearest = math.inf

    def stand_and_leave(time: float, poses: NDArray[np.float64]) -> None:
        nonlocal nearest
        if time < 60.0:  # much longer than a robot out of view is followed
            nearest = min(nearest, poses[0, 0] - poses[1, 0])
            poses[1, 2] = 0.0 if time < 30.0 else math.pi / 4
        else:
            poses[1] = 0.6, 12.0, 0.0

    outcome = run(
        np.array([(6.3, goal[1], 0.0), (0.96, goal[1] + 1.13, 0.0)]),
        lambda i: Settings(12, paint=False),
        CORNERS,
        duration=150.0,
        ranks=[4],
        each_tick=stand_and_leave,
    )
    assert nearest > 1.2
    assert outcome.contacts == 0
    assert outcome.finished[0]
    assert outcome.reports[0]["goal_time"] > 60.0


@pytest.mark.parametrize("above", [0.148, 1.0, 3.0])
def test_who_steps_aside_on_its_way_to_its_row_ends_the_step_before_it_decides_anew(
    above: float,
) -> None:
    goal = task_of(ROOM, 4, 8, SPRAYER[1]).goal
    outcome = run(
        np.array([(14.9, goal[1] + above, 0.0), (15.4, goal[1] - 1.2, math.pi)]),
        lambda i: Settings(8, paint=False),
        CORNERS,
        duration=200.0,
        ranks=[4],
    )
    assert outcome.contacts == 0
    assert outcome.finished[0]
    assert math.dist(outcome.poses[0, :2], goal) < 0.02


@pytest.mark.parametrize("seed", range(2))
def test_who_waits_for_long_for_a_nearly_level_robot_leaves_its_row(seed: int) -> None:
    heights: list[float] = []

    def leave(time: float, poses: NDArray[np.float64]) -> None:
        heights.append(float(poses[0, 1]))
        if time > 150.0:
            poses[1] = 0.6, 5.0, 0.0

    outcome = run(
        np.array([(8.0, 11.884, 0.0), (2.0, 11.8, 0.0), (14.0, 12.875, 0.0)]),
        lambda i: Settings(3, paint=False),
        CORNERS,
        duration=220.0,
        seed=seed,
        ranks=[2],
        each_tick=leave,
    )
    assert heights[900] == pytest.approx(11.884, abs=0.03)  # after 90 s
    assert 12.3 < heights[1490] < 12.575  # out of the one's row, and not to the other's
    assert outcome.contacts == outcome.swaps == 0
    assert outcome.finished[0]


@pytest.mark.parametrize("seed", range(2))
def test_on_a_row_along_a_wall_a_robot_turns_round_and_makes_room(seed: int) -> None:
    ways: list[float] = []

    def leave(time: float, poses: NDArray[np.float64]) -> None:
        ways.append(float(poses[0, 0]))
        if time > 250.0:
            poses[1] = 0.6, 2.35, 0.0

    outcome = run(
        np.array([(9.6, 1.2, 0.0), (3.0, 1.455, 0.0)]),
        lambda i: Settings(12, paint=False),
        CORNERS,
        duration=300.0,
        seed=seed,
        ranks=[1],
        each_tick=leave,
    )
    assert max(ways[1100:2500]) > min(ways[:1000]) + 1.0
    assert outcome.contacts == outcome.swaps == 0
    assert outcome.finished[0]


def test_nobody_leaves_its_row_towards_one_that_backs_to_its_goal_without_looking() -> None:
    row = task_of(ROOM, 8, 8, SPRAYER[1]).goal[1]

    def hold(time: float, poses: NDArray[np.float64]) -> None:
        if time < 91.0:  # it turns round before its goal when the other has waited 100 s
            poses[1, :2] = 8.0, row

    outcome = run(
        np.array([(1.2, row - 1.27, 0.0), (8.0, row, 0.0), (4.0, row - 1.3, 0.0)]),
        lambda i: Settings(8, paint=False),
        CORNERS,
        duration=112.0,
        ranks=[7, 8],
        each_tick=hold,
    )
    assert outcome.contacts == 0
    assert outcome.finished[1]


def test_in_low_strips_nobody_goes_off_a_wall_to_turn_beside_the_next_row() -> None:
    heights: list[float] = []
    outcome = run(
        np.array([(9.6, 1.2, 0.0), (3.0, 1.383, 0.0), (15.0, 1.767, 0.0)]),
        lambda i: Settings(18, paint=False),
        CORNERS,
        duration=200.0,
        ranks=[1],
        each_tick=lambda time, poses: heights.append(float(poses[0, 1])),
    )
    assert max(heights[1000:]) < 0.62
    assert outcome.contacts == 0


@pytest.mark.parametrize("seed", range(8))
def test_of_two_that_have_to_turn_beside_each_other_one_waits_for_the_other(
    monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    def turns(brain: Brain, reading: Reading) -> Command:
        observe(brain, reading)
        brain.memory.phase, brain.memory.nearer_at = Phase.GOING, -math.inf
        command = Command()
        turning(brain, command, look.UP)
        command.finished = looks_at(brain.pose, look.UP)
        return command

    monkeypatch.setattr(bench, "step", turns)
    outcome = run(
        np.array([(8.0, 8.0, 0.0), (8.3, 9.25, math.pi)]),
        lambda i: Settings(4),
        CORNERS,
        duration=120.0,
        seed=seed,
    )
    assert outcome.finished == [True, True]
    assert outcome.contacts == 0


def test_at_its_goal_it_paints_once_the_robot_in_its_strip_has_left() -> None:
    def leave(time: float, poses: NDArray[np.float64]) -> None:
        if time > 40.0:
            poses[1, 1] = 17.0

    outcome = run(
        np.array([(4.0, 3.0, 0.0), (12.0, 9.0, 0.0)]),
        lambda i: Settings(2),
        CORNERS,
        duration=60.0,
        ranks=[1],
        each_tick=leave,
    )
    said = [text for _, text in outcome.said[0]]
    assert "waiting: a robot is in my strip at height 6.0" in said  # of its own start
    assert 40.0 < outcome.reports[0]["paint_time"] < 60.0
