"""The digest repeats: whatever the machine does meanwhile, and whoever watches."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest

import troupe
from tests.processes import ROOT, environment, troupe_command

WORLD = ROOT / "worlds" / "wander.yaml"
DURATION = 8.0


@pytest.fixture(scope="module")
def digest() -> str:
    """The digest of an ordinary run."""
    return troupe.run(WORLD, duration=DURATION).digest


def by_command(*words: str, **more: str) -> dict[str, object]:
    """The JSON result of a run by the command line."""
    done = subprocess.run(
        troupe_command("run", str(WORLD), "--duration", str(DURATION), "--json", *words),
        env=environment(**more),
        capture_output=True,
        text=True,
        check=True,
    )
    result: dict[str, object] = json.loads(done.stdout)
    return result


def test_a_second_run_has_the_same_digest(digest: str) -> None:
    assert troupe.run(WORLD, duration=DURATION).digest == digest


def test_a_run_in_another_process_has_the_same_digest(digest: str) -> None:
    assert by_command("--quiet", PYTHONHASHSEED="7")["digest"] == digest


def test_a_run_that_is_stepped_from_outside_has_the_same_digest(digest: str) -> None:
    with troupe.Simulation(WORLD, seed=1, duration=DURATION) as simulation:
        ticks = 0
        while not simulation.over:
            simulation.step()
            ticks += 1
            assert simulation.ticks == ticks
        with pytest.raises(RuntimeError, match="the run is over"):
            simulation.step()
    assert simulation.outcome == "completed"
    assert simulation.result().digest == digest


@pytest.mark.usefixtures("busy")
def test_a_busy_machine_changes_nothing(digest: str) -> None:
    assert troupe.run(WORLD, duration=DURATION).digest == digest


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="no choice of cores here")
def test_one_core_is_enough_for_the_same_digest(digest: str) -> None:
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    try:
        assert troupe.run(WORLD, duration=DURATION).digest == digest
    finally:
        os.sched_setaffinity(0, cores)


def test_a_video_changes_nothing(digest: str, tmp_path: Path) -> None:
    video = tmp_path / "run.mp4"
    assert troupe.run(WORLD, duration=DURATION, video=video).digest == digest
    assert video.stat().st_size > 1000


def test_real_time_changes_nothing(digest: str) -> None:
    assert troupe.run(WORLD, duration=DURATION, realtime=20.0).digest == digest


def test_an_open_port_changes_nothing(digest: str) -> None:
    assert troupe.run(WORLD, duration=DURATION, listen=("127.0.0.1", 0)).digest == digest


def test_another_seed_has_another_digest(digest: str) -> None:
    assert troupe.run(WORLD, seed=2, duration=DURATION).digest != digest
