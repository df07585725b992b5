"""The claims of the FCDFS paper (AAMAS 2019), and of what it leaves open, on the grid."""

import inspect
from functools import cache
from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from controllers.dispersal.rules import DICE, RULES, SENSES
from gridworld import studies
from gridworld.generators import KINDS, comb, polyominoes, random_region, ring
from gridworld.grid import simulate
from gridworld.median import sums_of_distances
from gridworld.regions import Region, rectangle
from gridworld.topology import FAR, distances, first_hole

OPTIMAL = ["fcdfs", "fcdfs5", "symmetric", "left_hand"]
"""The rules of which the paper says that makespan and travel are the least possible."""


def is_optimal(outcome):
    """Makespan 2V - 1, every robot on a shortest path without a stop, everything covered."""
    return (
        outcome.all_settled
        and outcome.collisions == 0
        and outcome.makespan == 2 * outcome.cells - 1
        and outcome.travel.sum() == outcome.sum_of_distances
        and outcome.travel.max() == outcome.max_distance
        and (outcome.travel == outcome.moves).all()
    )


def moves_alike(one, other):
    return (one.settled == other.settled).all() and (one.cell == other.cell).all()


@cache
def random_regions(count, smallest=3, largest=20):
    """`count` regions of every kind, of all sizes, with a door at random."""
    return [
        random_region(
            kind, np.random.default_rng([seed, k]), smallest + seed % (largest - smallest + 1)
        )
        for k, kind in enumerate(KINDS)
        for seed in range(count)
    ]


def doors_of(free):
    return [(int(column), int(row)) for row, column in np.argwhere(free)]


# Propositions 3.5, 3.8, 3.9, and section 3.2.


@pytest.mark.parametrize("cells", range(1, 8))
def test_all_small_polyominoes_are_covered_optimally_from_every_door(cells):
    for free in polyominoes(cells):
        if first_hole(free)[0] is not None:
            continue
        for door in doors_of(free):
            region = Region(free, (door,))
            outcomes = [simulate(region, name, seed=cells) for name in OPTIMAL]
            assert all(map(is_optimal, outcomes)), region.to_text()
            assert moves_alike(*outcomes[:2])


def test_random_regions_are_covered_optimally():
    for seed, region in enumerate(random_regions(60)):
        outcomes = [simulate(region, name, seed=seed) for name in OPTIMAL]
        assert all(map(is_optimal, outcomes)), region.to_text()
        assert moves_alike(*outcomes[:2])


def test_large_regions_of_thousands_of_cells_are_covered_optimally():
    rng = np.random.default_rng(1)
    for region in (random_region("maze", rng, 60), random_region("rooms", rng, 150)):
        assert region.cells > 1500
        outcomes = [simulate(region, name) for name in OPTIMAL[:2]]
        assert all(map(is_optimal, outcomes))
        assert moves_alike(*outcomes)


def test_every_small_polyomino_with_a_hole_ends_in_a_collision():
    tried = 0
    for cells in (8, 9):  # eight are the fewest around a hole
        for free in polyominoes(cells):
            if first_hole(free)[0] is None:
                continue
            for door in doors_of(free):
                assert simulate(Region(free, (door,))).outcome == "collision"
                tried += 1
    assert tried > 100


@pytest.mark.parametrize("name", OPTIMAL)
def test_every_robot_is_on_a_shortest_path_at_every_step(name):
    """Proposition 3.5."""
    for region in random_regions(4, 6, 14):
        distance = distances(region.free, region.doors)
        outcome = simulate(region, name, paths=True)
        for path in outcome.paths:
            gone = distance[path[:, 1], path[:, 0]]
            assert gone[:-1].tolist() == list(range(len(path) - 1))
            assert gone[-1] == gone[-2]  # the step of settling


def test_robots_follow_their_predecessor():
    """Lemma 3.7: next(A[i+1]) = prev(A[i]) while A[i] is active, so the paths coincide so far."""
    for region in random_regions(8, 4, 16):
        outcome = simulate(region, paths=True)
        for i, path in enumerate(outcome.paths[:-1]):
            active = int(outcome.travel[i])
            assert outcome.paths[i + 1][:active].tolist() == path[:active].tolist()


@pytest.mark.parametrize("name", OPTIMAL)
def test_active_robots_keep_twice_their_difference_in_rank_apart(name):
    """Corollary 3.6, for distances in the region."""
    for region in random_regions(2, 5, 11):
        between = {
            door: distances(region.free, [door]) for door in doors_of(region.free)
        }  # from any cell to any other
        outcome = simulate(region, name, paths=True)
        entered, settled = outcome.entered, outcome.settled
        for step in range(1, outcome.steps + 1):
            active = np.flatnonzero((entered < step) & (settled >= step))
            for i, j in combinations(active.tolist(), 2):
                a = outcome.paths[i][step - 1 - entered[i]]
                b = outcome.paths[j][step - 1 - entered[j]]
                assert between[tuple(a.tolist())][b[1], b[0]] >= 2 * (j - i)


# Lemmas 3.3 and 3.4, by an independent judge.


def graph_of(region):
    cells = doors_of(region.free)
    graph = nx.Graph()
    graph.add_nodes_from(cells)
    graph.add_edges_from(
        (cell, other)
        for cell in cells
        for other in ((cell[0] + 1, cell[1]), (cell[0], cell[1] + 1))
        if other in graph
    )
    return graph


def corners_and_halls(graph):
    """Definitions 3.1 and 3.2, as they are written."""
    corners, halls = [], []
    for v in graph:
        neighbours = sorted(graph[v])
        if len(neighbours) <= 1:
            corners.append(v)
        elif len(neighbours) == 2:
            u, w = neighbours
            if u[0] != w[0] and u[1] != w[1]:  # not in one line
                diagonal = (u[0] + w[0] - v[0], u[1] + w[1] - v[1])
                (corners if diagonal in graph else halls).append(v)
    return corners, halls


def test_without_a_corner_a_region_is_simply_connected_and_keeps_its_distances():
    """Lemma 3.3."""
    tried = 0
    for region in random_regions(5, 3, 9):
        graph = graph_of(region)
        corners, _ = corners_and_halls(graph)
        if len(graph) == 1:
            continue
        whole = dict(nx.all_pairs_shortest_path_length(graph))
        for corner in corners[:6]:
            column, row = corner
            free = region.free.copy()
            free[row, column] = False
            Region(free).check()
            rest = graph.copy()
            rest.remove_node(corner)
            for source, lengths in nx.all_pairs_shortest_path_length(rest):
                assert len(lengths) == len(rest)
                assert all(whole[source][target] == n for target, n in lengths.items())
            tried += 1
    assert tried > 50


def test_halls_are_articulation_points():
    """Lemma 3.4; and only in simply connected regions: the halls of a ring are none."""
    tried = 0
    for region in random_regions(12, 4, 16):
        graph = graph_of(region)
        _, halls = corners_and_halls(graph)
        assert set(halls) <= set(nx.articulation_points(graph))
        tried += len(halls)
    assert tried > 200
    graph = graph_of(ring(5, 5))
    assert len(corners_and_halls(graph)[1]) == 4
    assert not set(nx.articulation_points(graph))


# Table 1.


def test_the_30x30_row_of_table_1_holds_for_four_doors_and_no_other():
    sums = sums_of_distances(np.ones((30, 30), np.bool_))
    fitting = {
        (column, row)
        for row, column in np.argwhere(sums == 13620).tolist()
        if distances(np.ones((30, 30), np.bool_), [(column, row)]).max() == 32
    }
    assert fitting == {(13, 13), (13, 16), (16, 13), (16, 16)}
    for door in fitting:
        outcome = simulate(rectangle(30, 30, [door]))
        assert is_optimal(outcome)
        assert (outcome.travel.sum(), outcome.travel.max(), outcome.makespan) == (13620, 32, 1799)


def test_dflf_travels_as_far_as_the_paper_says():
    runs = [simulate(rectangle(30, 30, [(13, 13)]), "dflf", seed=seed) for seed in range(30)]
    assert all(run.all_settled and run.makespan == 1799 for run in runs)
    assert all((run.travel == run.moves).all() for run in runs)  # it never stops
    total = np.mean([run.moves.sum() for run in runs])
    most = np.mean([run.moves.max() for run in runs])
    # One run's total has a standard deviation of 24,000 and its maximum one of 60; the paper's
    # 237,984 (460) is an average over several runs, ours over 30: three deviations of that mean.
    assert abs(total - 237_984) < 3 * 24_000 / 30**0.5
    assert abs(most - 460) < 3 * 60 / 30**0.5


@pytest.mark.parametrize("name", studies.TABLE_1)
def test_bflf_moves_as_far_as_the_paper_says(name):
    region = studies.table_region(name)
    runs = [simulate(region, "bflf", seed=seed) for seed in range(30)]
    assert all(run.makespan == 2 * region.cells - 1 for run in runs)
    # The rule is open in the paper, and but for the square the regions are ours: a tenth.
    total, most = studies.TABLE_1[name][1]
    assert np.mean([run.moves.sum() for run in runs]) == pytest.approx(total, rel=0.1)
    assert np.mean([run.moves.max() for run in runs]) == pytest.approx(most, rel=0.3)
    # "Including pauses causes the maximal travel of BFLF to become extremely large."
    assert np.mean([run.travel.max() for run in runs]) > 3 * max(run.moves.max() for run in runs)


def enters_in_every_second_step(outcome):
    return (outcome.entered == np.arange(1, 2 * outcome.cells, 2)).all()


def test_bflf_waits_and_never_delays_the_entry():
    # Its makespan in "Time, Travel, and Energy in the Uniform Dispersion Problem" is 2V: one step
    # after the last robot has come in, all have settled.
    waited = 0
    for seed, region in enumerate(studies.sample(150)):
        outcome = simulate(region, "bflf", seed=seed)
        assert enters_in_every_second_step(outcome)
        assert (outcome.makespan, outcome.steps) == (2 * outcome.cells - 1, 2 * outcome.cells)
        waited += (outcome.travel > outcome.moves).any()
    assert waited > 100


def test_bflf_delays_nobody_where_there_are_holes_either():
    for seed in range(60):
        free = np.random.default_rng(seed).random((12, 12)) < 0.8
        free[5, 5] = True
        connected = distances(free, [(5, 5)]) != FAR
        outcome = simulate(Region(connected, ((5, 5),)), "bflf", seed=seed)
        assert outcome.all_settled
        assert enters_in_every_second_step(outcome)


# Section 3.3 and figure 7: regions that are not simply connected.


def test_on_the_comb_with_a_loop_no_rule_reaches_the_sum_of_distances():
    for k in (2, 11, 20):
        for name in ("fcdfs", "dflf", "bflf"):
            outcome = simulate(comb(k), name, seed=k)
            assert not outcome.all_settled or outcome.moves.sum() > outcome.sum_of_distances
    assert is_optimal(simulate(comb(None)))


@pytest.mark.parametrize("thickness", [1, 2])
def test_a_ring_collides_or_is_sealed_as_in_figure_7(thickness):
    for column in range(3, 9):
        region = ring(11, 10, thickness).with_doors([(column, 0)])
        assert simulate(region).outcome == "collision"
        sealed = simulate(region, conflict="stay")
        assert sealed.outcome == "circling"
        assert not sealed.covered


# Section 5: missed steps.


@pytest.mark.parametrize(("q", "slower"), [(0.1, 1.3), (0.3, 1.9)])
def test_with_a_light_missed_steps_cost_time_and_nothing_else(q, slower):
    ratios = []
    for seed, region in enumerate(random_regions(12, 8, 20)):
        outcome = simulate(region, "light", seed=seed, q=q)
        assert outcome.all_settled
        assert outcome.collisions == 0
        assert outcome.moves.sum() == outcome.sum_of_distances
        assert outcome.moves.max() == outcome.max_distance
        ratios.append(outcome.makespan / (2 * outcome.cells - 1))
    # Found on other regions: 1.3 and 1.8 to 1.9 times; regions differ by about a tenth.
    assert np.mean(ratios) == pytest.approx(slower, rel=0.1)


def share_of_the_bound(outcome, q):
    """Makespan over V / alpha."""
    return outcome.makespan * studies.most_entries(q) / outcome.cells


@pytest.mark.parametrize("q", [0.25, 0.5, 0.75])
def test_with_a_light_the_makespan_is_bounded_as_that_of_asynchronous_fcdfs(q):
    # (1 / alpha + o(1)) V, p = 1 - q the probability to wake.
    assert studies.most_entries(q) == pytest.approx((1 - (1 - (1 - q)) ** 0.5) / 2)
    for seed, region in enumerate(studies.sample(60)):
        assert share_of_the_bound(simulate(region, "light", seed=seed, q=q), q) <= 1
    # No bound that is less would do: a corridor comes near to it.
    corridor = rectangle(3000, 1, [(0, 0)])
    assert 0.98 < share_of_the_bound(simulate(corridor, "light", seed=1, q=q), q) <= 1


def test_energy_is_every_step_of_activity_and_the_one_in_which_a_robot_settles():
    region = studies.table_region("labyrinth")
    outcome = simulate(region, "light", seed=1)
    figures = outcome.figures()
    # The later paper has for a region of like distances and 669 cells 35,772 = 35,103 + 669.
    assert figures["total_energy"] == outcome.sum_of_distances + region.cells
    assert figures["max_energy"] == outcome.max_distance + 1
    cut = simulate(region, "light", q=0.5, max_steps=200)
    settled = cut.settled > 0
    assert (cut.energy[settled] == cut.settled[settled] - cut.entered[settled]).all()
    assert (cut.energy[~settled] == 200 - cut.entered[~settled]).all()


def test_without_missed_steps_the_light_changes_nothing():
    for region in random_regions(10):
        assert moves_alike(simulate(region, "light"), simulate(region, "fcdfs"))


def test_without_a_light_missed_steps_are_fatal():
    outcomes = [
        simulate(region, "fcdfs", seed=seed, q=0.3)
        for seed, region in enumerate(random_regions(20, 8, 20))
    ]
    assert not any(outcome.covered for outcome in outcomes)


# The claims above are sharp: rules with a part left out fail them.


def mutant(rule, *replacements):
    """A rule with pieces of its text replaced."""
    source = inspect.getsource(rule)
    for old, new in replacements:
        assert source.count(old) == 1
        source = source.replace(old, new)
    names = dict(rule.__globals__)
    exec(compile(source, "<mutant>", "exec"), names)
    return names[rule.__name__]


MUTANTS = {
    "algorithm 1 forgets prev(prev)": (RULES["fcdfs"], "dead_end or came_by_diagonal", "dead_end"),
    "algorithm 1 ignores the diagonal": (RULES["fcdfs"], " or diagonal_free", ""),
    "algorithm 1 takes the wrong diagonal": (
        RULES["fcdfs"],
        "(primary + 2) & 3))",
        "(primary + 1) & 3))",
    ),
    "algorithm 1 turns back in a hall": (RULES["fcdfs"], "primary == (last", "primary != (last"),
    "algorithm 1 goes on in a dead end": (RULES["fcdfs"], "dead_end or came", "came"),
    "algorithm 2 forgets prev(prev)": (RULES["fcdfs5"], " or (b5 == 1 and b3 + b4 == 1)", ""),
    "algorithm 2 lacks the guard b5 = 1": (RULES["fcdfs5"], "b5 == 1 and b3", "b3"),
    "algorithm 2 always writes b4b5": (RULES["fcdfs5"], "if not updated", "if True"),
    "symmetric forgets what it saw": (RULES["symmetric"], "(memory >> other) & 1 == 0", "False"),
    "left hand forgets what it saw": (RULES["left_hand"], "(memory >> other) & 1 == 0", "False"),
}


@pytest.mark.parametrize("name", MUTANTS)
def test_a_rule_with_a_part_left_out_fails(name):
    rule, old, new = MUTANTS[name]
    broken = mutant(rule, (old, new))
    senses = SENSES.get(rule.__name__, 0)
    outcomes = [simulate(region, broken, senses=senses) for region in random_regions(20)]
    failed = sum(not is_optimal(outcome) for outcome in outcomes) / len(outcomes)
    # The rarest of these failures strikes a quarter of such regions; the rules themselves none.
    assert failed > 0.1


def test_a_correct_rule_survives_the_treatment_of_mutants():
    same = mutant(RULES["fcdfs5"], ("if not updated", "if updated == False"))
    assert all(is_optimal(simulate(region, same)) for region in random_regions(20))


def test_bflf_must_wait_and_must_look_two_cells_back():
    late = mutant(RULES["bflf"], ("(seen >> 27) & 3", "(seen >> 27) & 1"))
    hasty = mutant(RULES["bflf"], (" or (seen >> 27) & 3 == 0", ""))
    senses = SENSES["bflf"]
    for name in studies.TABLE_1:
        region = studies.table_region(name)
        assert simulate(region, late, senses=senses).makespan > 2 * region.cells - 1
        total, _ = studies.TABLE_1[name][1]
        assert simulate(region, hasty, senses=senses).moves.sum() > 1.1 * total


def test_the_variants_need_another_test_of_the_diagonal_than_fcdfs():
    """Robots whose directions differ do not follow each other: prev(prev) is not enough."""
    broken = mutant(
        RULES["symmetric"],
        ("(memory >> other) & 1 == 0", "(memory > 0 and (memory + 1) & 3 == other)"),
        ("(seen & 15) << 8", "last << 8"),  # the move before the last in place of what was seen
    )
    outcomes = [
        simulate(region, broken, senses=DICE, seed=seed)
        for seed, region in enumerate(random_regions(60))
    ]
    collided = sum(outcome.outcome == "collision" for outcome in outcomes)
    # A rare failure, about one region in twenty: most runs go well, and not all.
    assert 0 < collided < len(outcomes) / 4
    assert collided + sum(map(is_optimal, outcomes)) == len(outcomes)
