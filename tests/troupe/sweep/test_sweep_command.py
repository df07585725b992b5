"""`troupe sweep` as people use it: exit codes, going on, shards, Ctrl-C."""

from __future__ import annotations

import re
import signal
import subprocess
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.processes import ROOT, all_gone, environment, troupe_command
from tests.troupe.sweep.sweeping import driven_world, quiet_world, troupe
from troupe.log import Log as read_log
from troupe.sweep.asked import asked_plan
from troupe.sweep.collect import gather


def test_shards_of_their_own_folders_are_put_together(tmp_path: Path) -> None:
    world = quiet_world(tmp_path)
    (tmp_path / "rows.csv").write_text("seed,clock.interval\n0:3,0.05\n7,\n")
    for part in ("1/2", "2/2"):
        out = tmp_path / part[0]
        done = troupe(
            "sweep", world, "--table", tmp_path / "rows.csv", "--out", out, "--shard", part
        )
        assert done.returncode == 0, done.stderr
        assert "2 runs of 2 combinations: 2 run now" in done.stdout
        assert not (out / "results.csv").exists()
    one = troupe("sweep", "collect", tmp_path / "1")
    assert (one.returncode, "2 are missing" in one.stdout) == (1, True)
    both = troupe("sweep", "collect", tmp_path / "1", tmp_path / "2", "--out", tmp_path / "all")
    assert both.returncode == 0, both.stderr
    whole = troupe("sweep", world, "--table", tmp_path / "rows.csv", "--out", tmp_path / "whole")
    assert whole.returncode == 0, whole.stderr
    for name in ("results.csv", "results.parquet"):
        found = [(tmp_path / place / name).read_bytes() for place in ("all", "whole")]
        assert found[0] == found[1]


def test_a_table_may_name_the_worlds(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text(f"world,seed\n{quiet_world(tmp_path)},0:2\n")
    done = troupe("sweep", "--table", tmp_path / "rows.csv", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "2 runs of 1 combination:" in done.stdout
    done = troupe("sweep", "--out", tmp_path / "none")
    assert (done.returncode, "there is no world to run" in done.stderr) == (2, True)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "--out"),
        (("--out", "{}/out", "--seeds", "x"), "--seeds"),
        (("--out", "{}/out", "--set", "clock.intervall=1,2"), "did you mean"),
        (("--out", "{}/out", "--jobs", "0"), "--jobs"),
        (("--out", "{}/out", "--shard", "3/2"), "--shard"),
        (("--out", "{}/out", "--jobs", "2", "--dask", "127.0.0.1:8786"), "--jobs and --dask"),
        (("--out", "{}/out", "--timeout", "0"), "--timeout"),
        (("--out", "{}/out", "--video-of", "some"), "--video-of"),
        (("--out", "{}/out", "--each", "nowhere:f"), "nowhere"),
        (("--out", "{}/out", "--each", "nowhere.py:f"), "there is no file nowhere.py"),
        (("--out", "{}/out", "--each", "json:dump_s"), "in json; did you mean dumps?"),
        (("--out", "{}/out", "--duration", "inf"), "below 1e15"),
        (("--out", "{}", "--quiet"), "something else"),
        (("--out", "{}/quiet.yaml/out"), "cannot be made"),
    ],
)
def test_bad_usage_is_told_before_anything_is_run(
    tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    world = quiet_world(tmp_path)
    done = troupe("sweep", world, *(word.format(tmp_path) for word in words))
    assert (done.returncode, done.stdout) == (2, "")
    assert said in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def test_all_mistakes_are_told_at_once(tmp_path: Path) -> None:
    words = ("--seeds", "x", "--set", "foo", "--set", "clock.interval=-1", "--jobs", "0",
             "--shard", "3/2", "--timeout", "0", "--each", "nowhere:f", "--judge", "nobody:g",
             "--video-of", "some", "--log-of", "0", "--duration", "-1")  # fmt: skip
    done = troupe("sweep", quiet_world(tmp_path), "wandr", *words)
    assert done.returncode == 2
    for said in ("--out", "--seeds", "foo", "clock.interval", "--jobs", "--shard", "--timeout",
                 "nowhere", "nobody", "--video-of", "--log-of", "--duration",
                 "mean wander"):  # fmt: skip
        assert said in done.stderr


def test_a_mistake_is_told_where_the_setting_stands(tmp_path: Path) -> None:
    world = quiet_world(tmp_path)
    table, file = tmp_path / "rows.csv", tmp_path / "sweep.yaml"
    table.write_text("robots.0.count,foo\n1,\nx,\n2,3\n")
    file.write_text(f"worlds: {world}\nparameters:\n  clock.intervall: 0.1\n  duration: 3\n")
    done = troupe("sweep", world, "--table", table, "--out", tmp_path / "out")
    assert f"{table}:3: robots.0.count: must be a whole number (given: x)" in done.stderr
    assert f"{table}: foo: unknown key" in done.stderr
    done = troupe("sweep", file, "--out", tmp_path / "out")
    assert f"{file}:4:3: duration: is no parameter of a sweep" in done.stderr
    file.write_text(file.read_text().replace("  duration: 3\n", ""))
    done = troupe("sweep", file, "--out", tmp_path / "out")
    assert f"{file}:3:3: clock.intervall: unknown key" in done.stderr


def test_an_option_that_means_nothing_to_collect_is_a_mistake(tmp_path: Path) -> None:
    done = troupe("sweep", "collect", tmp_path, "--jobs", "2")
    assert done.returncode == 2
    assert "--jobs" in done.stderr
    assert troupe("sweep", "collect", tmp_path).returncode == 2


def test_ctrl_c_ends_a_sweep_in_order(tmp_path: Path) -> None:
    program = """\
import sys
from player import PlayerClient, Position2dProxy
with PlayerClient() as robot:
    Position2dProxy(robot)
    while robot.read():
        pass
"""
    world = driven_world(tmp_path, program)
    out = tmp_path / "out"
    mark = str(tmp_path)
    words = ("sweep", world, "--seeds", "0:100000", "--duration", "1", "--out", out)
    process = subprocess.Popen(
        troupe_command(*map(str, words)), env=environment(TROUPE_TEST_MARK=mark),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    batches = out / "batches"
    while process.poll() is None and not any(
        path.stat().st_size for path in batches.glob("*.part")
    ):
        pass
    process.send_signal(signal.SIGINT)
    told, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 130, errors
    assert "the same command goes on" in errors
    assert re.search(r"100000 runs of 1 combination: [1-9]\d* run now", told)
    assert not list(batches.glob("*.part"))
    assert all_gone(mark)


def test_videos_are_made_of_chosen_runs(tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = troupe("sweep", quiet_world(tmp_path), "--seeds", "3:6", "--out", out, "--video-of", "1")
    assert done.returncode == 0, done.stderr
    (video,) = (out / "videos").iterdir()
    assert video.name.endswith("-s3.mp4")
    assert video.stat().st_size > 1000


def test_logs_are_kept_of_chosen_runs(tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ("--seeds", "3:6", "--set", "clock.interval=0.1,0.05", "--out", out)
    done = troupe("sweep", quiet_world(tmp_path), *words, "--log-of", "first")
    assert done.returncode == 0, done.stderr
    assert "2 logs are in" in done.stdout
    found = {read_log(path).result["digest"] for path in (out / "logs").iterdir()}
    rows = gather([out]).results
    assert found == {row["digest"] for row in rows if row["seed"] == 3}
    assert len(found) == 2


def test_nothing_is_left_of_a_log_that_took_too_long(tmp_path: Path) -> None:
    endless = "import time\nfrom player import PlayerClient\nPlayerClient()\ntime.sleep(1e6)\n"
    world, out = driven_world(tmp_path, endless), tmp_path / "out"
    done = troupe("sweep", world, "--out", out, "--timeout", "0.5", "--log-of", "failed")
    assert done.returncode == 0
    assert "took longer than 0.5 s" in done.stderr
    assert list((out / "logs").iterdir()) == []


def test_the_sweep_file_in_the_documents_is_in_order(tmp_path: Path) -> None:
    text = (ROOT / "docs" / "sweeps.md").read_text()
    (block,) = re.findall(r"^```\n(# sweep\.yaml.*?)^```", text, re.MULTILINE | re.DOTALL)
    path = tmp_path / "sweep.yaml"
    path.write_text(block.replace("samples: 50", "samples: 2"))
    plan = asked_plan(
        [str(path)], seeds=None, settings=(), table=None, duration=None, each=(), about={}
    )
    assert plan.size == 2 * 2 * 5 * 2 * 20
