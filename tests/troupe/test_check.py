"""`troupe check`, `troupe schema` and `troupe sensors`; worlds by path and by name."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

import troupe.worlds
from sensors.registry import SENSORS
from sim.worldfile import WorldError
from sim.worldfile.json_schema import json_schema
from sim.worldfile.models import Gripper, Sprayer
from troupe.commands.check import check
from troupe.commands.schema import schema
from troupe.commands.sensors import sensors
from troupe.worlds import find_world, world_names, worlds_folder

APP = typer.Typer()
APP.command("check")(check)
APP.command("schema")(schema)
APP.command("sensors")(sensors)

WORLD = """\
size: [10, 8]
models: {rover: {body: {shape: circle, radius: 0.3}}}
robots: [{model: rover, count: 3, placement: random, controller: wander}]
"""


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.yaml").write_text(WORLD)
    (tmp_path / "bad.yaml").write_text(WORLD + "duraton: 3\nseed: x\n")
    return tmp_path


def run(*words: str) -> tuple[int, str, str]:
    """Exit code, standard output, standard error."""
    result = CliRunner().invoke(APP, list(words))
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result.exit_code, result.stdout, result.stderr


def test_a_world_in_order_is_told_in_a_line(here: Path) -> None:
    told = "good.yaml: ok (3 robots, 10 x 8 m, controller wander)\n"
    assert run("check", "good.yaml") == (0, told, "")


def test_all_mistakes_stand_on_standard_error_and_the_exit_code_is_2(here: Path) -> None:
    code, out, err = run("check", "bad.yaml")
    assert (code, out) == (2, "")
    lines = err.splitlines()
    assert [line.split(": ")[0] for line in lines] == ["bad.yaml:4:1", "bad.yaml:5:7"]


def test_every_world_is_checked_whatever_the_others_are(here: Path) -> None:
    code, out, err = run("check", "bad.yaml", "good.yaml", "gone.yaml")
    assert code == 2
    assert out.startswith("good.yaml: ok")
    assert "bad.yaml:4:1" in err
    assert "gone.yaml: no such world" in err


def test_settings_are_laid_upon_every_world(here: Path) -> None:
    assert "30 x 20 m" in run("check", "good.yaml", "--set", "size=[30, 20]")[1]
    code, _, err = run("check", "good.yaml", "--set", "size=[3]", "--set", "seed=x")
    assert code == 2
    assert [line.split(": ")[0] for line in err.splitlines()] == ["--set size=[3]", "--set seed=x"]


def test_without_a_world_the_usage_is_told() -> None:
    code, _, err = run("check")
    assert code == 2
    assert "WORLD" in err


@pytest.mark.parametrize("name", world_names())
def test_every_world_that_comes_with_troupe_is_in_order_from_anywhere(
    here: Path, name: str
) -> None:
    code, out, err = run("check", name)
    assert (code, err) == (0, "")
    assert ": ok (" in out


def test_there_are_worlds_that_come_with_troupe() -> None:
    assert "wander" in world_names()


def test_a_path_goes_before_a_name(here: Path) -> None:
    assert find_world("wander").parent == worlds_folder()
    assert find_world("wander.yaml").parent == worlds_folder()
    (here / "wander").mkdir()
    assert find_world("wander").parent == worlds_folder()
    (here / "wander.yaml").write_text(WORLD)
    assert find_world("wander.yaml") == Path("wander.yaml")


@pytest.mark.parametrize(
    ("world", "told"),
    [
        ("wandr", "wandr: no such world; did you mean wander?"),
        ("god.yaml", "god.yaml: no such world; did you mean good.yaml?"),
        ("no/where.yaml", "no/where.yaml: no such world; there is no folder no"),
        (".", ".: is a folder, not a world file"),
        ("", "'': no such world"),
        ("../wander", "../wander: no such world"),
    ],
)
def test_what_is_no_world_is_told_with_a_suggestion(here: Path, world: str, told: str) -> None:
    with pytest.raises(WorldError) as raised:
        find_world(world)
    (mistake,) = raised.value.mistakes
    assert str(mistake).startswith(told)


def test_an_installed_troupe_has_its_worlds_inside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    inside = tmp_path / "troupe" / "worlds"
    inside.mkdir(parents=True)
    (inside / "own.yaml").write_text(WORLD)
    monkeypatch.setattr(troupe.worlds, "__file__", str(tmp_path / "troupe" / "worlds.py"))
    assert world_names() == ["own"]
    assert find_world("own") == inside / "own.yaml"


def test_without_any_worlds_a_path_still_works(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(troupe.worlds, "__file__", str(here / "a" / "troupe" / "worlds.py"))
    assert world_names() == []
    assert find_world("good.yaml") == Path("good.yaml")
    with pytest.raises(WorldError, match="no such world"):
        find_world("wander")


def test_the_schema_is_printed_as_json() -> None:
    code, out, err = run("schema")
    assert (code, err) == (0, "")
    assert json.loads(out) == json_schema()


def test_every_sensor_and_actuator_is_listed_with_every_setting() -> None:
    code, out, err = run("sensors")
    assert (code, err) == (0, "")
    for name, sensor in SENSORS.items():
        assert f"sensor {name}:" in out
        table = out[out.index(f"sensor {name}:") :]
        for setting in sensor.settings.model_fields:
            assert f"\n  {setting} " in table
    for actuator in (Sprayer, Gripper):
        heading = f"actuator {actuator.__name__.lower()}:"
        for setting in actuator.model_fields:
            assert setting == "type" or f"\n  {setting} " in out[out.index(heading) :]


def test_defaults_are_listed_as_a_world_file_writes_them() -> None:
    _, out, _ = run("sensors")
    laser = out[out.index("sensor laser:") :].split("\nsensor ")[0]
    rows = {line.split()[0]: line for line in reversed(laser.splitlines()) if line.strip()}
    assert "[0, 0, 0]" in rows["pose"]
    assert rows["range"].split()[1:3] == ["20", "m"]
    assert rows["samples"].split()[1] == "180"
