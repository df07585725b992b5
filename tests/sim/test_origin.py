"""A world's coordinates count from its origin: in the file, of gps, in results and pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import troupe
from sim.build import load, load_data
from sim.filming import backdrop_of
from sim.log.scene import map_event
from sim.stage.floor import FloorPaint
from sim.video.projection import project
from sim.worldfile import WorldError
from tests.sim.moved_world import Moved

SHIFT = np.array([5.0, 3.0])
WORLD = """\
size: [10, 6]
{origin}
region: {region}
floor: {{resolution: 0.25}}
map: {{file: walls.txt, cell: 2, color: gray}}
obstacles:
  - {{shape: circle, radius: 0.3, pose: {ball}}}
  - {{shape: box, size: [0.5, 1], pose: {box}, movable: true, mass: 2}}
models:
  rover:
    body: {{shape: box, size: [0.5, 0.4]}}
    localization: gps
    sensors: [{{type: laser, samples: 31, range: 8}}]
    actuators: [{{type: sprayer, size: [0.5, 0.5]}}]
robots:
  - {{model: rover, pose: {first}}}
  - {{model: rover, count: 3, placement: random}}
"""
WALLS = ".....\n#....\n....#"
PLACES = {"ball": (6.0, 5.0, 0.0), "box": (4.0, 1.0, 20.0), "first": (2.0, 1.0, 30.0)}
REGION = [(0, 0), (10, 0), (10, 6), (0, 6)]


def text(origin: str, shift: np.ndarray) -> str:
    left, low = shift.tolist()
    places = {name: [x - left, y - low, turn] for name, (x, y, turn) in PLACES.items()}
    region = [[x - left, y - low] for x, y in REGION]
    return WORLD.format(origin=origin, region=region, **places)


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> tuple[Moved, Moved]:
    """One world twice, without an origin and with one, driven alike."""
    worlds = []
    for name, origin, shift in (
        ("plain", "", np.zeros(2)), ("shifted", "origin: [5, 3]", SHIFT),
    ):  # fmt: skip
        folder = tmp_path_factory.mktemp(name)
        world = Moved(folder, text(origin, shift), **{"walls.txt": WALLS})
        world.drive([[0.3, 0, 0.2], [0.4, 0, 0], [0.2, 0, -0.3], [0.3, 0, 0]], 3)
        worlds.append(world)
    return worlds[0], worlds[1]


def test_everything_moves_as_it_would_from_the_corner(pair) -> None:
    plain, shifted = pair
    np.testing.assert_allclose(shifted.poses[:, :2], plain.poses[:, :2] - SHIFT, atol=1e-6)
    stage = shifted.scenery.stage
    np.testing.assert_allclose(
        stage.movable_poses[:, :2], plain.scenery.stage.movable_poses[:, :2] - SHIFT, atol=1e-6
    )
    np.testing.assert_allclose(shifted.data(0, 0).ranges, plain.data(0, 0).ranges, atol=1e-6)


def test_a_gps_counts_from_the_origin(pair) -> None:
    shifted = pair[1]
    shifted.scenery.odometry.update(shifted.poses, 0.1, 1)
    np.testing.assert_allclose(shifted.scenery.odometry.poses, shifted.poses)


def test_the_floor_that_counts_and_is_painted_lies_under_the_world(pair) -> None:
    floors = []
    for world, shift in zip(pair, (np.zeros(2), SHIFT), strict=True):
        layout = world.scenery.stage.layout
        floor = FloorPaint(layout, 0.25)
        way = np.array(
            [[[7.0 - shift[0], 3.0 - shift[1], 0.0], [8.0 - shift[0], 3.0 - shift[1], 0]]]
        )
        floor.spray(np.array([0]), np.array([0]), way, np.array([[0.5, 0.5]]), np.zeros((1, 2)))
        floors.append(floor)
    assert (floors[0].counted == floors[1].counted).all()
    assert not floors[0].counted.all()
    assert (floors[0].owner == floors[1].owner).all()
    assert floors[0].painted_area > 0.3


def test_grids_of_a_log_say_where_they_lie(pair) -> None:
    for world, low in zip(pair, ((0, 0), (-5, -3)), strict=True):
        values = map_event(world.scenery.stage.layout).values
        place = values["info"]["origin"]["position"]
        assert (place["x"], place["y"]) == low
    plain, shifted = (map_event(w.scenery.stage.layout).values["data"] for w in pair)
    assert (np.array(plain) == np.array(shifted)).all()


def test_a_picture_is_the_same_and_its_axes_count_from_the_origin(tmp_path) -> None:
    (tmp_path / "walls.txt").write_text(WALLS)
    backdrops = []
    for name, origin, shift in (("a", "", np.zeros(2)), ("b", "origin: center", SHIFT)):
        (tmp_path / f"{name}.yaml").write_text(text(origin, shift))
        backdrops.append(backdrop_of(load(tmp_path / f"{name}.yaml")))
    assert backdrops[1].low == (-5, -3)
    for (one, _), (other, _) in zip(backdrops[0].solids, backdrops[1].solids, strict=True):
        np.testing.assert_allclose(one - SHIFT, other, atol=1e-9)
    ends = [
        project(b.size, [v for v, _ in b.solids], (640, 480), low=b.low).edges(
            np.array([[b.low[0], b.low[1]], [b.low[0] + 10, b.low[1] + 6]])
        )
        for b in backdrops
    ]
    np.testing.assert_allclose(ends[0], ends[1])


def test_results_and_the_open_run_count_from_it() -> None:
    world = {
        "size": [8, 8],
        "origin": "center",
        "duration": 1,
        "models": {"m": {"body": {"shape": "circle", "radius": 0.3}}},
        "robots": [{"model": "m", "pose": [-3, -3, 0]}],
    }
    with troupe.Simulation(world, controllers=False) as sim:
        sim.command([0], forward=0.5)
        while not sim.over:
            sim.step()
        result = sim.result()
        assert sim.poses[0, 1] == pytest.approx(-3)
    assert result.robots[0].start == pytest.approx((-3, -3, 0))
    assert result.robots[0].pose[0] > -3


def test_what_lies_beyond_the_world_is_told_in_its_coordinates() -> None:
    def world(**more):
        model = {"m": {"body": {"shape": "circle", "radius": 0.3}}}
        return {"size": [8, 6], "origin": [2, 1], "models": model, **more}

    load_data(world(robots=[{"model": "m", "pose": [-1.5, -0.5, 0]}]))
    with pytest.raises(WorldError, match="outside of the world"):
        load_data(world(robots=[{"model": "m", "pose": [7, 4, 0]}]))
    with pytest.raises(WorldError, match="x from -2 to 6, y from -1 to 5"):
        load_data(world(region=[[0, 0], [7, 0], [7, 4]]))
    with pytest.raises(WorldError, match="center"):
        load_data(world() | {"origin": "middle"})


def test_doors_of_a_text_map_open_where_the_map_has_them(tmp_path: Path) -> None:
    (tmp_path / "walls.txt").write_text("S..\n...\n")
    (tmp_path / "w.yaml").write_text(
        "map: {file: walls.txt, cell: 2}\norigin: center\n"
        "models: {m: {body: {shape: circle, radius: 0.3}}}\n"
        "doors: [{name: d, at: S, model: m, period: 2}]\n"
    )
    (door,) = load(tmp_path / "w.yaml").layout.doors
    assert door.centre == (-2, 1)
