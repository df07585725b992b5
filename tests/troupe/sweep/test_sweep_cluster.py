"""A sweep on a cluster: its workers may start controllers, and may die."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import psutil
import pytest

from tests.patience import PATIENCE
from tests.processes import environment
from tests.troupe.sweep.sweeping import driven_world, plan_of
from troupe.sweep.collect import csv_of, gather
from troupe.sweep.session import How, sweep
from troupe.usage import UsageError

pytestmark = pytest.mark.skipif(find_spec("distributed") is None, reason="needs distributed")

DRIVES = """\
from player import LaserProxy, PlayerClient, Position2dProxy
with PlayerClient() as robot:
    base, laser = Position2dProxy(robot), LaserProxy(robot)
    while robot.time < 1.0 and robot.read():
        base.set_speed(0.2, 0.1)
"""


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler's address and its three workers, each a process as on three machines."""
    import distributed  # noqa: PLC0415 - a second, for each process that collects the tests

    where = tmp_path / "scheduler.json"
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1",
               "--port", "0", "--no-dashboard", "--scheduler-file", str(where)]  # fmt: skip
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny",
              "--no-dashboard", "--scheduler-file", str(where),
              "--local-directory", str(tmp_path)]  # fmt: skip
    started = []
    try:
        for words in (command, worker, worker, worker):
            started.append(subprocess.Popen(words, env=environment(), cwd=tmp_path, stderr=-3))
        with distributed.Client(scheduler_file=str(where), timeout=PATIENCE) as client:
            client.wait_for_workers(3, timeout=PATIENCE)
            address = client.scheduler.address
        yield address, started[1:]
    finally:
        for process in started:
            process.kill()
            process.wait()


def test_a_worker_that_is_killed_costs_its_runs_a_second_try(
    tmp_path: Path, cluster: tuple[str, list[subprocess.Popen[bytes]]]
) -> None:
    address, workers = cluster
    plan = plan_of(driven_world(tmp_path, DRIVES), "0:12")
    out = tmp_path / "cluster"
    killed: list[list[psutil.Process]] = []

    def kill_one() -> bool:
        """Asked between two looks: when there are results, one of the three is killed."""
        if not killed and len(list((out / "runs").glob("*/result.json"))) >= 2:
            victim = psutil.Process(workers[0].pid)
            killed.append(victim.children(recursive=True))
            victim.kill()
        return False

    found = sweep(plan, out, How(dask=address, quiet=True), kill_one)
    assert found.ran == {"completed": 12}
    assert killed
    assert not psutil.wait_procs(killed[0], timeout=PATIENCE)[1]
    sweep(plan, tmp_path / "here", How(jobs=2, quiet=True))
    tables = [csv_of(gather([tmp_path / name]).results) for name in ("cluster", "here")]
    assert tables[0] == tables[1]


def test_an_address_where_nobody_answers_is_a_mistake(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("troupe.sweep.cluster.CONNECT", 0.1)
    plan = plan_of(driven_world(tmp_path, DRIVES), "0:1")
    with pytest.raises(UsageError, match="no scheduler answers"):
        sweep(plan, tmp_path / "out", How(dask="tcp://127.0.0.1:1", quiet=True))


def test_without_the_extra_it_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    plan = plan_of(driven_world(tmp_path, DRIVES), "0:1")
    with pytest.raises(UsageError, match=r"troupe-sim\[cluster\]"):
        sweep(plan, tmp_path / "out", How(dask="tcp://127.0.0.1:1", quiet=True))
