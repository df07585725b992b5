"""However a run ends, none of its processes outlives it."""

from __future__ import annotations

import os
import signal
import subprocess
import time
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest

from tests.patience import PATIENCE
from tests.processes import all_gone, environment, marked, troupe_command

World = Callable[..., Path]

LOOP = """
from player import PlayerClient, Position2dProxy
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    told = False
    while robot.read():
        base.set_speed(0.1)
        if robot.time > 0.5 and not told:
            print("ready", flush=True)
            told = True
"""
STUBBORN = """
import signal
signal.signal(signal.SIGTERM, signal.SIG_IGN)
signal.signal(signal.SIGINT, signal.SIG_IGN)
print("ready", flush=True)
while True:
    pass
"""


class Run:
    """A run in a process of its own, every process of which carries a mark."""

    def __init__(self, path: Path, *words: str) -> None:
        self.mark = uuid.uuid4().hex
        self.process = subprocess.Popen(
            troupe_command("run", str(path), "--duration", "100000", "--json", *words),
            env=environment(TROUPE_TEST_MARK=self.mark),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def until_ready(self) -> None:
        """Wait until the controller has said so."""
        assert self.process.stderr is not None
        for line in self.process.stderr:
            if "ready" in line:
                return
        raise AssertionError("the run ended before its controller was ready")

    def children(self) -> dict[str, list[psutil.Process]]:
        """The fork server's keeper, the fork server, and the controllers."""
        found = [p for p in marked(self.mark) if p.pid != self.process.pid]
        keepers = [p for p in found if p.ppid() == self.process.pid]
        servers = [p for p in found if p.ppid() in [keeper.pid for keeper in keepers]]
        controllers = [p for p in found if p not in keepers + servers]
        return {"keeper": keepers, "server": servers, "controllers": controllers}


@pytest.fixture
def start(world_with: World) -> Iterator[Callable[..., Run]]:
    runs: list[Run] = []

    def begin(program: str = LOOP, *words: str) -> Run:
        runs.append(Run(world_with(program, until="controllers"), *words))
        return runs[-1]

    yield begin
    for run in runs:
        run.process.kill()
        run.process.communicate()
        for process in marked(run.mark):
            process.kill()


@pytest.mark.parametrize("program", [LOOP, STUBBORN])
def test_the_simulator_is_killed(start: Callable[..., Run], program: str) -> None:
    run = start(program)
    run.until_ready()
    assert len(run.children()["controllers"]) == 2
    run.process.kill()
    assert all_gone(run.mark)


@pytest.mark.parametrize("which", ["server", "keeper"])
def test_the_fork_server_or_its_keeper_is_killed(start: Callable[..., Run], which: str) -> None:
    run = start()
    run.until_ready()
    (process,) = run.children()[which]
    process.kill()
    out, _ = run.process.communicate(timeout=PATIENCE)
    assert run.process.returncode == 1
    assert '"failed"' in out
    assert "fork server" in out
    assert all_gone(run.mark)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("program", [LOOP, STUBBORN])
def test_it_is_interrupted_in_the_middle_and_tells_what_it_had(
    start: Callable[..., Run], program: str, number: int
) -> None:
    run = start(program)
    run.until_ready()
    os.kill(run.process.pid, number)
    out, err = run.process.communicate(timeout=PATIENCE)
    assert run.process.returncode == 130
    assert '"outcome": "interrupted"' in out
    assert "Traceback" not in err
    assert all_gone(run.mark)


@pytest.mark.parametrize("delay", [0.05, 0.2, 0.5, 0.9])
def test_it_is_interrupted_in_the_first_second(start: Callable[..., Run], delay: float) -> None:
    # the delay only chooses where in the start-up the signal falls; no result depends on it
    run = start()
    time.sleep(delay)
    os.kill(run.process.pid, signal.SIGINT)
    _, err = run.process.communicate(timeout=PATIENCE)
    # 1: Python itself was starting, and gives up with a message of its own
    gave_up = "Fatal Python error: init" in err or "Could not import runpy" in err
    starting = run.process.returncode == 1 and gave_up
    assert starting or run.process.returncode in (130, -signal.SIGINT), err
    assert all_gone(run.mark)
    if run.process.returncode == 130:
        assert "Traceback" not in err


def test_it_ends_by_itself(start: Callable[..., Run]) -> None:
    run = start(STUBBORN, "--duration", "1", "--patience", "0.3")
    out, _ = run.process.communicate(timeout=PATIENCE)
    assert '"hung"' in out
    assert all_gone(run.mark)
