"""Judges of a sweep see every tick of its runs, and what they say stands in the table."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.troupe.sweep.sweeping import plan_of, quiet_world
from troupe.sweep.collect import gather
from troupe.sweep.session import How, sweep
from troupe.usage import UsageError

JUDGE = """\
def nearest(seen, result):
    from troupe.testing import distances
    return {"ticks": len(seen.times), "gap": distances(seen).min(), "said": result.outcome}

def broken(seen, result):
    raise ValueError("of no use")
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "judge.py").write_text(JUDGE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_what_judges_say_are_columns(folder: Path) -> None:
    plan = plan_of(quiet_world(folder), "0:2", judge=("judge.py:nearest",))
    assert sweep(plan, folder / "out", How(quiet=True)).missing == 0
    tables = gather([folder / "out"])
    assert tables.added == ["judged.ticks", "judged.gap", "judged.said"]
    for row in tables.results:
        assert (row["judged.ticks"], row["judged.said"]) == (5, "completed")
        assert row["judged.gap"] > 0.0


def test_runs_are_others_with_a_judge_and_with_another_one(folder: Path) -> None:
    world = quiet_world(folder)
    plain, judged = plan_of(world, "0"), plan_of(world, "0", judge=("judge.py:nearest",))
    (folder / "judge.py").write_text(JUDGE + "# better\n")
    other = plan_of(world, "0", judge=("judge.py:nearest",))
    assert len({plan.points[0].hash for plan in (plain, judged, other)}) == 3


def test_a_judge_that_raises_makes_a_row_that_says_so(folder: Path) -> None:
    plan = plan_of(quiet_world(folder), "0", judge=("judge.py:broken",))
    sweep(plan, folder / "out", How(quiet=True))
    (row,) = gather([folder / "out"]).results
    assert row["outcome"] == "error"
    assert "--judge judge.py:broken: ValueError: of no use" in row["reason"]


def test_a_judge_that_is_not_there_is_told_before_the_first_run(folder: Path) -> None:
    with pytest.raises(UsageError, match="no function"):
        plan_of(quiet_world(folder), "0", judge=("judge.py:nobody",))
