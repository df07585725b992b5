"""Obstacles that stand are put elsewhere by hand: bodies, sensors, logs and pictures show it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import troupe
from sim.log.playback import Playback
from sim.log.reader import LogReader
from sim.log.replay import check
from sim.stage.distance_field import clear_of, distance_field
from tests.sim.moved_world import Moved

OBSTACLES = {
    "box": "{shape: box, size: [0.6, 1.4], color: blue",
    "circle": "{shape: circle, radius: 0.5, color: blue",
    "fork": "{shape: compound, parts: [{shape: polygon, points: [[-0.5, -0.5], [0.5, -0.5], [0, 0],"
    " [0.5, 0.5], [-0.5, 0.5]]}]",
    "post": "{shape: circle, radius: 0.3, fiducial: 5",
    "pair": "{shape: compound, color: green, parts: [{shape: circle, radius: 0.3, pose: [0, 0.4,"
    " 0]}, {shape: box, size: [0.2, 0.5], pose: [0.1, -0.3, 20]}]",
}
WORLD = """\
size: [12, 8]
origin: center
obstacles:
  - {shape: box, size: [0.2, 0.2], pose: [-5, 3, 0], color: white}
  - %s, name: it, pose: %s}
  - {shape: circle, radius: 0.2, pose: [0, 3, 0], movable: true, mass: 1}
models:
  rover:
    body: {shape: circle, radius: 0.3}
    drive: {kind: differential}
    sensors:
      - {type: laser, samples: 361, fov: 360, range: 12}
      - {type: blobfinder, fov: 360, image: [360, 60]}
      - {type: fiducial, fov: 360, range: 12}
      - {type: bumper}
robots:
  - {name: a, model: rover, pose: [-3, 0, 0]}
  - {name: b, model: rover, pose: [4, -2, 90]}
"""
START, GOAL = (1.0, 2.0, 30.0), (-1.0, 0.2, 75.0)


def pose_of(told: tuple[float, float, float]) -> tuple[float, float, float]:
    return told[0], told[1], math.radians(told[2])


@pytest.fixture
def world(tmp_path: Path):
    """A world in which an obstacle stands at a pose."""

    def make(kind: str, at: tuple[float, float, float]) -> Moved:
        return Moved(tmp_path, WORLD % (OBSTACLES[kind], list(at)))

    return make


def scan(world: Moved) -> list[np.ndarray]:
    """What both robots' sensors tell: ranges, the colours that are hit, fiducials, switches."""
    world.drive([[0, 0, 0], [0, 0, 0]], 0.1)
    told = []
    for robot in (0, 1):
        laser, camera, finder, bumper = (world.data(robot, index) for index in range(4))
        row = 0
        colors = np.append(world.scenery.scene.colors, 0)[camera.hits[row]]
        told += [laser.ranges[row], colors, bumper.bits[row]]
        told += [np.array(finder.fiducials[row][: finder.counts[row]].tolist(), float)]
    return told


@pytest.mark.parametrize("kind", OBSTACLES)
def test_all_is_as_if_it_had_always_stood_there(world, kind: str) -> None:
    moved, there = world(kind, START), world(kind, GOAL)
    assert moved.scenery.put_thing(1, pose_of(GOAL))
    for one in (moved, there):
        for twist in ([0.5, 0, 0.0], [0.5, 0, 0.6]):
            one.drive([twist, twist], 5)
    assert moved.poses == pytest.approx(there.poses, abs=1e-6)
    counts = [one.scenery.stage.contact_counts.tolist() for one in (moved, there)]
    assert counts[0] == counts[1]
    assert counts[0][0] > 0
    for one, other in zip(scan(moved), scan(there), strict=True):
        assert one == pytest.approx(other, abs=1e-6)


@pytest.mark.parametrize("kind", OBSTACLES)
def test_where_it_stood_is_free_and_what_is_put_back_stands_there_again(world, kind: str) -> None:
    one = world(kind, START)
    before = scan(one)
    stage = one.scenery.stage
    assert not stage.fits(0, (1.0, 2.1, 0.0))
    assert one.scenery.put_thing(1, pose_of(GOAL))
    assert stage.fits(0, (1.0, 2.1, 0.0))
    assert not stage.fits(0, (-1.0, 0.3, 0.0))
    assert any(not np.array_equal(was, now) for was, now in zip(before, scan(one), strict=True))
    assert one.scenery.put_thing(1, pose_of(START))
    for was, now in zip(before, scan(one), strict=True):
        assert np.array_equal(was, now)


def test_it_has_no_room_on_robots_pushed_things_and_beyond_the_edge(world) -> None:
    one = world("box", START)
    for at in ((-3.4, 0.5), (0.1, 3.2), (6.1, 0.0)):
        assert not one.scenery.put_thing(1, (*at, 0.0))
    assert one.scenery.stage.layout.fixtures[0].pose == pose_of(START)
    assert one.scenery.put_thing(1, (5.9, 0.0, 0.0))  # in the wall: both stand
    assert not one.scenery.put_thing(2, (0.0, 0.0, 0.0))


def test_a_robot_that_was_far_from_everything_is_stopped_by_what_is_put_before_it(
    tmp_path: Path,
) -> None:
    text = WORLD % (OBSTACLES["box"], [20, 5, 90])
    one = Moved(tmp_path, text.replace("[12, 8]", "[60, 20]").replace("[-3, 0, 0]", "[-20, 0, 0]"))
    one.drive([[0.5, 0, 0], [0, 0, 0]], 6)
    ahead = one.poses[0, 0] + 0.3 + 0.02
    assert one.scenery.put_thing(1, (ahead + 0.3, 0.0, 0.0))
    one.drive([[0.5, 0, 0], [0, 0, 0]], 3)
    assert one.poses[0, 0] == pytest.approx(ahead - 0.3, abs=0.006)
    assert one.scenery.stage.stalls[0]
    assert one.scenery.put_thing(1, (20.0, 5.0, 0.0))
    one.drive([[0.5, 0, 0], [0, 0, 0]], 3)
    assert one.poses[0, 0] > ahead + 0.9


def test_no_place_is_told_to_be_further_away_than_it_is(world) -> None:
    one = world("pair", START)
    assert one.scenery.put_thing(1, (-4.9, -3.8, 1.0))
    assert one.scenery.put_thing(1, (3.3, 1.7, 2.0))
    layout, field = one.scenery.stage.layout, one.scenery.stage._fixtures.distances
    exact = distance_field(layout)
    assert (field.cells <= exact.cells).all()
    assert (field.cells < exact.cells).mean() < 0.5
    assert clear_of(field.cells, field.frame, 3.3, 1.7) == 0.0


def test_no_door_is_blocked(tmp_path: Path) -> None:
    text = WORLD % (OBSTACLES["box"], list(START))
    one = Moved(tmp_path, text + "doors: [{name: s, at: [-2, -2], model: rover, period: 1}]\n")
    assert not one.scenery.put_thing(1, (-2.2, -2.5, 0.0))
    assert one.scenery.put_thing(1, (-2.2, -3.5, math.pi / 2))


def test_a_log_repeats_it_and_shows_it_where_it_was(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(WORLD % (OBSTACLES["box"], list(START)))
    with troupe.Simulation(path, log=tmp_path / "run.mcap", controllers=False) as sim:
        seen = []
        sim.command("a", forward=0.5)
        for tick in range(40):
            if tick == 10:
                sim.set_pose("it", pose_of(GOAL))
            if tick == 30:
                sim.set_pose("it", pose_of(START))
            sim.step()
            if tick in (5, 20, 35):
                seen.append(sim.readings("laser").ranges[0].copy())
        with pytest.raises(ValueError, match="no room for it"):
            sim.set_pose("it", (6.5, 0.0, 0.0))
        with pytest.raises(ValueError, match="there is no"):
            sim.set_pose("nobody", (6.5, 0.0, 0.0))
        sim.set_pose("it", (2.0, -2.0, 0.0))
        digest = sim.result().digest
    reader = LogReader(tmp_path / "run.mcap")
    assert check(reader, digest).equal
    played = Playback(reader)
    for order in ((5, 20, 35), (20, 5), (35,)):
        for tick in order:
            state = played.states[tick]
            backdrop = played.present(tick).backdrop
            stands = backdrop.solids[-1][0].mean(axis=0) if backdrop else np.array(START[:2])
            assert stands == pytest.approx((GOAL if tick == 20 else START)[:2], abs=1e-9)
            around = played.sense(state, everything=frozenset({0}))
            ranges = around.suite.reading(0, 0).data.ranges[0]
            assert np.array_equal(ranges, seen[(5, 20, 35).index(tick)])
    end = played.end().backdrop
    assert end is not None
    assert end.solids[-1][0].mean(axis=0) == pytest.approx([2.0, -2.0])
    walls = [time for time, _ in reader.messages("/troupe/walls")]
    assert len(walls) == 4


def test_a_video_and_a_picture_show_it_where_it_stands(tmp_path: Path) -> None:
    text = WORLD % (OBSTACLES["box"], list(START))
    there = troupe.Simulation(dict_of(text.replace(str(list(START)), str(list(GOAL)))))
    moved = troupe.Simulation(dict_of(text))
    with there, moved:
        before = moved.picture((600, 400))
        moved.set_pose("it", pose_of(GOAL))
        assert np.abs(moved.picture((600, 400)).astype(int) - there.picture((600, 400))).max() < 32
        assert (moved.picture((600, 400)) != before).any()
        snapshot = moved.view()
        assert snapshot.backdrop is not None
        moved.reset()
        assert np.array_equal(moved.picture((600, 400)), before)


def dict_of(text: str) -> dict[str, Any]:
    """A world's text as what it says, with an end."""
    return {**yaml.safe_load(text), "duration": 10}
