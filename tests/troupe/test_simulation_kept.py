"""A stepped simulation is kept in a log, and shown in a page between its steps."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import troupe
from sim.log.reader import LogReader
from sim.log.replay import check
from troupe.live.hands import Hands
from troupe.usage import UsageError

sys.path.insert(0, str(Path(__file__).parent / "live"))
from watching import Viewer

WORLD = {
    "size": [8, 6],
    "duration": 3,
    "models": {
        "m": {
            "body": {"shape": "circle", "radius": 0.3},
            "drive": {"kind": "differential"},
            "sensors": [{"type": "laser", "samples": 5}],
        }
    },
    "robots": [
        {"name": "a", "model": "m", "pose": [2, 2, 0]},
        {"name": "b", "model": "m", "pose": [6, 4, 0]},
    ],
}


def drive(sim: troupe.Simulation, ticks: int = 20) -> list[np.ndarray]:
    """Some steps, and the poses after each."""
    poses = []
    sim.command("a", forward=0.3, turn=0.2)
    for tick in range(ticks):
        if tick == 8:
            sim.set_pose("b", (6, 2, 1.0))
            sim.say("b", "lifted")
        sim.step()
        poses.append(sim.poses)
    return poses


def test_a_stepped_run_has_the_same_digest_with_a_log_and_its_log_checks_equal(
    tmp_path: Path,
) -> None:
    with troupe.Simulation(WORLD) as sim:
        drive(sim)
        plain = sim.result().digest
    with troupe.Simulation(WORLD, log=tmp_path / "run.mcap", log_sensors=["laser"]) as sim:
        poses = drive(sim)
        assert sim.result().digest == plain
    log = troupe.Log(tmp_path / "run.mcap")
    assert log.poses.tobytes() == np.array(poses).tobytes()
    assert [(one.robot, one.text) for one in log.said] == [("b", "lifted")]
    assert log.result is not None
    assert log.result["digest"] == plain
    assert log.scans("a").ranges.shape == (20, 5)
    assert check(LogReader(log.path), plain).equal


PUSHED = {
    **WORLD,
    "obstacles": [
        {"shape": "box", "size": [1, 1], "pose": [4, 5, 0], "movable": True},
        {"shape": "box", "size": [1, 1], "pose": [7, 1, 0], "movable": True, "name": "crate"},
    ],
}


@pytest.fixture(scope="module")
def moved(tmp_path_factory: pytest.TempPathFactory) -> LogReader:
    """The log of a run in which a hand puts the crate in the way of `a`, which drives into it."""
    path = tmp_path_factory.mktemp("moved") / "run.mcap"
    with troupe.Simulation(PUSHED, log=path) as sim:
        sim.command("a", forward=0.4, turn=0.0)
        for tick in range(25):
            if tick == 5:
                assert Hands(sim._engine).put_thing(1, (3.2, 2.1, 0.3))
            sim.step()
    return LogReader(path)


def test_a_thing_that_a_hand_has_moved_is_in_the_log_and_moved_again_by_check(
    moved: LogReader,
) -> None:
    [(_, hands)] = moved.messages("/troupe/hands")
    assert (hands["tick"], hands["numbers"].tolist()) == (6, [1])
    assert hands["things"].tolist() == [True]
    assert hands["poses"].tolist() == [3.2, 2.1, 0.3]
    assert check(moved, None).equal


def test_check_names_a_thing_that_does_not_lie_where_it_did(
    moved: LogReader, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sim.log.replay.by_hand", lambda stage, hands: None)
    verdict = check(moved, None)
    assert (verdict.tick, verdict.who) == (6, "crate")
    assert verdict.difference[0] > 3.0


def test_each_run_after_a_reset_has_a_log_of_its_own(tmp_path: Path) -> None:
    with troupe.Simulation(WORLD, log=tmp_path / "run.mcap") as sim:
        drive(sim, 3)
        sim.reset(seed=5)
        drive(sim, 4)
        sim.reset()
    lengths = [len(troupe.Log(tmp_path / name)) for name in ("run.mcap", "run-2.mcap")]
    assert lengths == [3, 4]
    assert troupe.Log(tmp_path / "run-2.mcap").seed == 5
    assert len(troupe.Log(tmp_path / "run-3.mcap")) == 0


def test_the_worlds_own_log_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with troupe.Simulation({**WORLD, "log": "own.mcap"}) as sim:
        drive(sim, 2)
    assert len(troupe.Log("own.mcap")) == 2


def test_a_simulation_that_nobody_closes_leaves_a_whole_log(tmp_path: Path) -> None:
    sim = troupe.Simulation(WORLD, log=tmp_path / "run.mcap")
    drive(sim, 2)
    del sim
    gc.collect()
    assert len(troupe.Log(tmp_path / "run.mcap")) == 2


def test_a_log_that_cannot_be_is_refused_before_the_run(tmp_path: Path) -> None:
    with pytest.raises(troupe.LogError, match="mcap"):
        troupe.Simulation(WORLD, log=tmp_path / "run.txt")
    with pytest.raises(UsageError, match="no log"):
        troupe.Simulation(WORLD, log_sensors=["laser"])
    with pytest.raises(troupe.LogError, match="there is no folder"):
        troupe.Simulation(WORLD, log=tmp_path / "nowhere" / "run.mcap")


def test_a_page_shows_a_simulation_at_once_between_steps_and_at_every_step() -> None:
    with troupe.Simulation(WORLD) as sim:
        window = sim.show(browser=False)
        assert sim.show() is window
        viewer = Viewer(window.address)
        assert viewer.until(lambda m: m.robots == 2).tick == 0
        sim.step(4)
        assert viewer.until(lambda m: m.tick == 4).poses == pytest.approx(sim.poses)
        sim.set_pose("a", (3, 3, 0))
        assert viewer.until(lambda m: m.kind == 2 and m.poses[0, 0] == 3.0).tick == 4
        viewer.ask(do="put", robot=1, pose=[5, 5, 0])
        viewer.until(lambda m: m.kind == 2 and m.poses[1, 1] == 5.0)
        assert sim.poses[1, :2].tolist() == [5.0, 5.0]
        viewer.ask(do="pause")
        assert "a program makes the steps" in viewer.notice()[-1]
        assert [touch.what for touch in sim.result().touched] == ["put"]
        viewer.close()
    assert window.closed


def test_a_page_stays_when_the_simulation_is_reset() -> None:
    with troupe.Simulation(WORLD) as sim:
        viewer = Viewer(sim.show(browser=False).address)
        sim.step(3)
        viewer.until(lambda m: m.tick == 3)
        sim.reset(seed=9)
        viewer.until(lambda m: m.kind == 1)
        assert viewer.until(lambda m: m.kind == 2).tick == 0
        sim.step()
        viewer.until(lambda m: m.tick == 1)
        viewer.close()


def test_a_page_changes_no_digest(still_digest: Callable[[bool], str]) -> None:
    assert still_digest(True) == still_digest(False)


@pytest.fixture
def still_digest() -> Callable[[bool], str]:
    def run(shown: bool) -> str:
        with troupe.Simulation("wander", seed=3, duration=2) as sim:
            viewer = Viewer(sim.show(browser=False).address) if shown else None
            if viewer is not None:
                viewer.until(lambda m: m.robots == 4)
                viewer.ask(do="select", robots=[0])
            while not sim.over:
                sim.step()
            if viewer is not None:
                viewer.close()
            return sim.result().digest

    return run


def test_a_notebook_shows_the_page_in_a_frame() -> None:
    with troupe.Simulation(WORLD) as sim:
        window = sim.show(browser=False)
        assert f'<iframe src="{window.address}"' in window._repr_html_()
        assert window.address in repr(window)
        assert window.address.startswith("http://127.0.0.1:")
        window.close()
        with pytest.raises(UsageError, match="nowhere:at:all"):
            sim.show("nowhere:at:all")
    with pytest.raises(RuntimeError, match="closed"):
        sim.show()
