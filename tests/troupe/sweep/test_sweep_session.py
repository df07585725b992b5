"""A sweep runs what its folder lacks, and keeps whatever becomes of a run."""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path
from typing import Literal

import pytest

import troupe
from scripts.sweep_kills import compare
from tests.troupe.sweep.sweeping import driven_world, plan_of, quiet_world
from troupe.sweep import session as sessions
from troupe.sweep.collect import csv_of, gather, read_sweep
from troupe.sweep.folder import records
from troupe.sweep.pool import Worker, run_all, run_one
from troupe.sweep.session import Changed, How, sweep
from troupe.sweep.task import Worlds, run_task, task_of

FAILS_IF_ODD = """\
import os
from player import PlayerClient, Position2dProxy
with PlayerClient() as robot:
    Position2dProxy(robot)
    robot.read()
    if int(os.environ["TROUPE_SEED"]) % 2:
        raise ValueError("odd")
"""
QUIETLY = How(jobs=1, quiet=True)
IN_PAIRS = How(jobs=2, quiet=True)


def test_a_run_has_the_result_that_it_has_alone(tmp_path: Path) -> None:
    world = driven_world(tmp_path, FAILS_IF_ODD)
    sweep(plan_of(world, "0:3", "models.rover.body.radius=0.2"), tmp_path / "out", QUIETLY)
    for row in gather([tmp_path / "out"]).results:
        alone = troupe.run(world, seed=row["seed"], set={"models.rover.body.radius": 0.2})
        assert (row["digest"], row["outcome"]) == (alone.digest, alone.outcome)


def test_only_what_is_missing_is_run_and_the_table_is_the_same(tmp_path: Path) -> None:
    plan = plan_of(quiet_world(tmp_path), "0:6", "clock.interval=0.1,0.05")
    first = sweep(plan, tmp_path / "whole", IN_PAIRS)
    assert (first.ran.total(), first.missing) == (12, 0)
    for part in (1, 2, 3):
        sweep(plan, tmp_path / "parts", How(jobs=1, quiet=True, shard=(part, 3)))
    again = sweep(plan, tmp_path / "parts", QUIETLY)
    assert (again.known.total(), again.ran.total()) == (12, 0)
    whole, parts = gather([tmp_path / "whole"]), gather([tmp_path / "parts"])
    assert csv_of(whole.results) == csv_of(parts.results)


def test_a_sweep_that_is_stopped_has_lost_nothing(tmp_path: Path) -> None:
    plan = plan_of(quiet_world(tmp_path), "0:9")
    out = tmp_path / "out"
    stopped = sweep(plan, out, How(jobs=1, quiet=True), lambda: len(records([out])) >= 3)
    assert 3 <= stopped.ran.total() < 9
    again = sweep(plan, out, QUIETLY)
    assert again.known.total() == stopped.ran.total()
    assert again.missing == 0


def test_many_runs_are_kept_in_batches(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = plan_of(quiet_world(tmp_path), "0:6")
    sweep(plan, tmp_path / "files", QUIETLY)
    monkeypatch.setattr(sessions, "MANY", 6)
    sweep(plan, tmp_path / "batches", IN_PAIRS)
    assert not (tmp_path / "batches" / "runs").exists()
    tables = [csv_of(gather([tmp_path / name]).results) for name in ("files", "batches")]
    assert tables[0] == tables[1]


@pytest.mark.parametrize("many", [100, 3], ids=["files", "batches"])
def test_two_sweeps_at_once_into_one_folder_leave_each_other_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, many: int
) -> None:
    monkeypatch.setattr(sessions, "MANY", many)
    world, out, alone = quiet_world(tmp_path), tmp_path / "out", How(jobs=1, quiet=True)
    others: list[sessions.Session] = []

    def meanwhile() -> bool:
        """Asked while the first goes on: the second begins and ends in the middle of it."""
        if not others and records([out]):
            others.append(sweep(plan_of(world, "2:6"), out, alone))
        return False

    first = sweep(plan_of(world, "0:5"), out, alone, meanwhile)
    (other,) = others
    assert (first.missing, other.missing) == (0, 0)
    assert set(first.ran + other.ran + first.known + other.known) == {"completed"}
    assert [row["seed"] for row in gather([out]).results] == [0, 1, 2, 3, 4, 5]


def test_a_controller_that_fails_is_a_row_with_its_reason(tmp_path: Path) -> None:
    plan = plan_of(driven_world(tmp_path, FAILS_IF_ODD), "0:4")
    sweep(plan, tmp_path / "out", QUIETLY)
    rows = {row["seed"]: row for row in gather([tmp_path / "out"]).results}
    assert {seed: row["outcome"] for seed, row in rows.items()} == {
        0: "completed", 1: "controller_failed", 2: "completed", 3: "controller_failed",
    }  # fmt: skip
    assert rows[1]["reason"] == "failed (1): ValueError: odd"


def test_what_failed_is_run_again_when_asked_for(tmp_path: Path) -> None:
    plan = plan_of(driven_world(tmp_path, FAILS_IF_ODD), "0:4")
    sweep(plan, tmp_path / "out", QUIETLY)
    again = sweep(plan, tmp_path / "out", How(jobs=1, quiet=True, retry_failed=True))
    assert again.ran == {"controller_failed": 2}
    assert sorted(row["tries"] for row in gather([tmp_path / "out"]).timings) == [1, 1, 2, 2]


def test_a_run_that_takes_too_long_is_ended_and_is_a_row(tmp_path: Path) -> None:
    endless = "import time\nfrom player import PlayerClient\nPlayerClient()\ntime.sleep(1e6)\n"
    plan = plan_of(driven_world(tmp_path, endless), "0:2")
    found = sweep(plan, tmp_path / "out", How(jobs=2, quiet=True, timeout=0.5))
    assert found.ran == {"timeout": 2}
    assert {row["outcome"] for row in gather([tmp_path / "out"]).results} == {"timeout"}


def test_a_world_that_cannot_be_run_is_a_row_and_no_end(tmp_path: Path) -> None:
    plan = plan_of(quiet_world(tmp_path), "0:1")
    task = {**task_of(next(plan.runs())), "path": str(tmp_path / "gone.yaml")}
    record = run_task(task, Worlds())
    assert record["outcome"] == "world_error"
    assert "gone.yaml" in record["reason"]


def test_a_world_that_is_changed_meanwhile_ends_the_sweep(tmp_path: Path) -> None:
    world = quiet_world(tmp_path)
    plan = plan_of(world, "0:3")
    world.write_text(
        world.read_text() + "obstacles: [{shape: circle, radius: 1, pose: [3, 3, 0]}]\n"
    )
    with pytest.raises(Changed, match=r"quiet\.yaml"):
        sweep(plan, tmp_path / "out", QUIETLY)
    assert records([tmp_path / "out"]) == {}


def test_a_run_whose_worker_dies_is_tried_again(tmp_path: Path) -> None:
    task = task_of(next(plan_of(quiet_world(tmp_path), "0:1").runs()))
    worker = Worker()
    os.kill(worker.process.pid, signal.SIGSTOP)  # it cannot be done before it is killed
    worker.ready = True
    worker.process.kill()
    record = run_one(task, None, [worker])
    assert (record["outcome"], record["tries"]) == ("completed", 2)


def test_a_run_whose_worker_dies_each_time_is_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(tmp_path))
    sensor = tmp_path / "deadly.py"
    sensor.write_text("import os\n")
    world = quiet_world(tmp_path)
    task = {**task_of(next(plan_of(world, "0:1").runs())), "settings": {
        "models.rover.sensors": [{"type": str(sensor)}]}}  # fmt: skip
    sensor.write_text("import os\nos.kill(os.getpid(), 9)\n")
    (record,) = run_all(iter([task]), 1)
    assert (record["outcome"], record["tries"]) == ("out_of_memory", 3)


def test_a_controller_that_is_killed_from_outside_is_tried_again(tmp_path: Path) -> None:
    program = f"""\
import os
from pathlib import Path
from player import PlayerClient, Position2dProxy
with PlayerClient() as robot:
    Position2dProxy(robot)
    robot.read()
    mark = Path({str(tmp_path / "killed")!r})
    if not mark.exists():
        mark.touch()
        os.kill(os.getpid(), 9)
"""
    plan = plan_of(driven_world(tmp_path, program), "0:1")
    assert sweep(plan, tmp_path / "out", QUIETLY).ran == {"completed": 1}


def test_functions_of_a_result_add_columns(tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(
        "import numpy as np\n"
        "def far(result):\n    return {'far': np.float64(max(r.pose[0] for r in result.robots))}\n"
        "def number(result):\n    return len(result.robots)\n"
    )
    each = (f"{tmp_path / 'own.py'}:far", f"{tmp_path / 'own.py'}:number")
    sweep(plan_of(quiet_world(tmp_path), "0:2", each=each), tmp_path / "out", QUIETLY)
    for row in gather([tmp_path / "out"]).results:
        assert row["number"] == 3
        assert 0.0 < row["far"] < 6.0


@pytest.mark.parametrize("frame", ["pandas", "polars"])
def test_the_table_is_a_data_frame(tmp_path: Path, frame: Literal["pandas", "polars"]) -> None:
    pytest.importorskip(frame)
    sweep(plan_of(quiet_world(tmp_path), "0:3"), tmp_path / "out", QUIETLY)
    found = read_sweep(tmp_path / "out", frame=frame)
    assert list(found["seed"]) == [0, 1, 2]
    assert set(found["outcome"]) == {"completed"}
    assert list(troupe.read_sweep(tmp_path / "out", timings=True)["tries"]) == [1, 1, 1]


def test_what_controllers_report_are_columns(tmp_path: Path) -> None:
    program = """\
from player import PlayerClient, SimulationProxy
with PlayerClient() as robot:
    SimulationProxy(robot).report("goal", {"time": 2.5, "name": "a"})
"""
    sweep(plan_of(driven_world(tmp_path, program), "0:1"), tmp_path / "out", QUIETLY)
    (row,) = gather([tmp_path / "out"]).results
    assert row["properties.goal.time.max"] == 2.5
    assert row["properties.goal.name.one"] == "a"


@pytest.mark.skipif(sys.platform != "linux", reason="other processes' environments are read")
def test_nothing_comes_of_a_few_kills(tmp_path: Path) -> None:
    """How many kills find the sweep alive depends on the machine: until one has."""
    for seed in range(5, 15):
        folder = tmp_path / str(seed)
        folder.mkdir()
        if compare(folder, kills=3, runs=8, seed=seed):
            return
    raise AssertionError("no kill came while a sweep was going on")


def test_a_result_file_is_json_that_anybody_reads(tmp_path: Path) -> None:
    sweep(plan_of(quiet_world(tmp_path), "0:1"), tmp_path / "out", QUIETLY)
    (path,) = (tmp_path / "out" / "runs").glob("*/result.json")
    record = json.loads(path.read_text())
    assert (record["outcome"], record["seed"]) == ("completed", 0)
    assert path.parent.name == f"{record['hash']}-s0" == record["name"]
