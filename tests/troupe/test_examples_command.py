"""`troupe examples`: what ships, and copies that can be run."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from sim.build import load
from tests.processes import ROOT
from troupe.app import app
from troupe.examples import examples


def troupe(*words: str) -> tuple[int, str]:
    done = CliRunner().invoke(app, ["examples", *words])
    return done.exit_code, done.output


def test_there_are_ten_and_each_has_a_line() -> None:
    code, out = troupe()
    assert code == 0
    lines = out.split("\n\n", maxsplit=1)[0].splitlines()
    assert [line.split("_")[0] for line in lines] == [f"{n:02}" for n in range(1, 11)]
    for line in lines:
        assert len(line) <= 120
        assert line.endswith((".", "?"))


def test_no_folder_is_forgotten() -> None:
    folders = [path.name for path in sorted((ROOT / "examples").iterdir()) if path.is_dir()]
    assert [example.name for example in examples()] == folders


@pytest.mark.parametrize("name", ["03_find_blob", "find_blob", "3", "03"])
def test_one_tells_how_it_is_run(name: str) -> None:
    code, out = troupe(name)
    assert code == 0
    assert "    troupe run world.yaml" in out
    assert "find_blob.py world.yaml" in out


def test_a_copy_has_all_that_it_needs(tmp_path: Path) -> None:
    code, out = troupe("light_seeker", "--copy", str(tmp_path / "mine" / "light"))
    assert code == 0
    made = sorted(path.name for path in (tmp_path / "mine" / "light").iterdir())
    assert made == ["light_seeker.py", "photocell.py", "world.yaml"]
    assert f"cd {tmp_path / 'mine' / 'light'}" in out
    assert load(tmp_path / "mine" / "light" / "world.yaml").robots


def test_without_a_name_all_are_copied_each_into_its_folder(tmp_path: Path) -> None:
    assert troupe("--copy", str(tmp_path))[0] == 0
    for example in examples():
        assert load(tmp_path / example.name / "world.yaml").robots or example.name == "10_disperse"


def test_what_is_there_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "world.yaml").write_text("mine")
    code, out = troupe("1", "--copy", str(tmp_path))
    assert code == 2
    assert f"{tmp_path / 'world.yaml'}: is there already; nothing was copied" in out
    assert [path.name for path in tmp_path.iterdir()] == ["world.yaml"]
    assert (tmp_path / "world.yaml").read_text() == "mine"


def test_a_folder_that_cannot_be_made_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    code, out = troupe("1", "--copy", str(tmp_path / "file" / "deep"))
    assert code == 2
    assert str(tmp_path / "file") in out
    code, out = troupe("1", "--copy", str(tmp_path / "file"))
    assert (code, f"{tmp_path / 'file'}: is not a folder" in out) == (2, True)


def test_a_wrong_name_is_told_with_a_near_one() -> None:
    code, out = troupe("wonder")
    assert code == 2
    assert "there is no example 'wonder'; did you mean wander?" in out


def test_examples_ship_with_the_package() -> None:
    wheel = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["hatch"]["build"]
    assert wheel["targets"]["wheel"]["force-include"]["examples"] == "troupe/examples"
