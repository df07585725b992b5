"""What a robot step costs, from 10^4 to 10^6 cells (run with --benchmark-only)."""

import pytest

from gridworld.grid import GridRun
from gridworld.regions import rectangle


@pytest.mark.parametrize("side", [30, 100, 316, 1000])
def test_cost_of_a_robot_step_on_a_square(benchmark, side):
    """The square with the door in the middle; `ns_per_robot_step` is the figure to compare."""
    region = rectangle(side, side, [(side // 2, side // 2)])
    runs = []

    def setup():
        runs.append(GridRun(region, "fcdfs"))
        return (runs[-1],), {}

    benchmark.pedantic(lambda run: run.advance(10**9), setup=setup, rounds=1 if side == 1000 else 5)
    outcome = runs[-1].outcome()
    assert outcome.all_settled
    if benchmark.stats is not None:  # None where benchmarks are switched off
        travel = outcome.figures()["total_travel"]
        benchmark.extra_info["robot_steps"] = travel
        benchmark.extra_info["ns_per_robot_step"] = benchmark.stats.stats.min / travel * 1e9
