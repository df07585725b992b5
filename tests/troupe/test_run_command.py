"""`troupe run`: what it prints where, and its exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

import troupe as package
from sim.result import RobotRecord
from tests.started import troupe
from troupe.app import app
from troupe.commands.run import run
from troupe.summary import robot_line
from troupe.worlds import world_names


def test_a_world_that_comes_with_troupe_runs_by_name_from_anywhere(tmp_path: Path) -> None:
    done = troupe("run", "wander", "--duration", "2", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)  # nothing but the result on standard output
    assert result["outcome"] == "completed"
    assert result["sim_time"] == 2.0
    assert result["ticks"] == 20
    assert set(result) == {
        "world", "seed", "outcome", "sim_time", "wall_time", "speed", "ticks", "digest", "robots",
        "floor", "doors", "touched",
    }  # fmt: skip
    robot = result["robots"][0]
    assert set(robot) == {
        "name", "model", "entered", "start", "pose", "distance", "stalls", "contacts",
        "controller", "devices", "properties", "said",
    }  # fmt: skip
    assert robot["controller"] == {"state": "running", "exit_code": None, "error": None}
    assert robot["devices"] == ["position2d:0", "laser:0"]
    assert set(result["floor"]) == {"coverage", "painted_area", "passes"}
    assert result["digest"].startswith("sha256:")


def test_the_plain_summary_names_every_robot() -> None:
    done = troupe("run", "wander", "--duration", "1")
    assert done.returncode == 0
    for name in ("rover1", "rover2", "rover3", "rover4", "x real time", "sha256:"):
        assert name in done.stdout


def test_quiet_says_nothing_but_the_result(tmp_path: Path) -> None:
    (tmp_path / "loud.py").write_text("print('noise')")
    (tmp_path / "w.yaml").write_text(
        "size: [5, 5]\nduration: 1\nmodels: {r: {body: {shape: circle, radius: 0.3}}}\n"
        "robots: [{model: r, pose: [2, 2, 0], controller: loud}]\n"
        "controllers: {loud: {program: ./loud.py}}\n"
    )
    loud = troupe("run", str(tmp_path / "w.yaml"), "--json")
    quiet = troupe("run", str(tmp_path / "w.yaml"), "--json", "--quiet")
    assert "[r1] noise" in loud.stderr
    assert quiet.stderr == ""
    assert json.loads(quiet.stdout)["outcome"] == "completed"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["run", "nowhere.yaml"], "no such world"),
        (["run", "wander", "--set", "models.rover.drive.max_sped=1"], "did you mean max_speed?"),
        (["run", "wander", "--set", "size"], "size"),
        (["run", "wander", "--duration", "-1"], "duration"),
        (["run", "wander", "--duration", "nan"], "duration"),
        (["run", "wander", "--seed", "-3"], "seed"),
        (["run", "wander", "--video", "run.avi"], ".mp4"),
        (["run", "wander", "--video", "/no/such/folder/run.mp4"], "/no/such/folder"),
        (["run", "wander", "--video", "x.mp4", "--video-size", "big"], "640x840"),
        (["run", "wander", "--video-fps", "9"], "there is no video"),
        (["run", "wander", "--video-speed", "9"], "there is no video"),
        (["run", "wander", "--video-size", "64x64"], "there is no video"),
        (["run", "wander", "--video-show", "fans"], "there is no video"),
        (["run", "wander", "--video", "x.mp4", "--video-show", "fan"], "did you mean 'fans'"),
        (["run", "wander", "--at", "9"], "there is no picture"),
        (["run", "wander", "--picture", "x.gif"], ".png or .svg, not in .gif"),
        (["run", "wander", "--listen", "6665x"], "HOST:PORT"),
        (["run", "wander", "--listen", "nowhere.invalid:0"], "nowhere.invalid"),
        (
            ["disperse", "--grid", "3x3", "--door", "1,1", "--picture", "x.foo"],
            ".png or .svg, not in .foo",
        ),
        (["disperse", "--grid", "3x3", "--door", "1,1", "--video", "a.avi"], ".mp4, not in .avi"),
        (["disperse", "nowhere.txt"], "nowhere.txt: No such file"),
        (["run", "wander", "--patience", "-1"], "patience"),
        (["run", "wander", "--patience", "inf"], "0 to wait for ever"),
        (["disperse", "apartmnt"], "did you mean apartment?"),
        (["run"], "WORLD"),
        (["walk"], "walk"),
        (["run", "wander", "--sed", "1"], "--sed"),
    ],
)
def test_bad_usage_is_told_and_ends_with_2(words: list[str], says: str, tmp_path: Path) -> None:
    done = troupe(*words, cwd=tmp_path)
    assert done.returncode == 2, done.stderr
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_reaches_its_time_limit_ends_with_1() -> None:
    done = troupe("run", "wander", "--duration", "1", "--set", "until=controllers", "--json")
    assert done.returncode == 1
    assert json.loads(done.stdout)["outcome"] == "time_limit"


def test_help_tells_every_command() -> None:
    done = troupe("--help")
    assert done.returncode == 0
    for command in ("run", "worlds", "check", "schema", "sensors", "disperse", "warm"):
        assert command in done.stdout


@pytest.mark.parametrize("removed", [False, True])
def test_a_video_that_cannot_be_written_is_told_and_ends_with_1(
    tmp_path: Path, removed: bool
) -> None:
    folder = tmp_path / "videos"
    folder.mkdir()
    video = folder / "run.mp4"
    if not removed:
        video.symlink_to("/dev/full")
    (tmp_path / "mine.py").write_text(
        "import shutil\nfrom player import PlayerClient, Position2dProxy\n"
        "with PlayerClient() as robot:\n"
        "    base = Position2dProxy(robot)\n"
        "    while robot.read():\n"
        f"        if {removed} and robot.time > 0.5:\n"
        f"            shutil.rmtree({str(folder)!r}, ignore_errors=True)\n"
    )
    (tmp_path / "w.yaml").write_text(
        "size: [5, 5]\nduration: 1\nuntil: duration\n"
        "models: {r: {body: {shape: circle, radius: 0.3}}}\n"
        "robots: [{model: r, pose: [2, 2, 0], controller: mine}]\n"
        "controllers: {mine: {program: ./mine.py}}\n"
    )
    words = ["run", str(tmp_path / "w.yaml"), "--quiet", "--video", str(video)]
    for more in ([], ["--json"]):
        folder.mkdir(exist_ok=True)
        done = troupe(*words, *more)
        assert done.returncode == 1
        assert done.stderr.startswith(f"{video}: the video ends early: "), done.stderr
        assert done.stderr.count("\n") == 1
        assert "video:" not in done.stdout
        assert "sha256:" in done.stdout
    assert json.loads(done.stdout)["outcome"] == "completed"


def test_a_notebook_is_warned_of_a_video_that_ends_early(tmp_path: Path) -> None:
    video = tmp_path / "run.mp4"
    video.symlink_to("/dev/full")
    with pytest.warns(RuntimeWarning, match="the video ends early: No space left"):
        assert package.run("wander", duration=0.5, video=video).outcome == "completed"


def test_a_mistake_of_ours_is_not_taken_for_bad_usage(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken(*words: object, **more: object) -> None:
        raise ValueError("operands could not be broadcast together")

    monkeypatch.setattr("sim.run.run_world", broken)
    with pytest.raises(ValueError, match="broadcast"):
        run("wander", duration=0.1)
    with pytest.raises(typer.Exit) as ended:
        run("wander", duration=-0.1)
    assert ended.value.exit_code == 2
    assert "duration" in capsys.readouterr().err


def test_one_of_a_thing_is_not_called_many() -> None:
    record = RobotRecord("r", "m", 0.0, (0, 0, 0), (0, 0, 0), "finished", contacts=1, stalls=2)
    assert "1 contact, 2 stalls" in robot_line(record, 1)
    record.contacts, record.stalls = 2, 1
    assert "2 contacts, 1 stall" in robot_line(record, 1)


def test_quiet_keeps_the_line_about_an_open_address() -> None:
    done = troupe("run", "wander", "--duration", "0.2", "--quiet", "--listen", "0.0.0.0:0")
    assert done.returncode == 0
    assert done.stderr == (
        "listening on 0.0.0.0: anybody who reaches this address can drive the robots\n"
    )


def test_the_worlds_that_come_with_troupe_are_listed_a_line_each() -> None:
    done = troupe("worlds")
    listed = done.stdout.partition("\n\n")[0].splitlines()
    assert [line.split()[0] for line in listed] == world_names()
    assert all(len(line.split()) > 3 for line in listed)  # each says what it is about
    assert "apartment" in done.stdout.splitlines()[-1]


@pytest.mark.parametrize("name", ["apartment", "apartment.txt", "corridor"])
def test_a_map_that_comes_with_troupe_is_taken_by_its_name(name: str, tmp_path: Path) -> None:
    done = troupe("disperse", name, "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["map"] == name


def test_a_file_goes_before_a_map_of_that_name(tmp_path: Path) -> None:
    (tmp_path / "apartment").write_text("S..\n")
    done = troupe("disperse", "apartment", "--json", cwd=tmp_path)
    assert json.loads(done.stdout)["cells"] == 3


def test_every_option_of_every_command_tells_its_default() -> None:
    """But those that are on or off, which are off."""
    group = typer.main.get_command(app)
    assert isinstance(group, typer.core.TyperGroup)
    for name in group.list_commands(None):  # type: ignore[arg-type]
        command = group.get_command(None, name)  # type: ignore[arg-type]
        assert command is not None
        shown = CliRunner().invoke(app, [name, "--help"]).stdout
        told = [one for one in command.params if not getattr(one, "hidden", False)]
        valued = [one for one in told if not one.required and not getattr(one, "is_flag", False)]
        assert shown.count("[default:") == len(valued), f"{[one.name for one in valued]}\n{shown}"
