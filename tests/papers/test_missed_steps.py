"""The FCDFS paper's section 5: robots that miss steps, with a light and without."""

import numpy as np
import pytest
from grid_runs import moves_alike, random_regions

from gridworld import studies
from gridworld.grid import simulate
from gridworld.regions import rectangle


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
