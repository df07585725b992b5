"""`troupe import`: what it writes, what it prints, and its exit codes."""

from __future__ import annotations

from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner, Result

from sim.build import load
from troupe.commands.import_ import import_

DATA = Path(__file__).parent / "data"

app = typer.Typer()
app.command()(import_)


def run(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


@pytest.mark.parametrize("name", ["yard", "hall", "open"])
def test_the_result_is_a_world_file_in_order(name: str, tmp_path: Path) -> None:
    done = run(DATA / f"{name}.world", "-o", tmp_path / "w.yaml")
    assert done.exit_code == 0, done.stderr
    assert load(tmp_path / "w.yaml").robots
    assert done.stdout.endswith(
        f"w.yaml: written and in order (troupe run {tmp_path / 'w.yaml'})\n"
    )


def test_the_list_names_file_and_line(tmp_path: Path) -> None:
    done = run(DATA / "yard.world", DATA / "yard.cfg", "-o", tmp_path / "w.yaml")
    listed = done.stdout.split("otherwise than in Stage:")[0]
    for where in ("yard.cfg:8: driver vfh", "yard.world:24: camera"):
        assert where in listed
    assert "yard.world:24: a gripper opens and closes at once" in done.stdout


def test_the_report_has_one_line_for_each_thing_and_what_robots_do_otherwise_comes_first(
    tmp_path: Path,
) -> None:
    robots = "".join(
        f'position ( name "r{n}" pose [{n} 0 0 0] gui_nose 1 friction 2 ranger (\n'
        'color "blue" sensor ( samples 9 color "red" ) ) )\n'
        for n in range(30)
    )
    (tmp_path / "many.world").write_text("resolution 0.02\n" + robots)
    done = run(tmp_path / "many.world", "-o", tmp_path / "w.yaml")
    heads = [line for line in done.stdout.splitlines() if line.endswith(":")]
    assert [head.split(",")[0].rstrip(":") for head in heads] == [
        "not carried over", "not carried over", "of no use here",
    ]  # fmt: skip
    assert "behave otherwise" in heads[0]
    first = done.stdout.split(heads[1])[0].splitlines()[1:-1]
    assert len(first) == 1
    assert "many.world:2: friction" in first[0]
    assert "(and in 29 more places)" in first[0]
    assert sum("sensor" in line for line in done.stdout.splitlines()) == 1


def test_strict_fails_on_what_changes_how_robots_behave_and_on_no_looks(tmp_path: Path) -> None:
    for name, text, code in (
        ("looks", 'position ( say "hello" ranger ( color "red" sensor ( samples 9 ) ) )\n', 0),
        ("lost", "position ( camera ( ) )\n", 1),
    ):
        (tmp_path / f"{name}.world").write_text(text)
        words = (tmp_path / f"{name}.world", "-o", tmp_path / f"{name}.yaml")
        assert run(*words).exit_code == 0
        assert run(*words, "--force", "--strict").exit_code == code


def test_without_o_it_is_written_to_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(DATA / "hall.world").exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"hall.yaml", "hall_map.png"}


@pytest.mark.parametrize("name", ["hall.yaml", "hall_map.png"])
def test_no_file_is_written_over_unless_forced(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text("mine")
    words = (DATA / "hall.world", "-o", tmp_path / "hall.yaml")
    done = run(*words)
    assert done.exit_code == 2
    assert f"{name}: exists already" in done.stderr
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [(name, "mine")]
    assert run(*words, "--force").exit_code == 0


@pytest.mark.parametrize("name", ["yard.world", "yard.cfg"])
def test_what_is_imported_is_never_written_over(name: str, tmp_path: Path) -> None:
    for path in DATA.iterdir():
        if path.is_file():
            (tmp_path / path.name).write_bytes(path.read_bytes())
    words = (tmp_path / "yard.world", tmp_path / "yard.cfg", "-o", tmp_path / name, "--force")
    done = run(*words)
    assert done.exit_code == 2
    assert f"{name}: is what is to be imported" in done.stderr
    assert (tmp_path / name).read_bytes() == (DATA / name).read_bytes()


def test_a_mistake_in_the_input_is_told_with_its_place_and_nothing_is_written(
    tmp_path: Path,
) -> None:
    (tmp_path / "bad.world").write_text("resolution 0.02\nmodel ( sise [1 1 1)\n")
    done = run(tmp_path / "bad.world", "-o", tmp_path / "w.yaml")
    assert done.exit_code == 2
    assert "bad.world:2:20: a list holds numbers and strings" in done.stderr
    assert not done.stdout
    assert not (tmp_path / "w.yaml").exists()


def test_a_missing_file_is_a_mistake(tmp_path: Path) -> None:
    done = run(tmp_path / "none.world")
    assert done.exit_code == 2
    assert "No such file" in done.stderr


def test_a_world_that_must_be_mended_is_written_and_the_code_is_1(tmp_path: Path) -> None:
    (tmp_path / "two.world").write_text(
        'position ( name "a" )\nposition ( name "b" pose [0.1 0 0 0] )\n'
    )
    done = run(tmp_path / "two.world", "-o", tmp_path / "w.yaml")
    assert done.exit_code == 1
    assert "must be mended by hand" in done.stdout
    assert "w.yaml:" in done.stderr
    assert "robot a" in done.stderr
    assert (tmp_path / "w.yaml").exists()
