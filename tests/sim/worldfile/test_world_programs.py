"""Controller programs are found by name, without importing them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from world_texts import mistakes_in

from sim.build import load
from sim.worldfile import WorldError
from sim.worldfile.programs import find_program, is_file_name, programs

WORLD = "size: [9, 9]\nmodels: {a: {body: {shape: circle, radius: 1}}}\n"


def test_a_program_that_comes_with_troupe_is_found_by_its_name() -> None:
    assert find_program("wander") == "controllers.wander"
    assert "wander" in programs()


@pytest.mark.parametrize(
    "name",
    ["wandr", "motion", "perception", "__init__", "", ".", "..", "wander.", "../wander", "a b",
     "wander.py", "wander.nothing", "py.typed"],
)  # fmt: skip
def test_nothing_else_is(name: str) -> None:
    assert find_program(name) is None


def test_every_program_that_is_listed_is_found() -> None:
    assert all(find_program(name) == f"controllers.{name}" for name in programs())


def test_finding_imports_nothing() -> None:
    code = (
        "import sys\nfrom sim.worldfile.programs import find_program, programs\n"
        "find_program('wander'), programs()\n"
        "print([name for name in sys.modules if name.split('.')[0] == 'controllers'])"
    )
    root = Path(__file__).resolve().parents[3]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
    )
    assert done.stdout == "[]\n"


def test_a_folder_controllers_of_the_users_own_is_never_meant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "controllers").mkdir()
    (tmp_path / "controllers" / "own.py").write_text('if __name__ == "__main__":\n    pass\n')
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    assert find_program("own") is None
    assert find_program("wander") == "controllers.wander"


@pytest.mark.parametrize(
    ("program", "file"),
    [("wander", False), ("dispersal.robot", False), ("./mine.py", True), ("mine.py", True),
     ("../a/b", True), ("/a/b.py", True)],
)  # fmt: skip
def test_a_slash_or_the_suffix_makes_a_file(program: str, file: bool) -> None:
    assert is_file_name(program) is file


def test_programs_and_commands_that_are_there_are_in_order(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("")
    (tmp_path / "a.out").write_text("#!/bin/sh\n")
    (tmp_path / "a.out").chmod(0o755)
    path = tmp_path / "world.yaml"
    path.write_text(
        WORLD + "controllers:\n  a: {program: ./mine.py}\n  b: {program: mine.py}\n"
        "  c: {command: [./a.out, -p, '{port}'], args: {x: 1}}\n  d: {command: [sh]}\n"
        f"  e: {{command: [{tmp_path / 'a.out'}]}}\n  f: {{program: wander, args: {{speed: 1}}}}\n"
        "robots: [{model: a, pose: [2, 2, 0], controller: d}]\n"
    )
    assert list(load(path).world.controllers) == ["a", "b", "c", "d", "e", "f"]


def test_a_file_that_is_no_executable_is_told_with_what_to_do(tmp_path: Path) -> None:
    (tmp_path / "a.out").write_text("")
    path = tmp_path / "world.yaml"
    path.write_text(WORLD + "controllers: {a: {command: [./a.out]}, b: {command: [a.out]}}\n")
    with pytest.raises(WorldError) as raised:
        load(path)
    first, second = (str(one) for one in raised.value.mistakes)
    assert "the file is not executable" in first
    assert "chmod +x" in first
    assert "did you mean ./a.out?" in second


def test_a_program_of_ones_own_without_its_path_is_told_with_the_path(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("")
    path = tmp_path / "world.yaml"
    path.write_text(WORLD + "controllers: {a: {program: mine}}\n")
    with pytest.raises(WorldError, match=r"did you mean \./mine\.py\?"):
        load(path)


NOT_PROGRAMS = {
    "./mine": "has not a name that ends in .py; did you mean ./mine.py?",
    "/bin/sh": "has not a name that ends in .py",
    "sub/tool": "has not a name that ends in .py",
    "dispersal.robot": "there is no such program",  # a part of one
    "motion": "there is no such program",
    "paint.__main__": "there is no such program",
    "controllers.wander": "there is no such program",
    "x" * 5000: "there is no such program",
    "./" + "x" * 5000: "has not a name that ends in .py",
    "./" + "x" * 5000 + ".py": "there is no such file",
}


@pytest.mark.parametrize("program", NOT_PROGRAMS, ids=range(len(NOT_PROGRAMS)))
def test_what_could_not_be_run_is_refused_with_what_can(tmp_path: Path, program: str) -> None:
    (tmp_path / "mine.py").write_text("")
    (tmp_path / "mine").write_text("")
    (told,) = mistakes_in(tmp_path, f"size: [1, 1]\ncontrollers: {{a: {{program: {program}}}}}")
    assert told.startswith(f"2:28: controllers.a.program: {NOT_PROGRAMS[program]}")
    assert "allowed: " in told
    assert len(told) < 1000


BROKEN = {
    "x = 1\nif x:\nprint(x)\n": ("3:1", "IndentationError: expected an indented block"),
    "a = 1\nb = (2,\n": ("2:5", "SyntaxError: '(' was never closed"),
    "print 'x'\n": ("1:1", "SyntaxError: Missing parentheses"),
    "\n\treturn 3\n": ("2:1", "IndentationError: unexpected indent"),
    "def f():\n    pass\n\nreturn\n": ("4:1", "SyntaxError: 'return' outside function"),
    "x = '\udcff'\n": ("", "SyntaxError: (unicode error)"),
    "# coding: klingon\n": ("", "SyntaxError: "),
    "x = '\0'": ("", ""),
    "(" * 10_000: ("1:", "SyntaxError: too many nested parentheses"),
    "-" * 100_000 + "1": ("", ""),
}


@pytest.mark.parametrize("source", BROKEN, ids=range(len(BROKEN)))
def test_a_program_with_a_mistake_is_told_with_its_own_line(tmp_path: Path, source: str) -> None:
    program = tmp_path / "mine.py"
    program.write_bytes(source.encode(errors="surrogateescape"))
    place, what = BROKEN[source]
    text = (
        "size: [9, 9]\nmodels: {r: {body: {shape: circle, radius: 0.3}}}\n"
        "robots: [{model: r, pose: [3, 3, 0], controller: a}]\ncontrollers: {a: {program: mine.py}}"
    )
    (told,) = mistakes_in(tmp_path, text)
    assert told.startswith(f"{program}:{place}"), told
    assert f"controllers.a.program: {what}" in told


def test_a_program_is_compiled_and_not_run(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.py").write_text("x = '\\d'\nprint('run')\nraise SystemExit(3)\n")
    (tmp_path / "world.yaml").write_text("size: [1, 1]\ncontrollers: {a: {program: mine.py}}")
    assert load(tmp_path / "world.yaml").world.controllers["a"].program == "mine.py"
    assert capfd.readouterr() == ("", "")
