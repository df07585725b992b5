"""A daemon that a controller leaves behind ends with the run, and nobody else's children do."""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest

import troupe
from sim.result import Result

World = Callable[..., Path]

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only Linux has subreapers")

LEAVES_A_DAEMON = """
import os, signal, sys, time
from player import PlayerClient, Position2dProxy

reading, writing = os.pipe()
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        os.setsid()
        os.write(writing, b"%d" % os.getpid())
        os.closerange(0, 100)
        {goes_on}
    os._exit(0)
os.wait()
with open({told!r}, "wb") as file:
    file.write(os.read(reading, 20))
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    robot.read()
    {then}
    while robot.read():
        pass
"""

SLEEPS = "time.sleep(1000); os._exit(0)"
IS_ANOTHER_PROGRAM = (
    "os.execve(sys.executable, ['daemon', '-c', 'import time; time.sleep(1000)'], {})"
)
KILLS_THE_SERVER = "os.kill(os.getppid(), signal.SIGKILL); time.sleep(1000)"
GOES_ON = "pass"


def alive(pid: int) -> bool:
    try:
        return bool(psutil.Process(pid).status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False


@pytest.fixture
def own() -> Iterator[list[int]]:
    """Children of this process that are nobody else's: one, and a daemon that another has left."""
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(1000)"])
    forks = "import os, time\nif os.fork(): os._exit(0)\nprint(os.getpid(), flush=True)\n"
    leaves = subprocess.Popen(
        [sys.executable, "-c", forks + "time.sleep(1000)"], stdout=subprocess.PIPE, text=True
    )
    assert leaves.stdout is not None
    daemon = int(leaves.stdout.readline())
    leaves.wait()
    leaves.stdout.close()
    yield [child.pid, daemon]
    for pid in (child.pid, daemon):
        psutil.Process(pid).kill()
    child.wait()


@pytest.mark.parametrize("goes_on", [SLEEPS, IS_ANOTHER_PROGRAM])
@pytest.mark.parametrize("then", [KILLS_THE_SERVER, GOES_ON])
def test_a_daemon_ends_with_the_run(
    world_with: World, tmp_path: Path, own: list[int], goes_on: str, then: str
) -> None:
    told = tmp_path / "daemon"
    path = world_with(
        LEAVES_A_DAEMON.replace("{goes_on}", goes_on)
        .replace("{told!r}", repr(str(told)))
        .replace("{then}", then)
    )
    result = troupe.run(path, duration=1.0)
    lost = then == KILLS_THE_SERVER
    assert result.outcome == ("controller_failed" if lost else "completed")
    assert not alive(int(told.read_text()))
    assert all(map(alive, own))


def test_a_run_beside_one_whose_fork_server_is_killed_goes_on(
    world_with: World, tmp_path: Path, own: list[int]
) -> None:
    told = tmp_path / "daemon"
    path = world_with(
        LEAVES_A_DAEMON.replace("{goes_on}", SLEEPS)
        .replace("{told!r}", repr(str(told)))
        .replace("{then}", KILLS_THE_SERVER)
    )
    found: list[Result] = []
    others = {process.pid for process in psutil.Process().children()}  # of other tests here
    other = threading.Thread(target=lambda: found.append(troupe.run("wander", duration=20.0)))
    other.start()
    assert troupe.run(path, duration=1.0).outcome == "controller_failed"
    other.join(600)
    assert [robot.state for robot in found[0].robots] == ["running"] * 4
    assert not alive(int(told.read_text()))
    assert all(map(alive, own))
    left = {process.pid for process in psutil.Process().children()}
    assert left - others <= {own[0]}  # no zombies either
