"""What the fork server does for programs: tracebacks, descriptors, environment."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path

import pytest

import troupe
from sim.fleet.launching import environment
from sim.fleet.program import own_traceback
from tests.patience import PATIENCE
from tests.processes import ROOT
from tests.processes import environment as variables

World = Callable[..., Path]


def test_a_traceback_tells_what_was_the_cause(world_with: World) -> None:
    path = world_with(
        """
        def lower():
            return {}["wheel"]

        def middle():
            try:
                lower()
            except KeyError as error:
                raise ValueError("no wheel") from error

        try:
            middle()
        except ValueError:
            raise RuntimeError("cannot drive")
        """
    )
    error = troupe.run(path, duration=0.2).robot("one").error or ""
    told = [error.index(words) for words in ("KeyError: 'wheel'", "ValueError: no wheel",
            "RuntimeError: cannot drive")]  # fmt: skip
    assert told == sorted(told)
    assert "direct cause" in error
    assert "During handling" in error
    assert "runpy" not in error
    assert "sim/fleet" not in error


def test_a_program_whose_name_is_like_the_runners_keeps_its_frames(
    world_with: World, tmp_path: Path
) -> None:
    (tmp_path / "my_runpy.py").write_text("def go():\n    raise OSError('flat tyre')\n")
    error = (
        troupe.run(world_with("import my_runpy\nmy_runpy.go()"), duration=0.2).robot("one").error
    )
    assert 'my_runpy.py", line 2, in go' in (error or "")


def test_what_a_program_runs_by_runpy_keeps_the_frames_in_between(tmp_path: Path) -> None:
    inner = tmp_path / "inner.py"
    inner.write_text("1 / 0\n")
    try:
        import runpy  # noqa: PLC0415

        runpy.run_path(str(inner))
    except ZeroDivisionError as error:
        told = own_traceback(error)
    assert "test_fork_server.py" in told
    assert "run_path" in told


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_a_run_whose_standard_files_are_closed_runs_as_ever(
    world_with: World, tmp_path: Path, closed: str
) -> None:
    path = world_with(
        f"""
        import os, sys
        from player import PlayerClient, Position2dProxy
        sys.stdin.read()
        print("out", flush=True)
        with PlayerClient() as robot:
            base = Position2dProxy(robot)
            while robot.read():
                base.set_speed(0.3)
                if robot.time > 0.5:
                    open({str(tmp_path / "ran")!r}, "w").close()
        """
    )
    command = f'exec "$0" -m troupe run "$1" --json --duration 1 {closed}'
    done = subprocess.run(
        ["sh", "-c", command, sys.executable, str(path)],
        env=variables(),
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE,
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "ran").exists()
    assert ('"outcome": "completed"' in done.stdout) == ("1>&-" not in closed and " >" not in closed
            and not closed.startswith(">"))  # fmt: skip
    assert "Traceback" not in done.stderr


def test_a_fleet_whose_descriptors_are_taken_by_nobody_serves_all_the_same(tmp_path: Path) -> None:
    code = textwrap.dedent(
        f"""
        import os, sys
        os.close(1)
        import troupe
        result = troupe.run("wander", duration=0.3)
        open({str(tmp_path / "outcome")!r}, "w").write(result.outcome)
        """
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env=variables(), cwd=ROOT, check=False, timeout=PATIENCE
    )
    assert done.returncode == 0
    assert (tmp_path / "outcome").read_text() == "completed"


def test_a_robot_is_told_its_place_in_the_order_of_entry() -> None:
    assert environment("s1", 1, "127.0.0.1", None, 7)["TROUPE_NUMBER"] == "7"
    assert "TROUPE_NUMBER" not in environment("s1", 1, "127.0.0.1", None)


def test_a_breakpoint_says_that_there_is_no_terminal(world_with: World) -> None:
    error = troupe.run(world_with("x = 1\nbreakpoint()"), duration=0.2).robot("one").error or ""
    assert 'mine.py", line 2' in error
    assert "`external: true`" in error


def test_a_breakpoint_is_whose_the_environment_says(
    world_with: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONBREAKPOINT", "builtins.print")
    lines: list[str] = []
    troupe.run(world_with("breakpoint('here')"), duration=0.2, say=lines.append)
    assert "[one] here" in lines
