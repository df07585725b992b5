"""The fork server is killed: whoever was driven by its processes has failed, and the run ends."""

from __future__ import annotations

import signal
import socket
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

import psutil
import pytest

from sim.build import load
from sim.engine import Engine, Settings
from sim.fleet.fleet import Fleet, Launch
from sim.run import run_world
from tests.patience import PATIENCE

WORLDS = Path(__file__).resolve().parents[2] / "worlds"


@pytest.fixture
def fleet() -> Iterator[Fleet]:
    fleet = Fleet()
    yield fleet
    fleet.close()


def lose(fleet: Fleet) -> None:
    keeper = psutil.Process(fleet.process.pid)
    while not (found := keeper.children()):
        pass  # it has not forked the fork server yet
    found[0].kill()
    fleet.process.wait()  # the keeper, which outlives it


def is_alive(pid: int) -> bool:
    try:
        return bool(psutil.Process(pid).status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False


def nothing(key: int) -> Launch:
    return Launch("module", "controllers.wander")


@pytest.mark.parametrize("noticed", [False, True])
def test_a_controller_that_is_started_too_late_counts_as_killed(
    fleet: Fleet, noticed: bool
) -> None:
    watched: dict[object, object] = {}
    fleet.attach(watched.__setitem__, watched.pop)
    lose(fleet)
    if noticed:
        fleet.read()
        assert fleet.lost
    ours, theirs = socket.socketpair()
    fleet.start(4, "late", nothing(4), {}, theirs)
    assert fleet.take_ended() == {4: -signal.SIGKILL}
    assert fleet.outputs[4].last_lines() == ""
    assert ours.recv(1) == b""  # its connection is closed, so nobody waits for it
    assert watched == {}
    ours.close()
    fleet.kill(4)  # asks nobody for anything


# at 21.4 s the third robot is half out of the door's cell, at 22.6 s it has left it
@pytest.mark.parametrize("tick", [107, 113])
def test_a_world_with_a_door_ends_by_itself_with_every_robot_named(tick: int) -> None:
    loaded = load(WORLDS / "fcdfs_corridor.yaml")
    lines: list[str] = []
    started: list[int] = []
    before = len(psutil.Process().children(recursive=True))

    def kill(engine: Engine) -> None:
        if engine.ticks == tick:
            started.extend(engine.fleet.pids.values())
            lose(engine.fleet)

    result = run_world(
        loaded,
        Settings(seed=1, duration=loaded.world.duration),
        each_tick=kill,
        say=lines.append,
    )
    assert len(started) >= 2
    assert result.outcome == "controller_failed"
    assert result.sim_time < 0.2 * tick + 1.0  # their ends are known within a few ticks
    assert len(result.robots) == result.doors[0].emitted >= len(started)
    for record in result.robots:
        assert (record.state, record.exit_code) == ("failed", -signal.SIGKILL)
        assert "the fork server has died" in (record.error or "")
        assert any(line.startswith(f"{record.name}: failed") for line in lines)
    until = monotonic() + PATIENCE
    while any(map(is_alive, started)) and monotonic() < until:
        sleep(0.01)
    assert [pid for pid in started if is_alive(pid)] == []
    assert len(psutil.Process().children(recursive=True)) == before
