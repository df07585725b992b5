"""A fleet that waits makes no process for a world without controllers, and is as good otherwise."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from sim.build import load
from sim.engine import Settings
from sim.fleet.fleet import Fleet
from sim.run import run_world

QUIET = """\
size: [6, 6]
models: {rover: {body: {shape: circle, radius: 0.2}}}
robots: [{model: rover, count: 3, placement: random}]
"""


def test_a_world_without_controllers_starts_no_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "quiet.yaml").write_text(QUIET)
    loaded = load(tmp_path / "quiet.yaml")
    expected = run_world(loaded, Settings(seed=3, duration=0.5)).digest
    fleet = Fleet(waits=True)
    result = run_world(loaded, Settings(seed=3, duration=0.5), fleet=fleet)
    assert fleet.process is None
    assert result.digest == expected


def test_controllers_are_started_by_a_fleet_that_waits(world_with: Callable[..., Path]) -> None:
    loaded = load(world_with("from player import PlayerClient\nPlayerClient()\n"))
    digests = set()
    for waits in (False, True):
        fleet = Fleet(waits=waits)
        result = run_world(loaded, Settings(seed=3, duration=3.0), fleet=fleet)
        assert [one.state for one in result.robots] == ["finished", "running"]
        assert fleet.process is not None
        assert fleet.process.poll() is not None
        digests.add(result.digest)
    assert len(digests) == 1
