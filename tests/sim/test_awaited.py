"""For whom the world waits is told: on the bar, when it is given up, when a run is interrupted."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
from collections.abc import Callable
from math import inf
from pathlib import Path

import pytest

import troupe
from sim.fleet.driver import Driver
from sim.fleet.patience import Patience
from sim.fleet.stack import own_frames
from tests.processes import environment, troupe_command
from troupe.show import awaited

World = Callable[..., Path]

HANGS = """
import time
from player import PlayerClient, Position2dProxy
def plan():
    open({ready!r}, "w").close()
    while True:
        time.sleep(600)

{before}
plan()
"""
NO_CLIENT = ""
NO_READ = "robot = PlayerClient()\nbase = Position2dProxy(robot)"
ONE_READ = f"{NO_READ}\nrobot.read()"


@pytest.fixture
def gives_up(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Patience with `one` ends when this file is there; that with others never."""
    ready = tmp_path / "ready"

    def limit(self: Patience, driver: Driver) -> float:
        return 0.0 if driver.record.name == "one" and ready.exists() else inf

    monkeypatch.setattr(Patience, "limit", limit)
    return ready


@pytest.mark.parametrize(
    ("before", "why"),
    [
        (NO_CLIENT, "it has made no PlayerClient"),
        (NO_READ, "it has not called read()"),
        (ONE_READ, "it has not called read() again"),
    ],
)
def test_who_hangs_is_told_what_it_has_not_done_and_where_it_stood(
    world_with: World, gives_up: Path, before: str, why: str
) -> None:
    path = world_with(HANGS.format(ready=str(gives_up), before=before))
    lines: list[str] = []
    result = troupe.run(path, duration=0.5, patience=0.2, say=lines.append)
    one = result.robot("one")
    assert (one.state, one.exit_code) == ("hung", None)  # the signals that ended it were ours
    first, *stack = (one.error or "").splitlines()
    assert first.endswith(f": {why}")
    assert stack[0].endswith("the newest call first:")
    assert [line.partition(", ")[2] for line in stack[1:]] == [
        "line 7 in plan",
        f"line {10 + before.count(chr(10))} in <module>",
    ]
    assert 'mine.py"' in stack[1]
    assert any(line.startswith("one: hung") and f"({why})" in line for line in lines)
    assert [line for line in lines if line.startswith("[one]")] == [f"[one] {x}" for x in stack]


def test_a_program_that_does_not_listen_is_ended_all_the_same(
    world_with: World, gives_up: Path
) -> None:
    before = "import signal\nsignal.signal(signal.SIGUSR1, signal.SIG_IGN)"
    path = world_with(HANGS.format(ready=str(gives_up), before=before))
    one = troupe.run(path, duration=0.5, patience=0.2).robot("one")
    assert (one.state, one.exit_code) == ("hung", None)
    assert len((one.error or "").splitlines()) == 1


def test_the_signal_does_to_a_program_what_it_always_did(world_with: World) -> None:
    path = world_with("import os, signal\nos.kill(os.getpid(), signal.SIGUSR1)")
    one = troupe.run(path, duration=0.2).robot("one")
    assert (one.state, one.exit_code) == ("failed", -signal.SIGUSR1)


def test_the_frames_of_the_runners_are_left_out() -> None:
    lines = [
        "its own last line",
        "Thread 0x00007f0a (most recent call first):",
        '  File "/usr/lib/python3.11/threading.py", line 324 in wait',
        "",
        "Current thread 0x00007f0b (most recent call first):",
        '  File "/home/me/my/runpy.pyx", line 3 in go',
        '  File "<frozen runpy>", line 88 in _run_code',
        '  File "/opt/sim/fleet/program.py", line 70 in run',
        '  File "/opt/sim/fleet/forkserver.py", line 160 in become',
    ]
    assert own_frames(lines) == [
        "Thread, the newest call first:",
        '  File "/usr/lib/python3.11/threading.py", line 324 in wait',
        "Current thread, the newest call first:",
        '  File "/home/me/my/runpy.pyx", line 3 in go',
    ]


@pytest.mark.parametrize("controller", ["{program: ./mine.py}", '{command: ["true"]}'])
def test_a_program_that_never_connects_has_not_finished_without_a_word(
    world_with: World, controller: str
) -> None:
    path = world_with("print('hello')", until="controllers")
    path.write_text(path.read_text().replace("{program: ./mine.py}", controller))
    lines: list[str] = []
    one = troupe.run(path, duration=0.5, say=lines.append).robot("one")
    told = "ended without having connected to its robot"
    assert (one.state, one.exit_code) == ("finished", 0)
    assert (one.error or "").startswith(told)
    assert any(line.startswith(f"one: {told}") for line in lines)


FAILS = """
from player import PlayerClient, Position2dProxy
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        if robot.time > 0.45:
            raise RuntimeError("flat tyre")
"""


def test_fail_fast_ends_the_run_at_the_first_failure(world_with: World) -> None:
    path = world_with(FAILS)
    whole = troupe.run(path)
    short = troupe.run(path, fail_fast=True)
    assert (whole.outcome, whole.sim_time) == ("controller_failed", 3.0)
    assert (short.outcome, short.sim_time) == ("controller_failed", 0.5)
    assert short.exit_code == 1
    assert short.robot("two").state == "running"


def test_fail_fast_waits_for_nobody_else(world_with: World, tmp_path: Path) -> None:
    (tmp_path / "hangs.py").write_text("while True:\n    pass\n")
    path = world_with("raise RuntimeError('flat tyre')")
    path.write_text(path.read_text().replace("{program: wander}", "{program: ./hangs.py}"))
    result = troupe.run(path, fail_fast=True, patience=0)
    assert (result.outcome, result.ticks) == ("controller_failed", 0)


def test_no_patience_at_all_is_patience_for_ever(world_with: World) -> None:
    assert Patience(inf).limit(Driver(0, "program", None)) == inf  # type: ignore[arg-type]
    assert Patience(inf).entry == inf
    assert troupe.run("wander", duration=0.3, patience=0).outcome == "completed"


EMPTY = "size: [5, 5]\nduration: 2\n"
BODIES = EMPTY + (
    "models: {r: {body: {shape: circle, radius: 0.3}}}\nrobots: [{model: r, pose: [2, 2, 0]}]\n"
)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (EMPTY, "there are no robots in this world: nothing drives, for 2 simulated seconds"),
        (
            BODIES,
            "no robot here has a controller: things move by themselves, for 2 simulated seconds",
        ),
        (
            BODIES + "player: {port: 0}\n",
            "no robot here has a controller: things move by themselves, or as clients drive them, "
            "for 2 simulated seconds",
        ),
    ],
)
def test_a_world_in_which_nobody_drives_says_what_it_is_going_to_do(
    tmp_path: Path, text: str, says: str
) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(text)
    lines: list[str] = []
    troupe.run(path, say=lines.append)
    assert says in lines


def test_the_bar_names_a_few_and_counts_the_others() -> None:
    assert awaited({}) == ""
    assert awaited({"one": 2.4}) == "waiting for one (2 s)"
    late = {"r1": 3.0, "r2": 7.0, "r3": 2.0, "r4": 2.0, "r5": 2.0}
    assert awaited(late) == "waiting for r1, r2, r3 and 2 more (7 s)"


def test_on_a_terminal_the_bar_tells_and_ctrl_c_shows_where_it_hangs(
    world_with: World, tmp_path: Path
) -> None:
    path = world_with(HANGS.format(ready=str(tmp_path / "ready"), before=NO_READ))
    ours, theirs = pty.openpty()
    run = subprocess.Popen(
        troupe_command("run", str(path), "--json"),
        env=environment(COLUMNS="200", TERM="xterm"),
        stdout=subprocess.PIPE,
        stderr=theirs,
    )
    os.close(theirs)
    shown = b""
    try:
        while b"waiting for one (" not in shown:
            shown += os.read(ours, 4096)
        run.send_signal(signal.SIGINT)
        while True:
            try:
                shown += os.read(ours, 4096)
            except OSError:  # the other end is closed
                break
        out, _ = run.communicate(timeout=600)
    finally:
        run.kill()
        os.close(ours)
    assert run.returncode == 130
    assert json.loads(out)["outcome"] == "interrupted"
    told = shown.decode().rpartition("one: waited for since ")[2]
    assert "it has not called read()" in told
    assert 'mine.py", line 7 in plan' in told
