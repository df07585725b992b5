"""The studies of the papers' results, and the script that writes them down."""

import subprocess
import sys
from pathlib import Path

import pytest

from gridworld import studies
from gridworld.grid import simulate
from troupe.grid import disperse


@pytest.mark.parametrize("name", studies.TABLE_1)
def test_our_regions_ask_of_fcdfs_what_the_papers_do(name):
    region = studies.table_region(name)
    region.check()
    total, most = studies.TABLE_1[name][2]
    outcome = simulate(region)
    assert studies.is_optimal(outcome)
    # Ours were picked to come within a thousandth of the paper's totals.
    assert outcome.travel.sum() == pytest.approx(total, rel=0.001)
    assert outcome.travel.max() == most


def test_small_regions_are_all_tried():
    # 63 polyominoes of five cells, every cell a door.
    assert studies.exhaust(5, "fcdfs") == (63 * 5, 0, 0)


def test_averages_are_over_the_seeds():
    region = studies.table_region("flat")
    runs = [simulate(region, "dflf", seed=seed) for seed in range(3)]
    row = studies.averages([run.figures() for run in runs])
    assert row.moves == pytest.approx(sum(run.moves.sum() for run in runs) / 3)
    assert row.makespan == 2 * region.cells - 1


def test_shares_tell_covered_runs_from_others():
    def share(**asked):
        runs = [disperse(seed, "any", **asked) for seed in range(12)]
        return studies.share(runs, [2 * run["cells"] - 1 for run in runs])

    assert share().covered == 1
    lost = share(q=0.5)
    assert (lost.covered, lost.slower != lost.slower) == (0, True)  # nan: nothing to average
    lit = share(rule="light", q=0.5)
    assert (lit.covered, lit.collided, lit.on_shortest_paths) == (1, 0, 1)
    assert share(doors=2, conflict="stay").collided == 0


def test_the_script_writes_its_page(tmp_path):
    script = Path(__file__).parents[2] / "scripts" / "fcdfs_tables.py"
    options = ["--runs", "2", "--regions", "5", "--cells", "3", "--no-large", "--out", tmp_path,
               "--folder", tmp_path / "runs", "--jobs", "1"]  # fmt: skip
    subprocess.run([sys.executable, script, *map(str, options)], check=True, capture_output=True)
    page = (tmp_path / "fcdfs.md").read_text()
    assert "| 30x30 (V = 900) |" in page
    assert "13620 (32)" in page
    for shown in page.split("](fcdfs/")[1:]:
        assert (tmp_path / "fcdfs" / shown.partition(")")[0]).stat().st_size > 0
