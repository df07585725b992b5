"""Things that are seen but not solid, solid but not seen, and seen by some kinds of sensor only."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from sim.build import load, load_data
from sim.filming import backdrop_of
from sim.worldfile import WorldError
from tests.sim.moved_world import Moved

WORLD = """\
size: [12, 8]
boundary: null
models:
  rover:
    body: {{shape: box, size: [0.4, 0.3], height: 0.3, color: blue{body}}}
    sensors:
      - {{type: laser, range: 20, fov: 90, samples: 91{laser}}}
      - {{type: ranger, range: 20, fov: 10}}
      - {{type: blobfinder, range: 20, fov: 90, image: [91, 60]}}
      - {{type: fiducial, range: 20}}
      - {{type: bumper}}
robots:
  - {{name: r, model: rover, pose: [2, 4, 0]}}
{more}
"""
BACK = "  - {shape: box, size: [0.2, 8], pose: [11.1, 4, 0], color: green, height: 3}\n"


def moved(folder: Path, obstacles: str = "", body: str = "", laser: str = "", **files) -> Moved:
    more = f"obstacles:\n{BACK}{obstacles}" if "map:" not in obstacles else obstacles
    return Moved(folder, WORLD.format(more=more, body=body, laser=laser), **files)


def ahead(world: Moved) -> list[object]:
    """What laser, ranger and blobfinder tell of what is straight ahead."""
    world.drive([[0, 0, 0]] * len(world.names), world.interval)
    blobs = world.data(0, 2)
    middle = [b for b in blobs.blobs[0, : blobs.counts[0]] if b["left"] <= 45 <= b["right"]]
    return [
        round(float(world.data(0, 0).ranges[0, 45]), 2),
        round(float(world.data(0, 1).ranges[0, 0]), 2),
        int(middle[0]["color"]) if middle else None,
    ]


SHAPES = {
    "box": "shape: box, size: [2, 2]",
    "circle": "shape: circle, radius: 1",
    "polygon": "shape: polygon, points: [[-1, -1], [1, -1], [1, 1], [-1, 1]]",
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("movable", [False, True])
def test_a_robot_drives_through_what_is_not_solid_and_sees_it(shape, movable, tmp_path) -> None:
    mark = f"  - {{{SHAPES[shape]}, pose: [5, 4, 0], color: red, solid: false, movable: {movable}}}"
    world = moved(tmp_path, mark.lower())
    assert ahead(world) == [2.0, 2.0, 0xFF0000]
    world.drive([[0.5, 0, 0]], 6.5)
    assert world.poses[0, 0] == pytest.approx(5.13, abs=0.15)
    assert world.scenery.stage.contact_counts.tolist() == [0]
    assert world.scenery.stage.stalls.tolist() == [False]
    assert ahead(world)[2] == 0xFF0000  # its far side, from within
    assert ahead(world)[0] == pytest.approx(6.0 - world.poses[0, 0], abs=0.01)
    world.drive([[0.5, 0, 0]], 5)
    assert ahead(world)[2] == 0x00FF00
    if movable:
        np.testing.assert_allclose(world.scenery.stage.movable_poses, [[5, 4, 0]], atol=1e-9)


@pytest.mark.parametrize("movable", [False, True])
def test_a_robot_runs_into_glass_that_its_laser_does_not_see(movable, tmp_path) -> None:
    glass = "  - {shape: box, size: [2, 2], pose: [5, 4, 0], color: red, mass: 500, seen_by: "
    world = moved(tmp_path, f"{glass}[ranger, bumper], movable: {movable}}}".lower())
    assert ahead(world) == [9.0, 2.0, 0x00FF00]
    world.drive([[0.5, 0, 0]], 6)
    assert world.poses[0, 0] < 4
    assert world.data(0, 4).bits[0, 0]


@pytest.mark.parametrize("movable", [False, True])
def test_no_bumper_feels_what_it_does_not_see(movable, tmp_path) -> None:
    thing = "  - {shape: box, size: [2, 2], pose: [5, 4, 0], mass: 500, seen_by: [laser], movable: "
    world = moved(tmp_path, f"{thing}{str(movable).lower()}}}")
    world.drive([[0.5, 0, 0]], 6)
    assert world.scenery.stage.contact_counts.tolist() == [1]
    assert not world.data(0, 4).bits.any()


def test_a_map_may_be_paint_and_seen_by_cameras_alone(tmp_path) -> None:
    text = "\n".join(["........", "...##...", "........"])
    lanes = "map: {file: lanes.txt, cell: 1.5, color: yellow, solid: false, seen_by: [blobfinder]}"
    whole = WORLD.replace("size: [12, 8]", "size: [12, 4.5]").replace("4, 0]", "2.25, 0]")
    world = Moved(tmp_path, whole.format(more=lanes, body="", laser=""), **{"lanes.txt": text})
    assert ahead(world) == [20.0, 20.0, 0xFFFF00]
    world.drive([[0.5, 0, 0]], 8)
    assert world.poses[0, 0] > 5
    assert world.scenery.floor.counted.all()
    backdrop = backdrop_of(load(tmp_path / "world.yaml"))
    assert (len(backdrop.marks), len(backdrop.solids)) == (1, 0)


def test_robots_that_are_not_solid_drive_through_everything(tmp_path) -> None:
    world = moved(
        tmp_path, "  - {shape: box, size: [1, 8], pose: [5, 4, 0]}", body=", solid: false"
    )
    world.drive([[0.5, 0, 0]], 10)
    assert world.poses[0, 0] > 6
    assert world.scenery.stage.contact_counts.tolist() == [0]


def test_what_is_not_solid_is_no_place_where_a_robot_may_not_start(tmp_path) -> None:
    zone = "  - {shape: box, size: [12, 8], pose: [6, 4, 0], solid: false}\n"
    world = moved(tmp_path, zone)
    assert world.scenery.stage.set_poses({0: (4, 4, 0)}) == []
    given = yaml.safe_load(WORLD.format(more="obstacles:\n" + zone, body="", laser=""))
    given["robots"].append({"model": "rover", "count": 20, "placement": "random"})
    assert len(load_data(given).start) == 21


def test_a_picture_shows_what_is_not_solid_pale_and_below_all_else(tmp_path) -> None:
    zone = "  - {shape: box, size: [2, 2], pose: [6, 4, 0], color: red, solid: false}\n"
    post = "  - {shape: box, size: [1, 1], pose: [9, 4, 0], color: red}\n"
    moved(tmp_path, zone + post)
    backdrop = backdrop_of(load(tmp_path / "world.yaml"))
    ((outline, color),) = backdrop.marks
    assert outline.min(axis=0).tolist() == [5, 3]
    assert color >> 16 > 0xF0
    assert color & 0xFF > 0x80
    assert [one for _, one in backdrop.solids] == [0x00FF00, 0xFF0000]


def test_kinds_of_sensor_that_there_are_not_are_told(tmp_path) -> None:
    with pytest.raises(WorldError) as raised:
        moved(tmp_path, "  - {shape: circle, radius: 1, pose: [6, 4, 0], seen_by: [laser, lidar]}")
    assert "obstacles.1.seen_by" in str(raised.value)
    assert "lidar" in str(raised.value)
    with pytest.raises(WorldError, match="must be a list"):
        moved(tmp_path, "  - {shape: circle, radius: 1, pose: [6, 4, 0], seen_by: laser}")


# -- heights --------------------------------------------------------------------------------------


def test_a_laser_looks_over_what_ends_below_it_and_under_what_begins_above(tmp_path) -> None:
    things = (
        "  - {shape: box, size: [0.2, 4], pose: [4, 4, 0], height: 0.3}\n"
        "  - {shape: circle, radius: 0.1, pose: [5, 4, 0], height: 0.39}\n"
        "  - {shape: box, size: [0.2, 4], pose: [6, 4, 0], z: 0.5}\n"
        "  - {shape: box, size: [0.2, 4], pose: [7, 4, 0], height: 0.4, movable: true}\n"
    )
    assert ahead(moved(tmp_path, things, laser=", z: 0.4"))[0] == 4.9
    assert ahead(moved(tmp_path, things, laser=", z: 0.5"))[0] == 3.9
    assert ahead(moved(tmp_path, things, laser=", z: 0.2"))[0] == 1.9
    assert ahead(moved(tmp_path, things))[0] == 1.9


def test_robots_pass_beneath_a_bridge_and_not_through_its_pillars(tmp_path) -> None:
    bridge = (
        "  - {shape: box, size: [1, 8], pose: [5, 4, 0], z: 0.3, height: 0.2}\n"
        "  - {shape: box, size: [1, 1], pose: [5, 1, 0], height: 0.4}\n"
    )
    world = moved(tmp_path, bridge)
    world.drive([[0.5, 0, 0]], 10)
    assert world.poses[0, 0] > 6
    assert world.scenery.stage.contact_counts.tolist() == [0]
    assert world.scenery.stage.set_poses({0: (5, 5, 0)}) == []
    assert world.scenery.stage.set_poses({0: (5, 1, 0)}) == [0]
    taller = moved(tmp_path, bridge, body=", z: 0.1")
    taller.drive([[0.5, 0, 0]], 10)
    assert taller.poses[0, 0] < 4.5
    assert taller.scenery.stage.contact_counts.tolist() == [1]


def test_robots_of_different_storeys_pass_each_other_and_those_of_one_do_not(tmp_path) -> None:
    models = "".join(
        f"  m{k}: {{body: {{shape: circle, radius: 0.3, z: {z}, height: {h}}}}}\n"
        for k, (z, h) in enumerate([(0, 0.5), (0.5, 0.5), (0.4, 0.2)])
    )
    poses = [(0, 3, 2), (1, 5, 2), (0, 3, 4), (2, 5, 4), (1, 3, 6), (2, 5, 6)]
    robots = "".join(f"  - {{model: m{m}, pose: [{x}, {y}, 0]}}\n" for m, x, y in poses)
    world = Moved(tmp_path, f"size: [9, 9]\nmodels:\n{models}robots:\n{robots}")
    world.drive([[0.4, 0, 0], [-0.4, 0, 0]] * 3, 6)
    assert world.scenery.stage.contact_counts.tolist() == [0, 0, 1, 1, 1, 1]
    assert world.poses[0, 0] > world.poses[1, 0]


def test_more_storeys_than_there_are_bits_are_refused(tmp_path) -> None:
    def tower(count: int) -> str:
        return "".join(
            f"  - {{shape: circle, radius: 1, pose: [9, 4, 0], z: {k}, height: 0.5}}\n"
            for k in range(count)
        )

    moved(tmp_path, tower(32))
    with pytest.raises(WorldError, match="storeys"):
        moved(tmp_path, tower(33))


# -- landmarks ------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", SHAPES)
def test_a_standing_landmark_is_found_where_it_is_and_never_moves(shape, tmp_path) -> None:
    post = f"  - {{{SHAPES[shape]}, pose: [5, 4, 30], color: red, fiducial: 7}}\n"
    world = moved(tmp_path, post)
    assert ahead(world)[2] == 0xFF0000
    found = world.data(0, 3)
    assert found.counts.tolist() == [1]
    seen = found.fiducials[0, 0]
    assert seen["id"] == 7
    np.testing.assert_allclose([seen["x"], seen["y"], seen["yaw"]], [3, 0, np.pi / 6], atol=1e-6)
    world.drive([[0.5, 0, 0]], 6)
    assert world.poses[0, 0] < 4
    assert len(world.scenery.stage.movable_poses) == 0


def test_a_landmark_that_can_be_pushed_takes_its_fiducial_along(tmp_path) -> None:
    puck = "  - {shape: circle, radius: 0.2, pose: [4, 4, 0], movable: true, mass: 1, fiducial: 9}"
    world = moved(tmp_path, puck)
    world.drive([[0.5, 0, 0]], 8)
    assert world.scenery.stage.movable_poses[0, 0] > 5
    assert world.data(0, 3).fiducials[0, 0]["id"] == 9
    assert world.data(0, 3).fiducials[0, 0]["x"] == pytest.approx(0.4, abs=0.02)
