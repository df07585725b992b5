"""A log in the page: any time of it, forwards and back, as the run was then."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from watching import Viewer

import troupe
from sim.view.frames import ABOUT, CARDS, SAID, STATUS, WAYS
from tests.patience import PATIENCE
from troupe.live.opening import LogView

WORLD = """\
name: a log to be played
size: [10, 8]
duration: 12
until: duration
floor: {resolution: 0.25}
models:
  rover:
    body: {shape: circle, radius: 0.4, color: green}
    drive: {kind: differential}
    odometry_noise: {slip: 0.02}
    sensors: [{type: laser, samples: 31}, {type: bumper}]
    actuators: [{type: sprayer}]
robots:
  - {name: anna, model: rover, pose: [2, 2, 0], controller: drive}
  - {name: berta, model: rover, pose: [3, 6, 180], controller: quick}
doors: [{name: late, at: [8, 2], model: rover, period: 40}]
controllers: {drive: {program: ./drive.py}, quick: {program: ./quick.py}}
"""
DRIVE = """\
from player import DioProxy, PlayerClient, Position2dProxy, SpeechProxy

with PlayerClient() as robot:
    base, speech, spray = Position2dProxy(robot), SpeechProxy(robot), DioProxy(robot)
    base.set_speed(0.4, 0.2)
    print("off I go")
    for tick in range(1, 200):
        if not robot.read():
            break
        if tick == 50:
            speech.say("half way")
            spray.set_output(1)
"""
QUICK = """\
from player import PlayerClient, Position2dProxy, SimulationProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    base.set_speed(1.0)
    for _ in range(80):
        robot.read()
    SimulationProxy(robot).report("rank", 3)
"""


class Watched:
    """A log that is watched, played in a thread of its own."""

    def __init__(self, log: Path, **options: Any) -> None:
        self.stop = threading.Event()
        self.view = LogView(troupe.Log(log), browser=False, warn=lambda line: None, **options)
        self.view.__enter__()
        self.thread = threading.Thread(
            target=self.view.play, args=(lambda: not self.stop.is_set(),)
        )
        self.thread.start()

    @property
    def address(self) -> str:
        return self.view.address

    def close(self) -> None:
        self.stop.set()
        self.thread.join(PATIENCE)
        self.view.__exit__(None, None, None)


@contextlib.contextmanager
def watched_log(log: Path, **options: Any) -> Iterator[Watched]:
    run = Watched(log, **options)
    try:
        yield run
    finally:
        run.close()


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("played")
    (folder / "world.yaml").write_text(WORLD)
    (folder / "drive.py").write_text(DRIVE)
    (folder / "quick.py").write_text(QUICK)
    troupe.run(folder / "world.yaml", log=folder / "run.mcap", log_sensors=["odometry"])
    return folder / "run.mcap"


def test_a_log_begins_paused_and_tells_what_happened_in_it(log: Path) -> None:
    with watched_log(log) as run:
        viewer = Viewer(run.address)
        about = viewer.until(lambda m: ABOUT in m.sections).json(ABOUT)
        first = viewer.until(lambda m: m.robots == 2)
        assert first.tick == 1
        assert first.json(STATUS)["paused"]
    line = about["log"]
    assert (line["from"], line["until"]) == (pytest.approx(0.1), pytest.approx(12.0))
    assert line["said"] == [[pytest.approx(5.0, abs=0.2), 0, "half way"]]
    assert [end[1:3] for end in line["ends"]] == [[1, "finished"]]
    assert line["outcome"] == "completed"
    assert not about["again"]
    assert line["measures"]["ended"] == [[0.0, 0], [pytest.approx(7.9, abs=0.2), 1], [12.0, 1]]
    covered = line["measures"]["coverage"][-1][1]
    assert covered == pytest.approx(troupe.Log(log).coverage[-1], abs=1e-5)


def test_every_time_that_is_asked_for_shows_the_poses_of_that_time(log: Path) -> None:
    kept = troupe.Log(log)
    with watched_log(log) as run:
        viewer = Viewer(run.address)
        for time in (3.0, 11.95, 0.1, 7.33, 99.0):
            viewer.ask(do="seek", time=time)
            tick = min(int(time / 0.1 + 1e-9), 120)
            found = viewer.until(lambda m, tick=tick: m.kind == 2 and m.tick == tick)
            now = kept.poses[tick - 1]
            here = ~np.isnan(now[:, 0])
            assert found.robots == here.sum()
            assert found.poses == pytest.approx(now[here], abs=1e-5)
            assert WAYS in found.sections


def test_what_was_said_and_painted_later_is_gone_when_one_goes_back(log: Path) -> None:
    kept = troupe.Log(log)
    with watched_log(log) as run:
        viewer = Viewer(run.address)
        shown = np.zeros((32, 40), np.int16)

        def at(time: float) -> Any:
            viewer.ask(do="seek", time=time)
            tick = round(time / 0.1)

            def there(message: Any) -> bool:
                if message.kind == 2:
                    message.paint(shown)
                return bool(message.kind == 2 and message.tick == tick)

            return viewer.until(there)

        late = at(10.0)
        assert late.json(SAID)[0][2] == "half way"
        assert (shown == kept.floor(10.0)).all()
        assert (shown > 0).any()
        early = at(3.0)
        assert early.json(SAID) == [[0, 0.0, ""]]
        assert not shown.any()
        at(8.0)
        assert (shown == kept.floor(8.0)).all()


def test_it_plays_at_the_pace_and_stands_at_its_end(log: Path) -> None:
    with watched_log(log, start=11.0) as run:
        viewer = Viewer(run.address)
        viewer.until(lambda m: m.tick == 110)
        viewer.ask(do="pace", factor=5)
        viewer.ask(do="go")
        end = viewer.until(lambda m: m.tick == 120)
        status = viewer.until(lambda m: STATUS in m.sections) if STATUS not in end.sections else end
        assert status.json(STATUS)["paused"]
        viewer.ask(do="go")  # once more, from the beginning
        viewer.until(lambda m: m.tick < 60)


def test_a_step_is_one_tick(log: Path) -> None:
    with watched_log(log) as run:
        viewer = Viewer(run.address)
        viewer.until(lambda m: m.tick == 1)
        viewer.ask(do="step")
        viewer.until(lambda m: m.tick == 2)


def test_a_card_tells_what_was_known_then(log: Path) -> None:
    with watched_log(log, start=6.0) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="select", robots=[0, 1])
        cards = viewer.until(lambda m: CARDS in m.sections).json(CARDS)
        assert cards["0"]["said"] == [[pytest.approx(5.0, abs=0.2), "half way"]]
        assert cards["0"]["output"] == ["[anna] off I go"]
        assert cards["0"]["command"] == ["velocity", [pytest.approx(0.4), 0.0, pytest.approx(0.2)]]
        assert [sensor["type"] for sensor in cards["0"]["sensors"]] == ["laser", "bumper"]
        assert cards["0"]["sensors"][1]["known"] == "nothing touched so far"
        assert cards["1"]["properties"] == {}
        assert [cards[robot]["controller"]["state"] for robot in ("0", "1")] == ["running"] * 2
        viewer.ask(do="seek", time=11.0)
        later = viewer.until(lambda m: m.tick == 110 and CARDS in m.sections).json(CARDS)
        assert later["1"]["properties"] == {"rank": 3}
        assert later["1"]["controller"]["state"] == "finished"


def test_a_card_of_a_log_tells_the_odometry_that_was_kept_and_the_last_touch(log: Path) -> None:
    touch = next(one for one in troupe.Log(log).touches if one.robot == "berta")
    with watched_log(log, start=touch.time) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="select", robots=[1])
        card = viewer.until(lambda m: CARDS in m.sections).json(CARDS)["1"]
    assert card["sensors"][1]["known"].startswith(f"last began to touch at {touch.time:.2f} s")
    assert "0° from ahead" in card["sensors"][1]["known"]  # it has driven against the wall
    x, y, yaw = card["odometry"]
    assert (y, yaw) == pytest.approx((0.0, 0.0), abs=0.01)
    assert x + card["error"][0] == pytest.approx(3.0 - card["pose"][0], abs=1e-9)
    assert 0 < abs(card["error"][0]) < 0.2
    assert card["waits"] is None


def test_nothing_can_be_moved_in_a_log(log: Path) -> None:
    with watched_log(log) as run:
        viewer = Viewer(run.address)
        viewer.ask(do="put", robot=0, pose=[5, 5, 0])
        assert "what was, was" in viewer.notice()[-1]


def test_who_may_only_look_on_goes_nowhere(log: Path) -> None:
    with watched_log(log, read_only=True) as run:
        viewer = Viewer(run.address)
        viewer.until(lambda m: m.tick == 1)
        viewer.ask(do="seek", time=5.0)
        viewer.ask(do="select", robots=[0])
        assert viewer.until(lambda m: CARDS in m.sections).tick == 1
