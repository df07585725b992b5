"""The rules and the chance they share, as plain functions."""

import ast
import inspect
from importlib import import_module
from itertools import pairwise

import numba
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.dispersal import chance, vocabulary
from controllers.dispersal.rules import DOWN, LEFT, MODULES, RIGHT, RULES, SETTLE, STAY, UP
from gridworld.compiled import RULE_SIGNATURE, RULE_TYPE, compile_rule, draw

SEEN = st.integers(0, 2**48 - 1)


def looks(*blocked: int) -> int:
    """What is seen when these of the eight cells are occupied."""
    return sum(1 << k for k in blocked)


@pytest.mark.parametrize("module", [vocabulary, chance])
def test_the_module_imports_nothing(module):
    tree = ast.parse(inspect.getsource(module))
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]


@pytest.mark.parametrize("name", MODULES)
def test_a_module_of_rules_imports_the_vocabulary_alone(name):
    tree = ast.parse(inspect.getsource(import_module(f"controllers.dispersal.rules.{name}")))
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    assert [getattr(node, "module", None) for node in imports] == [vocabulary.__name__]


@pytest.mark.parametrize("name", RULES)
def test_no_rule_calls_another_function(name):
    tree = ast.parse(inspect.getsource(RULES[name]))
    called = {node.func.id for node in ast.walk(tree) if isinstance(node, ast.Call)}
    assert called <= {"range"}


@pytest.mark.parametrize("name", ["fcdfs", "fcdfs5", "symmetric", "left_hand", "light"])
def test_a_robot_that_is_shut_in_settles(name):
    assert RULES[name](0, 0xFF)[1] == SETTLE


@pytest.mark.parametrize("name", ["fcdfs", "fcdfs5", "left_hand", "light"])
@pytest.mark.parametrize(
    ("blocked", "first"),
    [((), UP), ((UP,), RIGHT), ((UP, RIGHT), DOWN), ((UP, RIGHT, DOWN), LEFT), ((RIGHT,), UP)],
)
def test_the_first_direction_is_the_first_free_one_clockwise_from_up(name, blocked, first):
    state, move = RULES[name](0, looks(*blocked))
    assert move == first
    assert state >> 3 & 3 == first


def test_the_first_direction_of_symmetric_is_chosen_by_the_die_among_the_free():
    chosen = [RULES["symmetric"](0, looks(RIGHT) | die << 32)[1] for die in range(65536)]
    # 65536 = 3 * 21845 + 1: the first of three gets the odd one.
    assert [chosen.count(way) for way in (UP, RIGHT, DOWN, LEFT)] == [21846, 0, 21845, 21845]


@pytest.mark.parametrize("name", ["fcdfs", "fcdfs5", "light"])
def test_a_robot_turns_in_a_hall_and_moves_in_the_same_step(name):
    # Up a corridor that bends to the left: the way up and right blocked, the diagonal too.
    rule = RULES[name]
    corridor = looks(RIGHT, LEFT, 4, 5, 6, 7)
    state, move = rule(0, corridor | looks(DOWN))
    assert move == UP
    state, move = rule(state, corridor)
    assert move == UP
    state, move = rule(state, looks(UP, RIGHT, 4, 5, 6, 7))
    assert move == LEFT
    assert state >> 3 & 3 == LEFT


def test_a_robot_on_the_diagonal_is_no_wall_if_the_robot_came_that_way():
    # Up, then right: the diagonal of the corner at the top right is where the robot was.
    corner = looks(UP, RIGHT, 6)
    for rule in (RULES["fcdfs"], RULES["fcdfs5"]):
        state, _ = rule(0, 0)  # up
        state, _ = rule(state, looks(UP))  # right
        assert rule(state, corner)[1] == SETTLE
        # Two steps up instead: what stands on the diagonal is a wall, and this is a hall.
        state, _ = rule(rule(0, 0)[0], 0)
        assert rule(state, corner)[1] == LEFT


def test_settling_leaves_011_in_the_last_three_of_the_five_bits():
    state, move = RULES["fcdfs5"](RULES["fcdfs5"](0, looks(DOWN))[0], looks(UP, RIGHT, LEFT))
    assert move == SETTLE
    assert state & 0b111 == 0b011


def test_with_a_light_a_robot_waits_for_an_active_one_and_passes_a_settled_one():
    active_above = looks(UP, UP + 8)
    assert RULES["light"](0, active_above) == (0, STAY)
    assert RULES["light"](0, looks(UP))[1] == RIGHT


def test_five_bits_are_enough_for_algorithm_2():
    reached, new = {0}, {0}
    while new:
        new = {RULES["fcdfs5"](state, seen)[0] for state in new for seen in range(256)} - reached
        reached |= new
    assert max(reached) < 32


@pytest.fixture(scope="module")
def call():
    """Calls a compiled rule as the grid step does, from compiled code."""
    signature = RULE_SIGNATURE.return_type(RULE_TYPE, numba.int64, numba.int64)
    return numba.njit(signature)(lambda rule, state, seen: rule(state, seen))


@pytest.mark.parametrize("name", RULES)
@given(seen=SEEN, state=st.integers(0, 31), trail=st.integers(0, 4))
def test_a_compiled_rule_is_the_rule(call, name, seen, state, trail):
    rule = RULES[name]
    seen = seen & ~(7 << 24) | trail << 24
    for _ in range(4):  # on from state to state
        answer = call(compile_rule(rule), state, seen)
        assert answer == rule(state, seen)
        state, seen = answer[0], seen * 5 & ~(7 << 24) & 2**48 - 1


@given(
    seed=st.integers(0, 2**63 - 1),
    robot=st.integers(1, 2**31 - 1),
    step=st.integers(1, 2**31 - 1),
    purpose=st.integers(0, 1),
)
def test_compiled_chance_is_chance(seed, robot, step, purpose):
    assert draw(seed, robot, step, purpose) == chance.draw(seed, robot, step, purpose)


def test_chance_is_what_it_has_always_been():
    # Recorded from this very function: results of seeded runs must not change.
    draws = [chance.draw(1, 2, 3, 0), chance.draw(2**40 + 7, 900, 1799, 1)]
    assert draws == [1645124313, 3340116368]


@pytest.mark.parametrize("q", [0.0, 0.01, 0.3, 0.9])
def test_activations_fail_as_often_as_they_should(q):
    n = 40_000
    failed = sum(not chance.activated(11, k // 200 + 1, k % 200 + 1, q) for k in range(n))
    # Five standard deviations of a binomial count; the seed is fixed, so it cannot flicker.
    assert abs(failed - q * n) <= 5 * (n * q * (1 - q)) ** 0.5


def test_neighbouring_draws_are_not_alike():
    draws = [
        chance.draw(seed, robot, step, purpose) >> 31
        for seed in range(10)
        for robot in range(1, 11)
        for step in range(1, 51)
        for purpose in range(2)
    ]
    changes = sum(a != b for a, b in pairwise(draws))
    # 10,000 fair bits: five standard deviations (of 50) from half.
    assert abs(sum(draws) - 5000) < 250
    assert abs(changes - 5000) < 250
