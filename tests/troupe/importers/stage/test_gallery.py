"""The gallery: each world as Stage has it, imported, is the same as the one written for Troupe."""

from __future__ import annotations

import math
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import troupe
from tests.processes import ROOT
from troupe.app import app

GALLERY = ROOT / "docs" / "gallery"
KINDS = sorted(path.stem for path in GALLERY.glob("*.world"))
SENSORS = {"leader": ["laser", "blobfinder"], "soccer": ["blobfinder"],
           "foraging": ["laser", "blobfinder"], "landmarks": ["laser", "fiducial"],
           "flock": ["laser", "fiducial"]}  # fmt: skip
"""What is read in a world, where it is not lasers alone."""


def test_there_are_ten_kinds_and_the_page_shows_them_all() -> None:
    page = (ROOT / "docs" / "gallery.md").read_text()
    assert len(KINDS) == 10
    for kind in KINDS:
        assert f"gallery/{kind}.world" in page
        assert f"gallery/{kind}.yaml" in page
        assert f"pictures/gallery/{kind}.png" in page
        assert (ROOT / "docs" / "pictures" / "gallery" / f"{kind}.png").exists()


def arrays(readings: Any) -> dict[str, Any]:
    """What was read, by name: of lists as far as they go, robot by robot.

    Of what was hit only whether anything was: scenes number it in ways of their own.
    """
    found = {name: value for name, value in vars(readings.data).items() if np.ndim(value)}
    if "hits" in found:
        found["hits"] = found["hits"] >= 0
    for name in {"blobs", "fiducials"} & found.keys():
        rows = zip(found[name], found["counts"], strict=True)
        found[name] = np.concatenate([row[:count] for row, count in rows])
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_the_imported_world_moves_and_is_seen_as_ours(kind: str, tmp_path: Path) -> None:
    imported = tmp_path / f"{kind}.yaml"
    words = ["import", str(GALLERY / f"{kind}.world"), "-o", str(imported)]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    worlds = [
        troupe.Simulation(world, seed=1, controllers=False)
        for world in (imported, GALLERY / f"{kind}.yaml")
    ]
    theirs, ours = worlds
    assert theirs.names == ours.names
    sensors = SENSORS.get(kind, ["laser"])
    driven = ours.readings(sensors[0]).robots
    begun = ours.poses[driven]
    for sim in worlds:
        sim.command(driven, forward=0.5, turn=np.linspace(-1.0, 1.0, len(driven)))
        sim.step(20)
    assert (np.hypot(*(ours.poses[driven] - begun)[:, :2].T) > 0.1).any()
    assert theirs.result().digest == ours.result().digest
    for sensor in sensors:
        read = arrays(ours.readings(sensor))
        for name, value in arrays(theirs.readings(sensor)).items():
            assert np.array_equal(value, read[name]), (sensor, name)
    for sim in worlds:
        sim.close()


@pytest.mark.parametrize("kind", KINDS)
def test_its_controllers_work(kind: str) -> None:
    controllers: bool | dict[str, Any] = True
    if kind == "flock":  # a hundred processes are not needed to see that its function works
        controllers = {"flock": runpy.run_path(str(GALLERY / "flock.py"))["drive"]}
    result = troupe.run(GALLERY / f"{kind}.yaml", duration=2.5, controllers=controllers)
    assert result.outcome == "completed", [robot.error for robot in result.robots]
    assert any(robot.distance > 0.1 for robot in result.robots)
    if kind == "landmarks":
        surveyor = result.robot("surveyor")
        assert math.dist(surveyor.properties["place"][:2], surveyor.pose[:2]) < 0.05
