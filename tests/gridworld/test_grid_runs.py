"""The grid model: what it reports, what it notices, and that it agrees with a plain one."""

import numpy as np
import pytest
from dispersal_model import walk

from controllers.dispersal import rules
from gridworld.generators import KINDS, random_region, ring
from gridworld.grid import GridRun, simulate
from gridworld.regions import Region, RegionError, parse, rectangle
from gridworld.topology import FAR, distances

SILENT = ["fcdfs", "fcdfs5", "symmetric", "left_hand", "light"]


@pytest.mark.parametrize("name", SILENT)
@pytest.mark.parametrize("kind", KINDS)
def test_the_compiled_model_agrees_with_a_plain_one_robot_by_robot(name, kind):
    q = 0.2 if name == "light" else 0.0
    region = random_region(kind, np.random.default_rng(len(name + kind)), 8)
    outcome = simulate(region, name, seed=5, q=q, paths=True)
    plain = walk(region, rules.RULES[name], seed=5, q=q)
    assert outcome.entered.tolist() == [robot["entered"] for robot in plain]
    assert outcome.settled.tolist() == [robot["settled"] for robot in plain]
    assert outcome.state.tolist() == [robot["state"] for robot in plain]
    # The plain path has a cell for each step that began active, and one for the entry; the step
    # of settling adds the same cell again in the compiled one's.
    for path, robot in zip(outcome.paths, plain, strict=True):
        assert [tuple(cell) for cell in path.tolist()] == [*robot["path"], robot["path"][-1]]


def test_robot_k_enters_at_the_end_of_step_2k_minus_1():
    outcome = simulate(rectangle(5, 4, [(2, 1)]))
    assert outcome.entered.tolist() == [2 * k - 1 for k in range(1, 21)]
    assert outcome.makespan == outcome.entered[-1] == 2 * 20 - 1


def test_one_cell_is_filled_in_one_step_and_settled_in_two():
    outcome = simulate(parse("S"))
    assert (outcome.makespan, outcome.steps, outcome.travel.tolist()) == (1, 2, [0])


def test_neither_the_entry_nor_settling_counts_as_travel():
    # A corridor of three from its end: the first robot moves twice and settles in the third step.
    outcome = simulate(parse("S.."))
    assert outcome.travel.tolist() == [2, 1, 0]
    assert outcome.settled.tolist() == [4, 5, 6]
    assert outcome.cell.tolist() == [[2, 0], [1, 0], [0, 0]]
    assert outcome.moves.tolist() == outcome.travel.tolist()


def test_paths_begin_at_the_door_and_end_where_the_robot_stands():
    outcome = simulate(rectangle(6, 5, [(1, 3)]), paths=True)
    for robot, path in enumerate(outcome.paths):
        assert path[0].tolist() == [1, 3]
        assert path[-1].tolist() == outcome.cell[robot].tolist()
        assert len(path) == outcome.settled[robot] - outcome.entered[robot] + 1
        steps = np.abs(np.diff(path, axis=0)).sum(axis=1)
        assert steps.sum() == outcome.moves[robot]


def test_a_ring_ends_in_a_collision_at_the_door_where_conflicts_stop():
    outcome = simulate(ring(8, 8).with_doors([(0, 4)]))
    assert (outcome.outcome, outcome.collisions, outcome.where) == ("collision", 1, (0, 4))
    assert not outcome.covered
    assert outcome.makespan is None


def test_a_ring_is_sealed_by_robots_that_circle_where_losers_stay():
    outcome = simulate(ring(8, 8).with_doors([(0, 4)]), conflict="stay")
    assert (outcome.outcome, outcome.collisions) == ("circling", 0)
    assert (outcome.settled == 0).all()
    assert len(outcome.entered) == outcome.cells // 2


def always_right(state, seen):
    return state, rules.RIGHT


def never_moves(state, seen):
    return state, rules.STAY


def settles_at_once(state, seen):
    return state, rules.SETTLE


def right_then_back(state, seen):
    return 1, rules.LEFT if seen >> rules.RIGHT & 1 or state else rules.RIGHT


def test_a_move_into_a_wall_is_noticed():
    outcome = simulate(rectangle(4, 1, [(0, 0)]), always_right)
    assert (outcome.outcome, outcome.where, outcome.steps) == ("left_region", (4, 0), 5)


def test_a_move_into_a_robot_is_noticed():
    outcome = simulate(rectangle(5, 1, [(1, 0)]), right_then_back)
    assert outcome.outcome == "collision"
    assert outcome.collisions == 1


def test_two_robots_that_want_one_cell_collide():
    def towards_the_middle(state, seen):
        return state, rules.LEFT if seen >> rules.RIGHT & 1 else rules.RIGHT

    region = rectangle(3, 1, [(0, 0), (2, 0)])
    outcome = simulate(region, towards_the_middle)
    assert (outcome.outcome, outcome.where, outcome.collisions) == ("collision", (1, 0), 1)
    outcome = simulate(region, towards_the_middle, conflict="stay", max_steps=2)
    assert outcome.cell.tolist()[:2] == [[1, 0], [2, 0]]  # the first to enter has got it


def test_a_door_that_is_shut_for_good_ends_the_run():
    outcome = simulate(rectangle(2, 2, [(0, 0)]), settles_at_once)
    assert (outcome.outcome, len(outcome.entered)) == ("stuck", 1)


def test_robots_that_wait_for_ever_end_the_run():
    outcome = simulate(rectangle(2, 2, [(0, 0)]), never_moves)
    assert outcome.outcome == "circling"
    outcome = simulate(parse("SS"), never_moves)  # covered, but nobody settles
    assert (outcome.outcome, outcome.covered) == ("circling", True)


def test_a_run_can_be_cut_short():
    outcome = simulate(rectangle(9, 9, [(4, 4)]), max_steps=50)
    assert (outcome.outcome, outcome.steps, len(outcome.entered)) == ("step_limit", 50, 25)
    assert (
        outcome.travel[outcome.settled == 0] == 50 - outcome.entered[outcome.settled == 0]
    ).all()


def test_step_by_step_is_the_same_as_all_at_once():
    region = random_region("rooms", np.random.default_rng(3), 14)
    run = GridRun(region, "fcdfs5")
    while run.advance():
        pass
    one, other = run.outcome(), simulate(region, "fcdfs5")
    assert one.figures() == other.figures()
    assert (one.settled == other.settled).all()


@pytest.mark.parametrize("name", ["symmetric", "dflf", "bflf"])
def test_the_seed_decides_all_chance(name):
    region = rectangle(8, 8, [(3, 3)])
    one, two, other = (simulate(region, name, seed=seed) for seed in (1, 1, 2))
    assert (one.cell == two.cell).all()
    assert (one.cell != other.cell).any()


@pytest.mark.parametrize("name", ["dflf", "bflf"])
@pytest.mark.parametrize("q", [0.0, 0.2])
def test_leader_follower_rules_cover_any_connected_region(name, q):
    for seed in range(20):
        free = np.random.default_rng(seed).random((9, 9)) < 0.75
        free[4, 4] = True
        connected = distances(free, [(4, 4)]) != FAR
        outcome = simulate(Region(connected, ((4, 4),)), name, seed=seed, q=q)
        assert outcome.all_settled
        assert outcome.collisions == 0


@pytest.mark.parametrize("kind", KINDS)
def test_a_settled_robot_that_keeps_executing_algorithm_2_never_moves(kind):
    region = random_region(kind, np.random.default_rng(8), 7)
    assert len(walk(region, rules.RULES["fcdfs5"], settled_go_on=True)) == region.cells


def test_robots_come_in_through_several_doors():
    outcome = simulate(rectangle(7, 7, [(0, 0), (6, 6)]), conflict="stay")
    assert set(outcome.door.tolist()) == {0, 1}
    assert outcome.entered[:2].tolist() == [1, 1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"q": 1.0}, "q is 1.0"),
        ({"q": -0.1}, "q is -0.1"),
        ({"seed": -1}, "seed"),
        ({"conflict": "fight"}, "conflict is 'fight'"),
        ({"rule": "dfs"}, "there is no rule 'dfs'"),
    ],
)
def test_bad_arguments_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        simulate(rectangle(2, 2, [(0, 0)]), **arguments)


def test_a_region_without_a_door_is_refused():
    with pytest.raises(RegionError, match="no door"):
        simulate(rectangle(2, 2))
