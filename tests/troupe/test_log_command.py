"""`troupe log` and `troupe.Log`: what they tell of a log, and of what is none."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from click.testing import Result
from typer.testing import CliRunner

import troupe
from sim.log.replay import check
from troupe import tables
from troupe.app import app
from troupe.log import LogError

WORLD = """\
name: "A\\x1b[31mred world"
size: [10, 10]
duration: 12
until: duration
floor: {resolution: 0.1}
models:
  rover:
    body: {shape: box, size: [1, 1]}
    drive: {kind: omnidirectional}
    sensors: [{type: laser, samples: 5}]
    actuators: [{type: sprayer}]
obstacles: [{shape: box, size: [1, 1], pose: [5, 2, 0], movable: true}]
robots:
  - {name: one, model: rover, pose: [2, 2, 0], controller: mine}
  - {model: rover, count: 2, placement: random, controller: null}
doors: [{name: late, at: [8, 8], model: rover, period: 2}]
controllers: {mine: {program: ./mine.py}}
"""
PROGRAM = """\
from player import DioProxy, PlayerClient, Position2dProxy, SpeechProxy

with PlayerClient() as robot:
    base, spray = Position2dProxy(robot), DioProxy(robot)
    speech = SpeechProxy(robot)
    spray.set_output(1)
    for _ in range(60):
        robot.read()
        base.set_speed(0.4, 0.0)
    speech.say("\\x1b[31mover")
    print("\\x1b[31mprinted")
"""


def command(*words: str) -> Result:
    return CliRunner().invoke(app, ["log", *words])


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, object]:
    folder = tmp_path_factory.mktemp("log")
    (folder / "mine.py").write_text(PROGRAM)
    (folder / "world.yaml").write_text(WORLD)
    path = folder / "run.mcap"
    result = troupe.run(folder / "world.yaml", settings=["seed=5"], log=path, log_sensors=["laser"])
    return path, result


def test_a_log_tells_poses_as_the_result_does(run) -> None:
    path, result = run
    log = troupe.Log(path)
    assert log.robots == [robot.name for robot in result.robots]
    assert log.poses.shape == (120, len(result.robots), 3)
    for pose, robot in zip(log.poses[-1], result.robots, strict=True):
        assert tuple(pose) == robot.pose
    late = log.robots.index("late1")
    entered = round(result.robots[late].entered / 0.1)
    assert np.isnan(log.poses[: entered - 1, late]).all()
    assert not np.isnan(log.poses[entered - 1 :, late]).any()
    assert log.result["digest"] == result.digest
    assert log.seed == 5
    assert (log.contacts[-1] == [robot.contacts for robot in result.robots]).all()


def test_a_part_of_a_log_is_cut_by_seconds(run) -> None:
    log = troupe.Log(run[0])
    part = log[2.0:3.0]
    assert part.ticks.tolist() == list(range(20, 30))
    assert part.poses.tobytes() == log.poses[19:29].tobytes()
    assert part[2.5:].ticks.tolist() == list(range(25, 30))
    assert len(log[100.0:]) == 0


def test_the_ends_of_a_part_may_be_any_numbers_and_nothing_else(run, tmp_path: Path) -> None:
    log = troupe.Log(run[0])
    assert len(log[-math.inf : math.inf]) == len(log[-1e300:1e300]) == len(log)
    assert len(log[math.inf :]) == len(log[: -math.inf]) == 0
    assert (log.floor(math.inf) == log.floor()).all()
    for ask in (lambda: log[math.nan :], lambda: log[: math.nan], lambda: log.floor(math.nan)):
        with pytest.raises(ValueError, match="number of simulated seconds"):
            ask()
    out = str(tmp_path / "poses.csv")
    done = command("export", str(run[0]), "-o", out, "--from", "nan")
    assert done.exit_code == 2
    assert "number of simulated seconds" in done.stderr
    assert command("export", str(run[0]), "-o", out, "--until", "inf").exit_code == 0


@pytest.mark.parametrize("table", ["poses", "commands", "scans", "events"])
def test_a_table_of_a_time_when_nothing_was_has_its_columns(
    run, tmp_path: Path, table: str
) -> None:
    pandas = pytest.importorskip("pandas")
    frames = []
    for span in (["--from", "99"], ["--until", "11.5"]):
        for name in ("x.csv", "x.parquet"):
            words = ["export", str(run[0]), "-o", str(tmp_path / name), "--table", table, *span]
            done = command(*words)
            assert done.exit_code == 0, done.output
        frames += [pandas.read_csv(tmp_path / "x.csv"), pandas.read_parquet(tmp_path / "x.parquet")]
    assert [len(frame) for frame in frames[:2]] == [0, 0]
    assert min(len(frame) for frame in frames[2:]) > 0
    assert len({tuple(frame.columns) for frame in frames}) == 1
    assert (frames[1].dtypes == frames[3].dtypes).all()


def test_events_are_those_of_the_time_that_is_asked_for(run) -> None:
    log = troupe.Log(run[0])
    late = log.entries[-1].time
    assert late > 0.0
    for part in (log[late:], log[:late]):
        times = part.to_dataframe("events")["time"].to_numpy()
        kinds = part.to_dataframe("events")["kind"].tolist()
        assert all(part.spans(time) for time in times)
        assert "entry" in kinds


def test_a_table_that_cannot_be_is_told(run, tmp_path: Path) -> None:
    path, out = tmp_path / "bare.mcap", tmp_path / "x.csv"
    out.write_text("kept")
    troupe.run(run[0].parent / "world.yaml", duration=0.5, log=path)
    for words, told in (
        (["--table", "scans"], "there are no scans in the log: `--log-sensors laser` keeps them"),
        (["--from", "5", "--until", "2"], "--until 2: must be later than --from 5"),
        (["--from", "5", "--until", "5"], "--until 5: must be later than --from 5"),
        (["--table", "dreams"], "no table 'dreams'"),
    ):
        done = command("export", str(path), "-o", str(out), *words)
        assert done.exit_code == 2, done.output
        assert told in done.stderr
        assert out.read_text() == "kept"


def test_robots_that_come_late_are_in_a_table_of_long_ago(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    world = {
        "size": [9, 9],
        "duration": 65,
        "models": {"m": {"body": {"shape": "circle", "radius": 0.3}}},
        "robots": [],
        "doors": [{"name": "late", "at": [5, 5], "model": "m", "period": 63}],
    }
    path, out = tmp_path / "run.mcap", tmp_path / "poses.parquet"
    assert tables.PART < 63
    troupe.run(world, log=path)
    done = command("export", str(path), "-o", str(out))
    assert done.exit_code == 0, done.output
    assert pandas.read_parquet(out)["robot"].unique().tolist() == ["late1"]


def test_sensors_of_a_log_may_be_one_text(run, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    world = run[0].parent / "world.yaml"
    troupe.run(world, duration=0.3, log=path, log_sensors="laser, odometry")
    assert {"/one/scan", "/one/odom"} <= set(troupe.Log(path)._reader.topics)


def test_a_log_holds_what_was_said_printed_sensed_and_painted(run) -> None:
    path, result = run
    log = troupe.Log(path)
    assert [(one.time, one.text) for one in log.said] == result.robots[0].said
    assert "[one] \x1b[31mprinted" in [one.text for one in log.lines]
    assert log.scans("one").ranges.shape == (120, 5)
    assert log.coverage[-1] == result.floor.coverage
    floor = log.floor()
    assert floor is not None
    assert (floor > 0).sum() * 0.1**2 == pytest.approx(result.floor.painted_area)
    assert (log.floor(1.0) > 0).sum() < (floor > 0).sum()
    assert [one.state for one in log.controllers if one.robot == "one"][-1] == "finished"
    assert log.world.world.name == "A\x1b[31mred world"
    assert log.movable_poses.shape == (120, 1, 3)


def test_the_world_of_a_log_runs_again_with_equal_poses(run) -> None:
    done = command("check", str(run[0]))
    assert done.exit_code == 0, done.stderr
    assert run[1].digest in done.stdout


def test_check_names_the_first_tick_and_robot_that_differ(
    run, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = troupe.Log(run[0])
    from sim.log import contents  # noqa: PLC0415

    real = contents.sent

    def other(reader, span=contents.ALL):
        rows = real(reader, span)
        late = rows[:1].copy()
        late["tick"], late["vx"], late["time"] = 30, 0.3, 3.0
        return np.concatenate([rows, late])

    monkeypatch.setattr(contents, "sent", other)
    verdict = check(log._reader, run[1].digest)
    assert not verdict.equal
    # a command takes effect one step of physics after its tick's beginning
    assert verdict.tick == 30
    assert verdict.who == "one"
    assert verdict.difference[0] != 0.0


def test_info_prints_no_escape_codes(run) -> None:
    done = command("info", str(run[0]))
    assert done.exit_code == 0, done.stderr
    assert "\x1b" not in done.stdout
    assert "red world" in done.stdout
    assert "/troupe/state" in done.stdout
    assert "late1" in done.stdout


@pytest.mark.parametrize("table", ["poses", "commands", "scans", "events"])
def test_csv_and_parquet_hold_what_a_frame_does(run, tmp_path: Path, table: str) -> None:
    import pandas as pd  # noqa: PLC0415

    log = troupe.Log(run[0])
    frame = log.to_dataframe(table)
    assert len(frame)
    tables.export(log, table, tmp_path / "a.parquet")
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "a.parquet"), frame)
    tables.export(log, table, tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(frame)
    assert list(rows[0]) == list(frame.columns)
    if table == "poses":
        assert [float(row["x"]) for row in rows] == frame["x"].tolist()  # exactly


def test_without_the_extra_export_says_which(run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.import_module", lambda name: (_ for _ in ()).throw(ImportError))
    with pytest.raises(tables.MissingExtra, match="tables"):
        troupe.Log(run[0]).to_dataframe()


def test_damaged_bytes_are_a_clear_error_and_never_another(run, tmp_path: Path) -> None:
    whole = bytearray(run[0].read_bytes())
    random = np.random.default_rng(1)
    broken = tmp_path / "broken.mcap"
    for _ in range(60):
        data = whole.copy()
        for at in random.integers(9, len(data), 5).tolist():
            data[at] ^= 1 << int(random.integers(8))
        broken.write_bytes(data)
        try:
            log = troupe.Log(broken)
            _ = log.poses, log.said, log.commands, log.lines, log.touches, log.ticks
        except LogError:
            continue


def test_a_log_that_cannot_be_written_is_said_before_the_run(run, tmp_path: Path) -> None:
    world = run[0].with_name("world.yaml")
    for log, sensors in ((tmp_path / "no" / "a.mcap", None), (tmp_path / "a.bag", None),
                         (tmp_path / "a.mcap", ["sonar"])):  # fmt: skip
        with pytest.raises(LogError):
            troupe.run(world, log=log, log_sensors=sensors)


def test_a_world_file_can_ask_for_its_log(
    tmp_path: Path, run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    world = run[0].with_name("world.yaml")
    troupe.run(world, duration=1, settings=["log.file=mine.mcap", "log.sensors=laser"])
    assert len(troupe.Log("mine.mcap")) == 10
    assert len(troupe.Log("mine.mcap").scans("one").times) == 10
    assert json.loads(troupe.Log("mine.mcap").about["settings"])
