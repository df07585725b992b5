"""A log is whole whatever happens to the run or the disk, and the run never suffers from it."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from time import monotonic

import pytest
from mcap.reader import make_reader

import troupe
from sim.log.errors import LogError
from sim.log.recover import recover
from tests.patience import PATIENCE
from tests.processes import environment

DRIVE = """\
from player import PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        base.set_speed(0.4, 0.3)
"""
RUN = """\
import sys, time
import troupe

def tell(simulation):
    print(simulation.ticks, time.monotonic(), flush=True)

troupe.run(sys.argv[1], duration=1e6, log=sys.argv[2], log_sensors=["all"], each_tick=tell)
"""


def test_a_log_changes_no_digest(world_with: Callable[..., Path], tmp_path: Path) -> None:
    world = world_with(DRIVE)
    plain = troupe.run(world, duration=1.0)
    kept = troupe.run(world, duration=1.0, log=tmp_path / "run.mcap", log_sensors=["all"])
    assert plain.digest == kept.digest


def test_after_kill_9_all_that_is_older_than_a_second_is_there(
    world_with: Callable[..., Path], tmp_path: Path
) -> None:
    # `scripts/kill_logs.py` does it at many moments
    # every tick is told with the clock's time after the log has been given it
    log = tmp_path / "run.mcap"
    with subprocess.Popen(
        [sys.executable, "-c", RUN, str(world_with(DRIVE)), str(log)],
        env=environment(), stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        told: list[tuple[int, float]] = []
        limit = threading.Timer(PATIENCE, process.kill)
        limit.start()
        assert process.stdout is not None
        for line in process.stdout:
            tick, at = line.split()
            told.append((int(tick), float(at)))
            if told[-1][1] - told[0][1] > 1.2:
                process.send_signal(signal.SIGKILL)
                break
        killed = monotonic()
        for line in process.stdout:
            if line.count(" ") == 1 and line.endswith("\n"):
                tick, at = line.split()
                told.append((int(tick), float(at)))
        limit.cancel()
    with pytest.raises(LogError, match="recover"):
        troupe.Log(log)
    saved = recover(log, tmp_path / "whole.mcap")
    with (tmp_path / "whole.mcap").open("rb") as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == saved.messages
    ticks = troupe.Log(tmp_path / "whole.mcap").ticks
    old = [tick for tick, at in told if at < killed - 1.0]
    assert list(ticks[: len(old)]) == old
    assert (ticks == range(1, len(ticks) + 1)).all()


ALONE = {
    "size": [5, 5],
    "duration": 9,
    "models": {"m": {"body": {"shape": "circle", "radius": 0.3}}},
    "robots": [{"name": "one", "model": "m", "pose": [2, 2, 0]}],
}


def test_a_removed_log_ends_the_log_and_not_the_run(tmp_path: Path) -> None:
    folder = tmp_path / "away"
    folder.mkdir()
    log = folder / "run.mcap"

    def remove(simulation: troupe.Simulation) -> None:
        if folder.exists() and simulation.time > 0.5:
            log.unlink()
            folder.rmdir()

    said: list[str] = []
    with pytest.warns(RuntimeWarning, match="has been removed") as told:
        result = troupe.run(ALONE, log=log, each_tick=remove, say=said.append)
    assert result.outcome == "completed"
    assert said.count(str(told[0].message)) == 1


def test_a_full_disk_ends_the_log_and_not_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log, write, room, looked = tmp_path / "run.mcap", os.write, [1 << 30], threading.Event()

    def into_little_room(descriptor: int, data: memoryview) -> int:
        """As the system does it: as much as there is room for, and then an error."""
        left = room[0] - os.fstat(descriptor).st_size
        if left <= 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write(descriptor, data[:left])

    monkeypatch.setattr("sim.log.container.os.write", into_little_room)
    with troupe.Simulation(ALONE) as plain:
        plain.step(50)
        digest = plain.result().digest
    sim = troupe.Simulation(ALONE, log=log)
    sim.step(10)
    assert sim._recorder is not None
    limit = monotonic() + PATIENCE
    while sim._recorder.writer.written < 1.0:
        assert monotonic() < limit
        looked.wait(0.01)
    room[0] = log.stat().st_size + 100  # half of a chunk
    sim.step(40)
    assert sim.result().digest == digest
    with pytest.warns(RuntimeWarning, match="ends at 1.0 s of the run: No space") as told:
        sim.close()
    assert len(told) == 1
    assert log.stat().st_size == room[0] - 100  # no half of a chunk stays
    monkeypatch.undo()
    assert recover(log, tmp_path / "whole.mcap").until == 1.0
