"""Hands: pause, step, pace, put, drive, begin again; and that all of it can be done again."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from watching import Viewer, watched

import troupe
from sim.build import load, load_data
from sim.fleet.patience import Patience
from sim.log.reader import LogReader
from sim.log.replay import check
from sim.view.frames import ABOUT, SOLIDS, STATUS
from sim.view.moment import Moment, Robot
from tests.patience import PATIENCE
from troupe.live.asks import Malformed, parse_ask
from troupe.live.saved_world import saved_world
from troupe.worlds import find_world


def test_a_paused_run_stands_and_a_step_is_one_tick(still: Path) -> None:
    with watched(still, paused=True) as run:
        viewer = Viewer(run.address)
        assert viewer.until(lambda m: m.robots == 2).tick == 0
        for tick in (1, 2, 3):
            viewer.ask(do="step")
            found = viewer.until(lambda m, tick=tick: m.tick == tick)
            found = viewer.until(lambda m: True)  # a while later
            assert found.tick == tick
        viewer.ask(do="step", ticks=10)
        assert viewer.until(lambda m: m.tick >= 13).tick == 13


def test_going_on_and_pausing_say_so(still: Path) -> None:
    with watched(still, paused=True, realtime=5) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="go")
        viewer.until(lambda m: m.tick >= 2)
        viewer.ask(do="pause")
        found = viewer.until(lambda m: STATUS in m.sections and m.json(STATUS)["paused"])
        later = viewer.message()
        assert later.tick == found.tick
    touched = run.result().touched
    assert [(touch.what, touch.tick) for touch in touched] == [("pause", found.tick)]


def test_the_pace_is_what_was_asked_for(still: Path) -> None:
    with watched(still, paused=True, realtime=1) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="pace", factor=0.5)
        viewer.until(lambda m: STATUS in m.sections and m.json(STATUS)["pace"] == 0.5)
        viewer.ask(do="pace", factor=None)
        viewer.until(lambda m: STATUS in m.sections and m.json(STATUS)["pace"] is None)
        viewer.ask(do="go")
        viewer.until(lambda m: m.time > 100)


def test_a_robot_goes_where_it_is_put_and_not_into_walls(still: Path) -> None:
    with watched(still, paused=True) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="put", robot=0, pose=[3.0, 5.0, math.pi])
        found = viewer.until(lambda m: m.robots == 2 and m.poses[0, 0] == 3.0)
        assert found.poses[0].tolist() == pytest.approx([3.0, 5.0, math.pi])
        for pose in ([5.0, 4.0, 0.0], [-1.0, 2.0, 0.0], [8.0, 2.3, 0.0]):  # wall, outside, berta
            viewer.ask(do="put", robot=0, pose=pose)
            assert "anna: there is no room" in viewer.notice()[-1]
        assert viewer.message().poses[0, 0] == 3.0
        viewer.ask(do="step")
        assert viewer.until(lambda m: m.tick == 1).poses[0, :2].tolist() == [3.0, 5.0]
    result = run.result()
    assert result.robot("anna").pose[:2] == (3.0, 5.0)
    assert result.robot("anna").distance == 0.0
    assert result.as_json()["touched"] == [
        {"time": 0.0, "tick": 0, "robot": "anna", "what": "put",
         "numbers": pytest.approx([3.0, 5.0, math.pi])}
    ]  # fmt: skip


def test_a_thing_that_can_be_pushed_can_be_moved(still: Path) -> None:
    with watched(still, paused=True) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="put_thing", robot=0, pose=[2.0, 6.0, 0.0])
        viewer.until(lambda m: m.robots == 2 and m.things[0, 0] == 2.0)
        viewer.ask(do="put_thing", robot=0, pose=[5.0, 4.0, 0.0])
        assert "no room" in viewer.notice()[-1]
        viewer.ask(do="step")
        assert viewer.until(lambda m: m.tick == 1).things.tolist() == [[2.0, 6.0, 0.0]]


def test_what_stands_and_has_a_name_can_be_moved_too(still: Path) -> None:
    still.write_text(still.read_text().replace("color: blue", "color: blue, name: wall"))
    with watched(still, paused=True) as run:
        viewer, other = Viewer(run.address), Viewer(run.address)
        about = viewer.until(lambda m: m.kind == 1).json(ABOUT)
        assert [len(thing.get("parts", ())) for thing in about["things"]] == [0, 1]
        first = viewer.until(lambda m: m.robots == 2)
        assert first.things[1].tolist() == [5.0, 4.0, 0.0]
        assert SOLIDS not in first.sections
        viewer.ask(do="put_thing", robot=1, pose=[4.0, 3.0, 0.0])
        for one in (viewer, other):
            found = one.until(lambda m: SOLIDS in m.sections and m.kind == 2)
            assert found.things[1].tolist() == [4.0, 3.0, 0.0]
            corners = np.frombuffer(found.sections[SOLIDS], "<f4")[-8:].reshape(4, 2)
            assert corners.mean(axis=0).tolist() == [4.0, 3.0]
        viewer.ask(do="put_thing", robot=1, pose=[2.8, 3.0, 0.0])  # on anna
        assert "no room" in viewer.notice()[-1]
        viewer.ask(do="put", robot=0, pose=[4.0, 3.0, 0.0])
        assert "no room" in viewer.notice()[-1]
        viewer.ask(do="put", robot=0, pose=[6.0, 3.0, 0.0])
        viewer.until(lambda m: m.robots == 2 and m.poses[0, 0] == 6.0)
        viewer.ask(do="world")
        again = load_data(yaml.safe_load(viewer.told("world")))
    assert again.layout.fixtures[0].pose[:2] == (4.0, 3.0)
    assert [(one.robot, one.what) for one in run.result().touched] == [
        ("1", "put_thing"),
        ("anna", "put"),
    ]


def test_a_robot_that_nobody_drives_is_driven_by_hand_and_stops_with_its_hand(still: Path) -> None:
    with watched(still, paused=True) as run:
        viewer, other = Viewer(run.address), Viewer(run.address)
        viewer.ask(do="drive", robot=1, twist=[0.0, 0.0, 1.0])
        viewer.ask(do="go")
        viewer.until(lambda m: m.tick > 5 and m.poses[1, 2] > 0.2)
        viewer.close()
        other.until(lambda m: m.tick > 0)
        run_on = other.message()
        while not np.array_equal((now := other.message()).poses[1], run_on.poses[1]):
            run_on = now  # it brakes
    drives = [touch for touch in run.result().touched if touch.what == "drive"]
    assert [touch.numbers for touch in drives] == [(0.0, 0.0, 1.0), (0.0, 0.0, 0.0)]


def test_a_robot_that_a_controller_drives_is_not_driven_by_hand() -> None:
    with watched("wander", paused=True) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="drive", robot=0, twist=[1.0, 0.0, 0.0])
        assert "its controller drives it" in viewer.notice()[-1]


def test_an_external_robot_is_driven_by_hand_and_waited_for_no_more(still: Path) -> None:
    text = still.read_text().replace("pose: [2, 2, 90]}", "pose: [2, 2, 90], controller: mine}")
    still.write_text(text + "controllers:\n  mine: {external: true}\n")
    with watched(still, duration=3.0) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="drive", robot=0, twist=[0.5, 0.0, 0.0])
        result = run.result()
    assert result.robot("anna").distance > 0.5
    assert result.outcome == "completed"


def test_what_hands_did_is_in_the_log_and_can_be_done_again(still: Path, tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    with watched(still, paused=True, duration=4.0, log=log) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="drive", robot=0, twist=[0.3, 0.0, 0.5])
        viewer.ask(do="step", ticks=10)
        viewer.until(lambda m: m.tick == 10)
        # Each to where the other one was: one after the other that could not be.
        for robot, (x, y) in ((1, (3.0, 6.5)), (0, (8.0, 2.0)), (1, (2.0, 2.0))):
            viewer.ask(do="put", robot=robot, pose=[x, y, 0.0])
            viewer.until(lambda m, robot=robot, x=x: m.poses[robot, 0] == x)
        viewer.ask(do="drive", robot=1, twist=[1.0, 0.0, 0.0])
        viewer.ask(do="put_thing", robot=0, pose=[3.2, 2.0, 0.0])  # where it will be pushed
        viewer.ask(do="go")
        by_hand = run.result()
    assert {touch.what for touch in by_hand.touched} == {"drive", "put", "put_thing"}
    assert by_hand.robot("berta").contacts == 1
    verdict = check(LogReader(log), by_hand.digest)
    assert verdict.equal, verdict
    assert verdict.digest == by_hand.digest


CONTROLLED = """
controllers: {ahead: {program: ./ahead.py}}
"""
AHEAD = """\
from player import PlayerClient, Position2dProxy

with PlayerClient() as robot:
    Position2dProxy(robot).set_speed(0.2)
    while robot.read():
        pass
"""


def test_a_hand_takes_a_robot_from_its_controller_and_gives_it_back(
    still: Path, tmp_path: Path
) -> None:
    text = still.read_text().replace("pose: [8, 2, 0]}", "pose: [8, 2, 90], controller: ahead}")
    still.write_text(text + CONTROLLED)
    (tmp_path / "ahead.py").write_text(AHEAD)
    log = tmp_path / "run.mcap"
    with watched(still, paused=True, duration=3.0, log=log) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="select", robots=[1])

        def after(tick: int) -> float:
            """How fast the robot drives ahead after a tick."""
            viewer.ask(do="step", ticks=10)
            card = viewer.until(lambda m: m.tick == tick and 17 in m.sections).json(17)["1"]
            return float(card["twist"][0])

        assert after(10) == pytest.approx(0.2, abs=0.01)
        viewer.ask(do="take", robot=1)
        card = viewer.until(lambda m: m.json(17)["1"]["taken"]).json(17)["1"]
        assert card["drivable"]
        viewer.ask(do="drive", robot=1, twist=[-0.5, 0.0, 0.0])
        assert after(20) == pytest.approx(-0.5, abs=0.01)
        viewer.ask(do="give", robot=1)
        assert after(30) == pytest.approx(0.2, abs=0.01)  # its controller has said so once
        result = run.result()
    assert [touch.what for touch in result.touched] == ["take", "drive", "give"]
    assert check(LogReader(log), result.digest).equal


def test_who_goes_gives_back_what_it_has_taken() -> None:
    with watched("wander", paused=True) as run:
        viewer, other = Viewer(run.address), Viewer(run.address)
        viewer.ask(do="take", robot=0)
        other.ask(do="select", robots=[0])
        other.until(lambda m: 17 in m.sections and m.json(17)["0"]["taken"])
        viewer.close()
        other.until(lambda m: 17 in m.sections and not m.json(17)["0"]["taken"])


def test_a_card_tells_how_long_each_tick_waited() -> None:
    with watched("wander", paused=True) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="select", robots=[0])
        viewer.until(lambda m: 17 in m.sections)
        for tick in (5, 10):
            viewer.ask(do="step", ticks=5)
            card = viewer.until(lambda m, tick=tick: m.tick == tick).json(17)["0"]
        waits = card["waits"]
    assert len(waits["ticks"]) >= 5
    assert all(wait > 0 for wait in waits["ticks"])
    assert waits["longest"] >= max(waits["ticks"])


def test_the_world_is_saved_as_it_stands(still: Path) -> None:
    with watched(still, paused=True) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="put", robot=0, pose=[3.0, 5.0, math.pi])
        viewer.ask(do="put_thing", robot=0, pose=[2.0, 7.0, 0.0])
        viewer.until(lambda m: m.robots == 2 and m.poses[0, 0] == 3.0 and m.things[0, 0] == 2.0)
        viewer.ask(do="world")
        text = viewer.told("world")
    still.write_text(text)
    again = load(still)
    assert again.start == pytest.approx(np.array([[3, 5, math.pi], [8, 2, 0]]), abs=1e-4)
    assert [tuple(thing.pose) for thing in again.layout.movables] == [(2.0, 7.0, 0.0)]


def test_a_world_of_doors_and_programs_is_saved_so_that_it_can_be_run() -> None:
    loaded = load(find_world("wander"))
    entered = [Robot("late1", "rover")]
    robots = [Robot(robot.name, robot.model) for robot in loaded.robots]
    poses = np.concatenate([loaded.place(1), [[8, 10, 0.5]]]).astype(np.float32)
    colors, states = np.zeros(5, np.uint32), np.zeros(5, np.uint8)
    now = Moment(1.0, 10, poses, colors, states, [*robots, *entered], status={"seed": 7})
    data = yaml.safe_load(saved_world(loaded, now))
    names = [robot["name"] for robot in data["robots"]]
    assert names == [*(robot.name for robot in robots), "entered_late1"]
    assert data["robots"][0]["controller"] == loaded.robots[0].controller
    assert data["seed"] == 7
    built = load_data(data, folder=loaded.folder)
    assert built.start == pytest.approx(poses.astype(float), abs=1e-4)


def test_a_run_begins_again_with_the_same_seed_or_another() -> None:
    with watched("wander", duration=2.0, stays=True) as run:
        viewer = Viewer(run.address)
        seeds = []
        for seed in (5, None):
            viewer.until(lambda m: STATUS in m.sections and m.json(STATUS)["outcome"] is not None)
            viewer.ask(do="again", seed=seed)
            viewer.until(lambda m: m.kind == 1)
            found = viewer.until(lambda m: STATUS in m.sections)
            seeds.append(found.json(STATUS)["seed"])
        viewer.until(lambda m: STATUS in m.sections and m.json(STATUS)["outcome"] is not None)
        run.stop()
        again = run.result()
    assert seeds == [5, 5]
    assert again.seed == 5
    assert again.digest == troupe.run("wander", duration=2.0, seed=5).digest


def test_a_run_that_stood_stands_at_its_beginning_when_it_begins_again(still: Path) -> None:
    with watched(still, paused=True) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="step", ticks=3)
        viewer.until(lambda m: m.tick == 3)
        viewer.ask(do="again", seed=5)
        viewer.until(lambda m: m.kind == 1)
        found = viewer.until(lambda m: STATUS in m.sections)
        assert found.tick == 0
        assert found.json(STATUS)["paused"]
        assert viewer.message().tick == 0
        viewer.ask(do="step")
        assert viewer.until(lambda m: m.tick > 0).tick == 1


def test_pausing_times_no_controller_out() -> None:
    patience = 0.5  # wall-clock seconds: the pause is longer, by what the run itself looks at
    with watched("wander", duration=1.0, paused=True, patience=patience) as run:
        viewer = Viewer(run.address)
        viewer.until(lambda m: m.robots == 4)
        assert run.view is not None
        engine = run.view.watch._engine
        assert engine is not None
        looked = engine.crew.look_at
        while engine.crew.look_at < looked + 6 * patience:  # it has looked for who hangs, often
            viewer.message()
        assert {robot.record.state for robot in engine.robots} == {"running"}
        engine.crew.patience = Patience(PATIENCE)  # the machine may be slow
        viewer.ask(do="go")
        result = run.result()
    assert result.outcome == "completed"


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", "{}", "nonsense", '{"do": "fly"}', '{"do": "put", "robot": 0}',
        '{"do": "put", "robot": -1, "pose": [0, 0, 0]}', '{"do": "pace", "factor": "fast"}',
        '{"do": "put", "robot": 0, "pose": [0, 0, 1e999]}', '{"do": "step", "ticks": 1e9}',
        '{"do": "put", "robot": true, "pose": [0, 0, 0]}', '{"do": "select", "robots": 3}',
        '{"do": "again", "seed": -1}', '{"do": "drive", "robot": 0, "twist": [0, 0]}', "[" * 4000,
        b"bytes",
    ],
)  # fmt: skip
def test_what_no_page_sends_is_malformed(text: str | bytes) -> None:
    with pytest.raises(Malformed):
        parse_ask(text)
