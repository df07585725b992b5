"""What of a run stands in its videos and pictures."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import get_args

import cv2
import numpy as np
import pytest

import troupe
from sim.build import load
from sim.filming import shown
from sim.showing import backdrop_of
from sim.stage.boundary import touchable
from sim.stage.raster import Raster
from sim.video.errors import VideoError
from sim.video.layers import LAYERS, SHOWN, parse_layers
from sim.video.recorder import FPS, SPEED
from sim.worldfile.mistakes import WorldError
from sim.worldfile.schema import Video

STANDING = """
size: [6, 5]
duration: 1
models:
  r: {body: {shape: circle, radius: 0.3}, sensors: [{type: laser}]}
robots:
  - {model: r, pose: [2, 2, 0], controller: quick}
  - {model: r, pose: [4, 3, 0], controller: slow}
controllers: {quick: {program: ./quick.py}, slow: {program: ./slow.py}}
"""
QUICK = """
from player import LaserProxy, PlayerClient, Position2dProxy, SpeechProxy
with PlayerClient() as robot:
    base, laser = Position2dProxy(robot), LaserProxy(robot)
    robot.read()
    SpeechProxy(robot).say("done")
    robot.read()
"""
SLOW = QUICK + "    while robot.read(): pass\n"


@pytest.fixture
def world(tmp_path: Path) -> Path:
    (tmp_path / "quick.py").write_text(QUICK)
    (tmp_path / "slow.py").write_text(SLOW)
    (tmp_path / "w.yaml").write_text(STANDING)
    return tmp_path / "w.yaml"


def words(path: Path) -> list[str | None]:
    """The texts in an SVG."""
    root = ET.parse(path).getroot()
    return [element.text for element in root.iter("{http://www.w3.org/2000/svg}text")]


def test_a_video_is_the_same_however_fast_the_machine_is(tmp_path: Path) -> None:
    for name, realtime in (("a.mp4", None), ("b.mp4", 4.0)):
        troupe.run("wander", duration=2, realtime=realtime, video=tmp_path / name)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_a_picture_shows_its_moment_and_changes_nothing(tmp_path: Path) -> None:
    bare = troupe.run("wander", duration=4)
    seen = troupe.run("wander", duration=4, picture=tmp_path / "p.svg", at=2.5)
    assert seen.digest == bare.digest
    assert "2.5 s" in words(tmp_path / "p.svg")
    troupe.run("wander", duration=4, picture=tmp_path / "end.svg")
    assert "4.0 s" in words(tmp_path / "end.svg")


def test_a_picture_has_the_trails_that_led_there(tmp_path: Path) -> None:
    images = []
    for show in (("fans", "names"), ("fans", "names", "trails")):
        path = tmp_path / "p.png"
        troupe.run("wander", duration=20, picture=path, at=20, video_show=show)
        images.append(cv2.imread(str(path)))
    assert (images[0] != images[1]).any(axis=2).sum() > 500


def test_a_picture_and_a_video_can_be_made_of_one_run(tmp_path: Path) -> None:
    troupe.run("wander", duration=2, video=tmp_path / "v.mp4", picture=tmp_path / "p.png", at=1)
    assert cv2.imread(str(tmp_path / "p.png")).shape[0] == 1200
    assert (tmp_path / "v.mp4").stat().st_size > 1000


def test_a_picture_of_a_moment_after_the_end_shows_the_end_and_says_so(tmp_path: Path) -> None:
    said: list[str] = []
    troupe.run("wander", duration=1, picture=tmp_path / "p.svg", at=9, say=said.append)
    assert "1.0 s" in words(tmp_path / "p.svg")
    assert any("ended at 1 s" in line for line in said)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full here")
@pytest.mark.parametrize("name", ["p.png", "p.svg"])
def test_a_picture_that_cannot_be_written_is_told_and_the_run_is_whole(
    tmp_path: Path, name: str
) -> None:
    (tmp_path / name).symlink_to("/dev/full")
    with pytest.warns(RuntimeWarning, match="No space left"):
        result = troupe.run("wander", duration=1, picture=tmp_path / name)
    assert result.sim_time == 1.0


def test_who_has_finished_is_settled_and_has_no_fan(world: Path) -> None:
    with troupe.Simulation(world, seed=1, duration=1.0) as simulation:
        while not simulation.over:
            simulation.step()
        last = simulation.view()
    assert list(last.settled) == [True, False]
    assert {scan.robot for scan in last.scans} == {1}  # type: ignore[union-attr]
    assert list(last.said) == ["done", "done"]
    assert last.said_at[0] < last.time


def test_the_world_says_what_shows_and_the_command_line_overrides_it(world: Path) -> None:
    world.write_text(STANDING + "video: {show: [fans, blobs], size: [640, 480], speed: 2}\n")
    loaded = load(world)
    assert shown(loaded, None) == {"fans", "blobs"}
    assert shown(loaded, ["names"]) == {"names"}
    troupe.run(world, picture=world.with_name("p.png"))
    assert cv2.imread(str(world.with_name("p.png"))).shape == (480, 640, 3)
    world.write_text(STANDING)
    assert shown(load(world), None) == SHOWN


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("video: {show: [fan]}", "video.show"),
        ("video: {size: [641, 480]}", "video.size"),
        ("video: {speed: 0}", "video.speed"),
        ("video: {fps: 1000}", "video.fps"),
    ],
)
def test_a_setting_of_the_video_that_cannot_be_is_a_mistake(
    world: Path, text: str, place: str
) -> None:
    world.write_text(STANDING + text + "\n")
    with pytest.raises(WorldError, match=place):
        load(world)


def test_a_world_may_name_every_layer_and_shows_the_usual_ones() -> None:
    (names, _) = get_args(Video.model_fields["show"].annotation)
    assert get_args(names) == LAYERS
    assert set(Video().show) == SHOWN
    assert (Video().fps, Video().speed) == (FPS, SPEED)


def test_layers_are_read_as_people_write_them() -> None:
    assert parse_layers("fans, names") == {"fans", "names"}
    assert parse_layers("none") == frozenset()
    assert parse_layers(",".join(LAYERS)) == set(LAYERS)
    with pytest.raises(VideoError, match="did you mean 'names'"):
        parse_layers("name")
    with pytest.raises(VideoError, match="not one of fans, names"):
        parse_layers("")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"at": 1.0}, "no picture"),
        ({"video_show": ["fans"]}, "no video"),
        ({"picture": "x.gif"}, r"\.png or \.svg"),
        ({"picture": "x.png", "at": -1.0}, "0 or more"),
        ({"picture": "x.png", "video_show": ["fan"]}, "did you mean 'fans'"),
    ],
)
def test_options_that_cannot_be_are_refused(options: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        troupe.run("wander", duration=1, **options)  # type: ignore[arg-type]


def test_no_boundary_is_shown_behind_the_walls_of_a_map() -> None:
    loaded = load(Path(__file__).parents[2] / "worlds" / "fcdfs_rooms.yaml")
    assert loaded.world.boundary is not None
    width, height = loaded.layout.size
    for vertices, _ in backdrop_of(loaded).solids:
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        assert (low >= -1e-9).all()
        assert (high <= np.array([width, height]) + 1e-9).all()


def test_where_a_map_is_open_the_boundary_shows() -> None:
    walls = np.array([[1, 1, 0, 0], [1, 0, 0, 0], [1, 1, 0, 1]], bool)
    pieces = touchable(Raster(walls, 0.5), (2.0, 1.5), 0.2)
    found = {tuple(np.concatenate([p.min(axis=0), p.max(axis=0)]).round(9)) for p in pieces}
    assert found == {
        (1.0, -0.2, 1.5, 0.0),  # below the one free cell of the lowest row
        (2.0, 0.5, 2.2, 1.7),  # to the right, around the corner
        (1.0, 1.5, 2.2, 1.7),  # above
    }


def test_a_map_smaller_than_its_world_leaves_the_rest_of_the_boundary() -> None:
    pieces = touchable(Raster(np.ones((2, 2), bool), 1.0), (4.0, 4.0), 0.1)
    reach = np.concatenate(pieces)
    assert reach.max() == pytest.approx(4.1)
    assert not any((piece.max(axis=0) <= 2.0).all() for piece in pieces)
