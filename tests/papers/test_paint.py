"""The paper's observations 1 to 5 and its result, over the compute step alone.

Robots are points in exact positions, of either orientation, with exact ties, and see everything;
they are activated one at a time in any order and may be stopped anywhere on their way.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.paint.compute import (
    Act,
    Case,
    Decision,
    Other,
    Task,
    decide,
    rank_among,
    side_of,
    strip_of,
    tie_case,
)
from controllers.paint.constants import EPSILON, INSET
from controllers.paint.geometry import rectangle
from controllers.paint.task import task_of

WIDTH, HEIGHT = 16.0, 21.0
STEPS = 64  # positions are multiples of 1/64 m: sums and differences are exact, ties are ties


@dataclass
class Swarm:
    """Robots at (x, y) in the world; `signs` is 1 for P, -1 for N (axes turned by 180 degrees)."""

    places: list[tuple[float, float]]
    signs: list[int]

    def seen_by(self, i: int, j: int) -> tuple[float, float]:
        """Where robot j is in the axes of robot i, whose origin is the arena's centre."""
        x, y = self.places[j]
        return self.signs[i] * (x - WIDTH / 2), self.signs[i] * (y - HEIGHT / 2)

    def others(self, i: int, around: int, scale: float = 1.0) -> list[Other]:
        """All robots but `around`, as robot i compares them with that one."""
        y = self.seen_by(i, around)[1]
        found = []
        for j in range(len(self.places)):
            if j != around:
                ox, oy = self.seen_by(i, j)
                side = side_of(y, oy)
                found.append(Other(scale * ox, scale * oy, side, scale * EPSILON, scale * EPSILON))
        return found

    def rank(self, i: int, j: int) -> int:
        """The rank of robot j as robot i computes it."""
        return rank_among(self.seen_by(i, j)[0], self.others(i, j))

    def task(self, i: int) -> Task:
        """What robot i has to do, in its own axes."""
        region = rectangle(WIDTH, HEIGHT).moved(-rectangle(WIDTH, HEIGHT).corners[2] / 2)
        task = task_of(region, self.rank(i, i), len(self.places), 1.5)
        return Task(task.strip, task.goal, EPSILON - 0.05, 0.0, task.reached)

    def decide(self, i: int, task: Task) -> Decision:
        """The compute step of robot i."""
        return decide(*self.seen_by(i, i), task, self.others(i, i))

    def order(self) -> list[int]:
        """The robots from the lowest up, in the world."""
        return sorted(range(len(self.places)), key=lambda i: self.places[i][::-1])


@st.composite
def swarms(draw: Any, most: int = 19, apart: float = 1.5) -> Swarm:
    """2 to 19 robots, any orientation, often on one height, bodies apart and off the walls."""
    count = draw(st.integers(2, most))
    rows = draw(st.lists(st.integers(STEPS, 20 * STEPS), min_size=1, max_size=count))
    places: list[tuple[float, float]] = []
    while len(places) < count:
        x = draw(st.integers(STEPS, 15 * STEPS)) / STEPS
        level = draw(st.booleans())
        y = draw(st.sampled_from(rows) if level else st.integers(STEPS, 20 * STEPS)) / STEPS
        # a place that is taken moves on over the arena until it is free: draws are never wasted
        for _ in range(400):
            if all(max(abs(x - a), abs(y - b)) >= apart for a, b in places):
                places.append((x, y))
                break
            x += 0.75
            if x > WIDTH - 1.0:
                x, y = 1.0 + x % 0.25, y + 0.75
                y = y if y <= HEIGHT - 1.0 else 1.0 + y % 0.25
        else:
            break  # as many as fit
    return Swarm(places, [draw(st.sampled_from((1, -1))) for _ in places])


def goal_in_world(swarm: Swarm, i: int, task: Task) -> tuple[float, float]:
    x, y = task.goal
    return swarm.signs[i] * x + WIDTH / 2, swarm.signs[i] * y + HEIGHT / 2


@given(swarms())
def test_observation_1_all_compute_the_same_ranks_up_to_a_reversal(swarm: Swarm) -> None:
    count = len(swarm.places)
    for j in range(count):
        for i in range(count):
            same = swarm.rank(j, j) if swarm.signs[i] == swarm.signs[j] else None
            turned = count + 1 - swarm.rank(j, j)
            assert swarm.rank(i, j) == (turned if same is None else same)


@given(swarms())
def test_observation_2_no_two_robots_share_a_strip(swarm: Swarm) -> None:
    count = len(swarm.places)
    for place, i in enumerate(swarm.order()):
        low, high = strip_of(swarm.rank(i, i), count, -HEIGHT / 2, HEIGHT / 2)
        ends = sorted(swarm.signs[i] * y + HEIGHT / 2 for y in (low, high))
        wanted = [place * HEIGHT / count, (place + 1) * HEIGHT / count]
        assert ends == pytest.approx(wanted, abs=1e-9)  # rounding of 21/N


@given(swarms())
def test_goals_are_in_the_corner_of_the_own_axes_moved_inwards_by_the_inset(swarm: Swarm) -> None:
    count = len(swarm.places)
    for place, i in enumerate(swarm.order()):
        low, high = place * HEIGHT / count, (place + 1) * HEIGHT / count
        # 19 strips are so low that goals INSET inside would be nearer than EPSILON: half a strip.
        inset = INSET if count < 19 else HEIGHT / count / 2
        lower_left, upper_right = (INSET, low + inset), (WIDTH - INSET, high - inset)
        goal = goal_in_world(swarm, i, swarm.task(i))
        assert goal == pytest.approx(lower_left if swarm.signs[i] == 1 else upper_right, abs=1e-9)


@given(st.sampled_from((True, False)), st.sampled_from((True, False)))
def test_observation_4_of_two_level_robots_on_one_way_exactly_one_goes_first(
    upwards: bool, turned: bool
) -> None:
    higher, lower = tie_case(True, upwards), tie_case(False, upwards)
    first = {Case.A, Case.B}
    assert (higher in first) != (lower in first)
    # A robot with turned axes sees itself lower and its way down: it decides the same.
    if turned:
        assert (tie_case(False, not upwards) in first) == (higher in first)


@given(swarms())
def test_observation_4_level_robots_never_wait_for_each_other(swarm: Swarm) -> None:
    waiting = {}
    for i in range(len(swarm.places)):
        decision = swarm.decide(i, swarm.task(i))
        if decision.act is Act.WAIT and decision.case is not None and decision.waits_for:
            seen = (decision.waits_for.x, decision.waits_for.y)
            waiting[i] = next(j for j in range(len(swarm.places)) if swarm.seen_by(i, j) == seen)
    for i, j in waiting.items():
        assert waiting.get(j) != i


SCALES = st.one_of(st.integers(1, 1000).map(float), st.integers(-20, 20).map(lambda k: 2.0**k))


@given(swarms(), SCALES)
def test_a_scale_of_its_own_changes_no_decision_of_a_robot(swarm: Swarm, scale: float) -> None:
    for i in range(len(swarm.places)):
        task = swarm.task(i)
        x, y = swarm.seen_by(i, i)
        own = decide(x, y, task, swarm.others(i, i))
        scaled = decide(
            scale * x,
            scale * y,
            Task(
                (scale * task.strip[0], scale * task.strip[1]),
                (scale * task.goal[0], scale * task.goal[1]),
                scale * task.clearance,
                scale * task.margin,
                scale * task.reached,
            ),
            swarm.others(i, i, scale),
        )
        assert (scaled.act, scaled.case) == (own.act, own.case)
        assert scaled.target == pytest.approx([scale * v for v in own.target])


def advance(swarm: Swarm, i: int, decision: Decision, share: float) -> None:
    """Robot i goes a share of the way that it decided on."""
    x, y = swarm.seen_by(i, i)
    tx, ty = decision.target
    nx, ny = (tx, ty) if share == 1.0 else (x + share * (tx - x), y + share * (ty - y))
    swarm.places[i] = swarm.signs[i] * nx + WIDTH / 2, swarm.signs[i] * ny + HEIGHT / 2


@settings(max_examples=60)
@given(swarms(), st.randoms(use_true_random=False))
def test_observations_3_and_5_and_the_result_with_asynchronous_activation(
    swarm: Swarm, chance: Any
) -> None:
    """Nobody collides, the order stays, and all get to paint, whoever is activated when."""
    run_to_the_end(swarm, chance)


@pytest.mark.parametrize("count", [16, 17, 18, 19])
@pytest.mark.parametrize("seed", range(3))
def test_as_many_as_have_room_all_get_to_paint(count: int, seed: int) -> None:
    chance = random.Random(100 * count + seed)
    heights = [1.05 * k + 0.6 for k in range(count)]  # bodies clear of each other, on 21 m
    places = [(chance.uniform(0.6, 15.4), y) for y in heights]
    swarm = Swarm(places, [chance.choice((1, -1)) for _ in places])
    run_to_the_end(swarm, chance)


@given(swarms(), st.data())
def test_nobody_paints_a_strip_that_another_robot_is_in(swarm: Swarm, data: Any) -> None:
    i = data.draw(st.integers(0, len(swarm.places) - 1))
    task = swarm.task(i)
    at_goal = task.goal
    free = decide(*at_goal, task, [])
    assert free.act is Act.PAINT
    low, high = task.strip
    x = data.draw(st.floats(-WIDTH / 2, WIDTH / 2))
    y = data.draw(st.floats(low, high, exclude_min=True, exclude_max=True))
    other = Other(x, y, side_of(at_goal[1], y), EPSILON, EPSILON)
    taken = decide(*at_goal, task, [other])
    assert (taken.act, taken.waits_for) == (Act.WAIT, other)
    beyond = Other(x, high + 0.01, side_of(at_goal[1], high + 0.01), EPSILON, EPSILON)
    assert decide(*at_goal, task, [beyond]).act is Act.PAINT


@settings(max_examples=40)
@given(swarms(), st.randoms(use_true_random=False))
def test_the_same_with_looks_that_are_old_by_the_time_they_are_acted_on(
    swarm: Swarm, chance: Any
) -> None:
    """Between its look and its move, or in the middle of it, others look and move."""
    run_to_the_end(swarm, chance, late=True)


def run_to_the_end(swarm: Swarm, chance: Any, late: bool = False) -> None:
    """Activate robots one at a time until all paint, and judge every step.

    `late`: a robot looks and decides in one activation, and acts on that in later ones.
    """
    decided: dict[int, Decision] = {}
    count = len(swarm.places)
    order = swarm.order()
    tasks = [swarm.task(i) for i in range(count)]
    painting: set[int] = set()
    # A leg takes at most 8 stops; the longest chain of robots that wait for each other is N.
    for _ in range((200 if late else 100) * count):
        for i in chance.sample(range(count), count):
            if i in painting:
                continue
            decision = decided.get(i) or swarm.decide(i, tasks[i])
            if decision.act is Act.PAINT:
                painting.add(i)
                continue
            if decision.act is Act.WAIT:
                continue
            if late and i not in decided:
                decided[i] = decision
                continue
            share = chance.choice((0.25, 0.5, 1.0, 1.0))
            advance(swarm, i, decision, share)
            if share == 1.0 or chance.random() < 0.5:
                decided.pop(i, None)
            x, y = swarm.places[i]
            near = [max(abs(x - a), abs(y - b)) for j, (a, b) in enumerate(swarm.places) if j != i]
            assert min(near) >= 1.0 - 1e-9  # rounding of 21/N
            heights = [swarm.places[k][1] for k in order]
            assert all(a <= b + 1e-9 for a, b in pairwise(heights))
        if len(painting) == count:
            break
    assert len(painting) == count
    for i in range(count):
        goal = goal_in_world(swarm, i, tasks[i])
        assert swarm.places[i] == pytest.approx(goal, abs=0.021)  # reached at REACHED, 0.02
