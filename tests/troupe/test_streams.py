"""Standard output and error: what goes wrong with them, and what must not reach a terminal."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests import started
from tests.patience import PATIENCE
from tests.processes import environment
from troupe.show import Screen

World = Callable[..., Path]


def shell(command: str, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["bash", "-c", f"set -o pipefail; {command.replace('troupe', '$0 -m troupe')}",
         sys.executable],
        env=environment(**variables), capture_output=True, text=True, check=False, timeout=PATIENCE,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("command", "reason"),
    [
        ("troupe run wander --duration 0.3 >/dev/full", "No space left on device"),
        ("troupe run wander --duration 0.3 --json >/dev/full", "No space left on device"),
        ("troupe schema >/dev/full", "No space left on device"),  # longer than a buffer
        ("troupe sensors >/dev/full", "No space left on device"),
        ("troupe --help >/dev/full", "No space left on device"),
    ],
)
def test_output_that_cannot_be_written_is_one_line_and_exit_code_1(
    command: str, reason: str
) -> None:
    done = shell(command)
    assert done.returncode == 1
    assert done.stderr == f"standard output: {reason}\n"


@pytest.mark.parametrize(
    ("command", "code"),
    [
        ("troupe schema | true", 0),
        ("troupe schema | head -1", 0),
        ("troupe sensors | head -1", 0),
        ("troupe worlds | head -1", 0),
        ("troupe --help | true", 0),
        ("troupe run wander --duration 0.3 | true", 0),
        ("troupe run wander --duration 0.3 --set until=controllers --json | true", 1),
    ],
)
def test_a_reader_that_has_enough_is_no_reason_to_complain(command: str, code: int) -> None:
    done = shell(command)
    assert (done.returncode, done.stderr) == (code, "")


def test_standard_error_that_cannot_be_written_harms_nothing() -> None:
    done = shell("troupe check wander nowhere 2>/dev/full")
    assert done.returncode == 2
    assert "wander.yaml: ok" in done.stdout


def test_a_name_that_the_terminal_cannot_show_is_written_out(tmp_path: Path) -> None:
    path = tmp_path / "w\u00f6rld.yaml"
    path.write_text("size: [5, 5]\n")
    done = shell(f"troupe check {path}", PYTHONIOENCODING="ascii")
    assert done.returncode == 0, done.stderr
    assert "w\\xf6rld.yaml: ok" in done.stdout


def test_a_controllers_escape_codes_do_not_reach_the_terminal(
    world_with: World, capsys: pytest.CaptureFixture[str]
) -> None:
    import troupe  # noqa: PLC0415

    screen = Screen(quiet=False)
    path = world_with("print(chr(27) + '[31mred')\nraise SystemExit(chr(27) + 'c')")
    result = troupe.run(path, duration=0.2, say=screen.say)
    told = capsys.readouterr().err
    assert "[one] \\x1b[31mred" in told
    assert "\x1b" not in told
    assert "\x1b[31mred" in (result.robot("one").error or "")  # the result has the very bytes


def test_nothing_foreign_that_a_command_prints_is_obeyed_by_the_terminal(tmp_path: Path) -> None:
    """Names of files, keys, references and programs of a world; each by another way out."""
    evil = "\x1b]0;pwned\x07\x1b[2J\u202e"
    folder = tmp_path / f"world{evil}s"
    folder.mkdir()
    good = "models: {r: {body: {shape: circle, radius: 0.3}}}\n"
    quoted = evil.encode("unicode_escape").decode()
    (folder / f"good{evil}.yaml").write_text(
        f'size: [5, 5]\n{good}robots: [{{model: r, pose: [1, 1, 0], controller: "a{quoted}"}}]\n'
        f'controllers: {{"a{quoted}": {{external: true}}}}\n'
    )
    (folder / f"bad{evil}.yaml").write_text(
        f'size: [5, 5]\n{good}"{quoted}": 1\nname: {{"{quoted}": 2}}\n'
        f'robots: [{{model: "x{quoted}", pose: [1, 1, 0], controller: "y{quoted}"}}]\n'
        f'map: {{file: "z{quoted}.png", resolution: 1}}\n'
        f'controllers: {{"c{quoted}": {{program: "./p{quoted}.py"}}}}\n'
        f'include: "i{quoted}.yaml"\n'
    )
    for command in (
        ["check", f"{folder}/good{evil}.yaml", f"{folder}/bad{evil}.yaml", f"{folder}/no{evil}"],
        ["run", f"{folder}/bad{evil}.yaml"],
        ["run", f"{folder}/good{evil}.yaml", "--video", f"{folder}/gone{evil}/a.mp4"],
        ["run", "wander", "--listen", f"{evil}:1"],
        ["run", "wander", "--set", f"{evil}=1"],
        ["import", f"{folder}/no{evil}.world"],
        ["run", f"{folder}/good{evil}.yaml", "--duration", "0.1", "--patience", "0.1"],
    ):
        done = started.troupe(*command)
        told = done.stdout + done.stderr
        assert done.returncode in (1, 2)
        assert "pwned" in told
        assert not {character for character in told if character in "\x1b\x07\u202e"}


def test_our_own_colours_reach_a_terminal() -> None:
    done = shell("troupe --help", FORCE_COLOR="1", TERM="xterm")
    assert "\x1b[1m" in done.stdout
