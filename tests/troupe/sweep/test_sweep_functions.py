"""A function in a world's place: a sweep of whatever is a function of parameters and a seed."""

from __future__ import annotations

import csv
import textwrap
from pathlib import Path

import pytest

import troupe as library
from tests.processes import ROOT
from tests.troupe.sweep.sweeping import QUIET, plan_of, troupe
from troupe.report.sweep import contents
from troupe.sweep.asked import asked_plan
from troupe.sweep.collect import csv_of, gather, write_tables
from troupe.sweep.folder import records
from troupe.sweep.plan import Plan, plan_of_json
from troupe.sweep.session import Changed, How, sweep
from troupe.usage import UsageError

STUDY = """\
from typing import Literal

import helper

def walk(seed: int, rate: float, kind: Literal["old", "new"] = "old"):
    if seed == 3:
        raise ValueError("three")
    if seed == 4:
        return {"outcome": "lost", "reason": "no way"}
    return {"length": helper.SCALE * rate * seed, "kind_is": kind, "whole": isinstance(rate, int)}

def number(seed):
    return 7 * seed

def read(seed, map):
    return {"size": len(open(map).read())}

def drive(seed, speed):
    import troupe
    settings = {"models.rover.drive.max_speed": speed}
    with troupe.Simulation("quiet.yaml", seed=seed, set=settings) as sim:
        sim.step(3)
        return sim.result()

def seedless(rate):
    return {}
"""
QUIETLY = How(jobs=1, quiet=True)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "study.py").write_text(STUDY)
    (tmp_path / "helper.py").write_text("SCALE = 10\n")
    (tmp_path / "quiet.yaml").write_text(QUIET)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def study(function: str, seeds: str, *settings: str, **more: object) -> Plan:
    return plan_of(Path(f"study.py:{function}"), seeds, *settings, **more)  # type: ignore[arg-type]


def test_what_a_function_returns_is_a_row(folder: Path) -> None:
    plan = study("walk", "1:3", "rate=1,0.5", "kind=new")
    assert sweep(plan, folder / "out", QUIETLY).ran == {"completed": 4}
    tables = gather([folder / "out"])
    shown = [(row["rate"], row["seed"], row["length"], row["kind_is"]) for row in tables.results]
    assert shown == [(0.5, 1, 5, "new"), (0.5, 2, 10, "new"), (1, 1, 10, "new"), (1, 2, 20, "new")]
    assert not any(row["whole"] for row in tables.results)  # it asked for a float
    assert tables.added == ["length", "kind_is", "whole"]
    assert set(records([folder / "out"])) == {run.name for run in plan.runs()}


def test_only_what_is_missing_is_called_and_the_table_is_the_same(folder: Path) -> None:
    plan = study("walk", "0:9", "rate=1,2")
    sweep(plan, folder / "whole", How(jobs=2, quiet=True))
    for part in (1, 2, 3):
        sweep(plan, folder / "parts", How(jobs=1, quiet=True, shard=(part, 3)))
    again = sweep(plan, folder / "parts", QUIETLY)
    assert (again.known.total(), again.ran.total()) == (18, 0)
    whole, parts = (csv_of(gather([folder / name]).results) for name in ("whole", "parts"))
    assert whole == parts


def test_what_a_function_raises_or_calls_its_outcome_is_a_row(folder: Path) -> None:
    plan = study("walk", "2:5", "rate=1")
    sweep(plan, folder / "out", QUIETLY)
    rows = {row["seed"]: row for row in gather([folder / "out"]).results}
    assert (rows[3]["outcome"], rows[3]["reason"]) == ("error", "ValueError: three")
    assert (rows[4]["outcome"], rows[4]["reason"]) == ("lost", "no way")
    again = sweep(plan, folder / "out", How(jobs=1, quiet=True, retry_failed=True))
    assert again.ran == {"error": 1}  # `lost` is what the function says, and would say again


def test_a_function_may_do_what_it_likes_with_its_process(folder: Path) -> None:
    (folder / "study.py").write_text("""\
import os, subprocess, sys, time

def f(seed):
    if seed == 1:
        sys.exit("enough")
    if seed == 2:
        os._exit(3)
    if seed == 3:
        time.sleep(1e6)
    if seed == 4:
        raise MemoryError
    os.chdir("/")
    print("no answer")
    subprocess.run(["cat"])  # reads all that there is
    return sys.stdin.read()
""")
    sweep(study("f", "0:3,4,5"), folder / "out", QUIETLY)
    sweep(study("f", "3"), folder / "out", How(jobs=1, quiet=True, timeout=0.5))
    rows = {row["seed"]: row for row in gather([folder / "out"]).results}
    assert {seed: row["outcome"] for seed, row in rows.items()} == {
        0: "completed", 1: "error", 2: "crashed", 3: "timeout", 4: "out_of_memory", 5: "completed",
    }  # fmt: skip
    assert rows[1]["reason"] == "SystemExit: enough"
    assert rows[0]["f"] == ""


def test_a_worker_that_ends_by_itself_has_crashed_and_its_last_words_are_kept(folder: Path) -> None:
    (folder / "study.py").write_text("def stop(seed):\n    raise GeneratorExit\n")
    sweep(study("stop", "0:1"), folder / "out", QUIETLY)
    (record,) = (line.record for line in records([folder / "out"]).values())
    assert (record["outcome"], record["tries"]) == ("crashed", 3)
    assert "exit code" in record["reason"]
    assert record["output"][-1] == "GeneratorExit"


def test_a_plain_value_is_a_column_of_the_functions_name(folder: Path) -> None:
    sweep(study("number", "2:4"), folder / "out", QUIETLY)
    assert [row["number"] for row in gather([folder / "out"]).results] == [14, 21]


def test_a_simulations_result_makes_the_row_of_a_run(folder: Path) -> None:
    sweep(study("drive", "5:7", "speed=0.5"), folder / "out", QUIETLY)
    (first, _) = gather([folder / "out"]).results
    settings = {"models.rover.drive.max_speed": 0.5}
    alone = library.run("quiet.yaml", seed=5, set=settings, duration=0.3)
    assert (first["digest"], first["robots"]) == (alone.digest, 3)


def test_a_column_of_a_parameters_name_hides_neither(folder: Path) -> None:
    (folder / "study.py").write_text("def f(seed, a=1):\n    return {'a': 10 * a, 'seed': 5}\n")
    sweep(study("f", "0", "a=2"), folder / "out", QUIETLY)
    (row,) = gather([folder / "out"]).results
    assert (row["a"], row["found.a"], row["seed"], row["found.seed"]) == (2, 20, 0, 5)


def test_parameters_may_be_called_as_the_tables_own_columns(folder: Path) -> None:
    (folder / "study.py").write_text(
        "def one(seed, world, hash, robots):\n    return 1\n\ndef two(seed):\n    return 2\n"
    )
    table = folder / "table.csv"
    settings = ("world=1", "hash=2", "robots=3")
    for plan in (study("one", "0:1", *settings), study("two", "0:1")):
        sweep(plan, folder / "out", QUIETLY)
    found = gather([folder / "out"])
    table.write_bytes(csv_of(found.results))
    one, two = sorted(csv.DictReader(table.open()), key=lambda row: row["world"])
    assert (one["world"], one["set.world"], one["set.hash"], one["set.robots"]) == (
        "study.py:one", "1", "2", "3",
    )  # fmt: skip
    assert one["hash"] not in ("", "2")
    assert (two["world"], two["set.world"]) == ("study.py:two", "")


def test_numpys_numbers_within_lists_and_mappings_are_columns_too(folder: Path) -> None:
    (folder / "study.py").write_text(
        "import numpy as np\n\n"
        "def mixed(seed):\n"
        "    return {'of': [np.int64(3), {'a': np.float32(0.5), (1, 2): {4}}, np.nan]}\n"
    )
    sweep(study("mixed", "0:1"), folder / "out", QUIETLY)
    (row,) = gather([folder / "out"]).results
    assert (row["outcome"], row["of"]) == ("completed", [3, {"a": 0.5, "(1, 2)": "{4}"}, None])


def test_what_no_table_can_hold_is_a_row_of_an_error_or_missing(folder: Path) -> None:
    (folder / "study.py").write_text(
        "def round(seed):\n    a = []\n    a.append(a)\n    return {'a': a}\n\n"
        "def large(seed):\n    return {'a': 2 ** (70 + 1000 * seed)}\n"
    )
    sweep(study("round", "0:1"), folder / "out", QUIETLY)
    sweep(study("large", "0:2"), folder / "out", QUIETLY)
    found = gather([folder / "out"])
    rows = {(row["world"], row["seed"]): row for row in found.results}
    assert "levels deep" in rows["study.py:round", 0]["reason"]
    assert rows["study.py:large", 0]["a"] == 2**70
    assert rows["study.py:large", 1]["a"] is None
    write_tables(found, folder / "out")
    if (folder / "out" / "results.parquet").exists():
        table = library.read_sweep(folder / "out")
        assert sorted(table["a"].dropna()) == [2.0**70]


def test_functions_of_a_result_are_given_what_the_function_returned(folder: Path) -> None:
    (folder / "own.py").write_text("def half(found):\n    return found['length'] / 2\n")
    plan = study("walk", "2", "rate=1", each=("own.py:half",))
    sweep(plan, folder / "out", QUIETLY)
    (row,) = gather([folder / "out"]).results
    assert row["half"] == 10.0


def name_of(*settings: str, function: str = "walk") -> str:
    return study(function, "1", *settings).points[0].hash


def test_a_runs_name_follows_from_function_parameters_and_the_modules_beside_it(
    folder: Path,
) -> None:
    names = {name_of("rate=1"), name_of("rate=2"), name_of("rate=1", "kind=new")}
    assert len(names) == 3
    assert plan_of(Path("study:walk"), "1", "rate=1").points[0].hash == name_of("rate=1")
    (folder / "helper.py").write_text("SCALE = 11\n")
    assert name_of("rate=1") not in names
    (folder / "helper.py").write_text("SCALE = 10\n")
    assert name_of("rate=1") in names


def test_a_file_that_a_parameter_names_is_part_of_the_runs_name(folder: Path) -> None:
    (folder / "map.txt").write_text("..\n")
    before = name_of("map=map.txt", function="read")
    (folder / "map.txt").write_text("...\n")
    assert name_of("map=map.txt", function="read") != before


def test_a_function_that_is_changed_meanwhile_ends_the_sweep(folder: Path) -> None:
    plan = study("walk", "1", "rate=1")
    (folder / "study.py").write_text(STUDY + "\nmore = 1\n")
    with pytest.raises(Changed, match=r"study\.py:walk"):
        sweep(plan, folder / "out", QUIETLY)


def test_all_that_is_wrong_with_parameters_is_told_before_the_first_run(folder: Path) -> None:
    settings = ("ratte=1", "kind=old,newer")
    with pytest.raises(UsageError) as found:
        asked_plan(
            ["study.py:walk", "study.py:seedless", "study.py:wolk", "nowhere:f", "study.py"],
            seeds="0", settings=settings, table=None, duration=None, each=(), about={},
        )  # fmt: skip
    told = str(found.value)
    assert "study.py:walk: ratte: is no parameter of it; did you mean rate?" in told
    assert "study.py:walk: rate: has no value" in told
    assert (
        "study.py:walk: kind: unknown choice; did you mean new? (given: newer; allowed: old, new)"
        in told
    )
    assert "study.py:seedless: has no parameter `seed`" in told
    assert "study.py:wolk" in told
    assert "nowhere:f" in told
    assert "allowed: study.py:FUNCTION" in told


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--judge", "study.py:number"), "--judge"),
        (("--duration", "3"), "--duration"),
        (("--video-of", "first"), "--video-of"),
        (("--log-of", "first"), "--log-of"),
        (("--set", "seed=1"), "--seeds"),
    ],
)
def test_what_a_function_does_not_have_is_told(
    folder: Path, words: tuple[str, ...], said: str
) -> None:
    done = troupe("sweep", "study.py:number", "--out", folder / "out", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert said in done.stderr
    assert not (folder / "out").exists()


def test_a_plan_of_functions_is_kept_as_it_is(folder: Path) -> None:
    plan = study("walk", "0:3", "rate=1")
    assert plan_of_json(plan.as_json()) == plan


def test_two_functions_are_compared_in_a_report(folder: Path) -> None:
    pytest.importorskip("matplotlib")
    (folder / "study.py").write_text(
        "def old(seed):\n    return {'cost': 10.0 + seed}\n\n"
        "def new(seed):\n    return {'cost': 5.0 + seed, 'outcome': 'completed'}\n"
    )
    (folder / "sweep.yaml").write_text("worlds: [study.py:old, study.py:new]\nseeds: 0:5\n")
    done = troupe("sweep", "sweep.yaml", "--out", folder / "out", "--quiet")
    assert done.returncode == 0, done.stderr
    with (folder / "out" / "results.csv").open(newline="") as file:
        assert len(list(csv.DictReader(file))) == 10
    found = contents(gather([folder / "out"]), title="x")
    (part,) = found["measures"]
    (pair,) = part["pairs"]
    assert (part["name"], pair["n"], float(pair["median"]), pair["higher"]) == ("cost", 5, 5.0, 5)
    best, _, worst = found["looks"]
    assert (best["seed"], worst["seed"], worst["picture"]) == (0, 4, None)
    again = troupe(*worst["command"].split()[1:-1], folder / "again", cwd=folder)
    assert again.returncode == 0, again.stderr
    (row,) = gather([folder / "again"]).results
    assert row["cost"] == 14.0


def test_the_function_in_the_documents_works(folder: Path) -> None:
    text = (ROOT / "docs" / "sweeps.md").read_text()
    block = text.partition("    # learn.py\n")[2].partition("\nAll else")[0]
    (folder / "learn.py").write_text(textwrap.dedent(block).replace("duration=20", "duration=1"))
    plan = plan_of(Path("learn.py:episode"), "0:2", "turn=0.4,0.8")
    assert sweep(plan, folder / "out", QUIETLY).ran == {"completed": 4}
    rows = gather([folder / "out"]).results
    assert all(row["driven"] > 0.0 for row in rows)
    assert len({row["digest"] for row in rows}) >= 2
