"""A run and its log are the same evidence, and a judge's verdict on both is the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import troupe
from sim.log.errors import LogError
from troupe.testing import Evidence, Watch, clearances, contacts, distances, first_difference
from troupe.testing.paint.judge import Judged, judged, judged_run

WORLD = {
    "size": [8, 6],
    "duration": 6,
    "until": "duration",
    "models": {
        "rover": {"body": {"shape": "circle", "radius": 0.3}, "sensors": [{"type": "laser"}]},
        "cart": {
            "body": {"shape": "box", "size": [0.6, 0.4]},
            "actuators": [{"type": "sprayer", "size": [0.6, 0.4]}],
        },
    },
    "map": {"file": "cells.txt", "cell": 2.0},
    "obstacles": [
        {"shape": "box", "size": [0.5, 0.5], "pose": [5.5, 3, 30]},
        {
            "shape": "circle",
            "radius": 0.2,
            "pose": [3.6, 3, 0],
            "movable": True,
            "mass": 1,
            "name": "puck",
        },
    ],
    "robots": [{"name": "cart", "model": "cart", "pose": [1, 3, 0]}],
    "doors": [{"name": "door", "at": "S", "model": "rover", "heading": 0, "period": 0.5}],
}


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Evidence, troupe.Log]:
    """A cart that sprays pushes a disc against a box, while a robot has come in by a door."""
    folder = tmp_path_factory.mktemp("evidence")
    (folder / "cells.txt").write_text("..S.\n....\n#...\n")
    world = troupe.World(WORLD, folder=folder)
    watch = Watch()

    def drive(simulation: troupe.Simulation) -> None:
        watch(simulation)
        simulation.command("cart", forward=0.8)
        simulation.spray("cart", simulation.time > 1.0)

    troupe.run(world, log=folder / "run.mcap", each_tick=drive)
    return watch.evidence, troupe.Log(folder / "run.mcap")


def test_a_run_and_its_log_are_the_same_evidence(both: tuple[Evidence, troupe.Log]) -> None:
    watched, log = both
    kept = Evidence.of(log)
    assert first_difference(watched, kept) is None
    assert watched.names == kept.names == ["cart", "door1"]
    for name in ("starts", "times", "poses", "movable_poses", "painted"):
        np.testing.assert_array_equal(getattr(watched, name), getattr(kept, name), err_msg=name)
    assert len(watched.painted) > 100
    assert np.isnan(watched.poses[:, 1]).any()
    np.testing.assert_array_equal(distances(watched), distances(kept))
    np.testing.assert_array_equal(clearances(watched), clearances(kept))
    assert contacts(watched) == contacts(kept)


def test_what_stands_is_known_by_its_name_or_its_place_in_the_file(
    both: tuple[Evidence, troupe.Log],
) -> None:
    around = both[0].around
    assert [thing.name for thing in around.standing] == ["obstacle 0", "map"]
    assert [name for name, _ in around.movables] == ["puck"]
    pushed = [one for one in contacts(both[0], deeper_than=1e-6) if one.other == "puck"]
    assert pushed or clearances(both[0])[:, 0].min() < 0.01  # pressed against, and no deeper


def test_only_what_is_a_log_is_evidence(tmp_path: Path) -> None:
    (tmp_path / "no.mcap").write_bytes(b"nothing")
    with pytest.raises(LogError):
        Evidence.of(tmp_path / "no.mcap")
    with pytest.raises(RuntimeError, match="nothing has been watched"):
        _ = Watch().evidence


def test_the_verdict_on_a_run_of_paint_is_that_on_its_log(tmp_path: Path) -> None:
    log = tmp_path / "paint.mcap"
    run = judged_run("paint_tall", 22, duration=40.0, log=log)  # at the goals, and painting
    kept = judged(log)

    def verdict(one: Judged) -> tuple[object, ...]:
        return (one.faults, one.right, one.contacts, one.swaps, one.painted_outside, one.measures)

    assert verdict(run) == verdict(kept)
    assert run.faults == ["outcome time_limit"]
    metres = [run.measures[name] for name in ("off_goal", "painted_outside")]
    assert run.measures | {"off_goal": 0, "painted_outside": 0} == {
        "right": 3, "contacts": 0, "passings": 0, "off_goal": 0, "painted_outside": 0,
    }  # fmt: skip
    assert max(metres) < 0.1
    assert len(run.seen.painted) > 1000
    assert 0.0 <= run.painted_outside < 0.1
