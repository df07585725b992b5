"""A log is whole whatever happens to the run or the disk, and the run never suffers from it."""

from __future__ import annotations

import random
import resource
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

troupe.run(sys.argv[1], duration=1e6, log=sys.argv[2], each_tick=tell)
"""


def test_a_log_changes_no_digest(world_with: Callable[..., Path], tmp_path: Path) -> None:
    world = world_with(DRIVE)
    plain = troupe.run(world)
    kept = troupe.run(world, log=tmp_path / "a.mcap")
    full = troupe.run(world, log=tmp_path / "b.mcap", log_sensors=["all"])
    assert plain.digest == kept.digest == full.digest


@pytest.mark.parametrize("trial", range(3))
def test_after_kill_9_all_that_is_older_than_a_second_is_there(
    world_with: Callable[..., Path], tmp_path: Path, trial: int
) -> None:
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
        least = random.Random(trial).uniform(1.5, 3.0)
        for line in process.stdout:
            tick, at = line.split()
            told.append((int(tick), float(at)))
            if told[-1][1] - told[0][1] > least:
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


def test_a_removed_log_ends_the_log_and_not_the_run(
    world_with: Callable[..., Path], tmp_path: Path
) -> None:
    folder = tmp_path / "away"
    folder.mkdir()
    log = folder / "run.mcap"

    def remove(simulation: troupe.Simulation) -> None:
        if folder.exists() and simulation.time > 0.5:
            log.unlink()
            folder.rmdir()

    said: list[str] = []
    with pytest.warns(RuntimeWarning, match="has been removed") as told:
        result = troupe.run(world_with(DRIVE), log=log, each_tick=remove, say=said.append)
    assert result.outcome == "completed"
    assert said.count(str(told[0].message)) == 1


FULL = """\
import resource, signal, sys
import troupe
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
import warnings
with warnings.catch_warnings(record=True) as told:
    warnings.simplefilter("always")
    result = troupe.run(sys.argv[1], log=sys.argv[2], log_sensors=["all"])
print(result.digest)
print([str(one.message) for one in told if "the log ends" in str(one.message)])
"""


def test_a_full_disk_ends_the_log_and_not_the_run(
    world_with: Callable[..., Path], tmp_path: Path
) -> None:
    assert resource.RLIMIT_FSIZE is not None
    world, log = world_with(DRIVE, duration=20.0), tmp_path / "run.mcap"
    done = subprocess.run(
        [sys.executable, "-c", FULL, str(world), str(log)],
        env=environment(), capture_output=True, text=True, check=True, timeout=PATIENCE,
    )  # fmt: skip
    digest, told = done.stdout.splitlines()
    assert digest == troupe.run(world).digest
    assert "s of the run: File too large" in told
