"""Things of a Stage world that are seen, touched and moved as Stage has it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.scenery import Scenery

FLOOR = "model ( size [20 10 1] boundary 1 )\n"
ROBOT = (
    'position ( name "r" pose [{x} 0 0 0] size [0.4 0.3 0.3]\n'
    "ranger ( pose [0 0 -0.2 0] sensor ( ) ) )\n"
)
MARK = "size [2 2 0.01] obstacle_return 0 ranger_return -1"


class Driven:
    """An imported world whose robot drives ahead."""

    def __init__(self, got) -> None:
        self.scenery = Scenery(got.loaded, 1)
        for spec, pose in zip(got.loaded.robots, self.scenery.start_poses, strict=True):
            model = got.loaded.world.models[spec.model]
            self.scenery.add_robot(spec.name, spec.model, model, pose)

    def ahead(self, seconds: float) -> float:
        """Where the first robot is after driving at 0.5 m/s."""
        for _ in range(round(seconds / 0.1)):
            self.scenery.stage.command([0], [[0.5, 0, 0]])
            self.scenery.stage.tick()
        return float(self.scenery.stage.poses[0, 0])

    def range(self) -> float:
        """What its first sensor measures."""
        self.scenery.refresh()
        self.scenery.suite.sense(1, 0.1)
        return float(self.scenery.suite.reading(0, 0).data.ranges[0, 0])


@pytest.mark.parametrize(
    "more", ["", ' bitmap "yard.png"', " fiducial_return 1", ' bitmap "yard.png" fiducial_return 1']
)
@pytest.mark.parametrize("copies", [1, 2])
def test_a_robot_passes_a_mark_on_the_ground_and_no_ranger_sees_it(world, more, copies) -> None:
    got = world(FLOOR + f"model ( {MARK}{more} )\n" * copies + ROBOT.format(x=0))
    driven = Driven(got)
    assert driven.range() == pytest.approx(5.0)
    assert driven.ahead(5) == pytest.approx(2.4, abs=0.2)
    marks = got.data.get("obstacles", []) + [got.data[key] for key in ("map",) if key in got.data]
    assert marks
    assert all(mark["solid"] is False for mark in marks)
    assert all(mark["seen_by"] == ["blobfinder", "fiducial", "bumper"] for mark in marks)
    assert [mark.get("fiducial") for mark in marks] == [1 if "fid" in more else None] * len(marks)


def test_walls_that_robots_drive_through_are_seen_by_lasers_alone(world) -> None:
    """As those of Stage's own floorplans in worlds/map.inc."""
    got = world(
        'model ( size [12 8 1] bitmap "yard.png" boundary 1 obstacle_return 0 )\n'
        + ROBOT.format(x=-3).replace("0 0 0] size", "0.8 0 0] size")
    )
    assert got.data["boundary"] is None
    assert got.data["map"]["solid"] is False
    walls = got.data["obstacles"]
    assert len(walls) == 4
    assert all(wall["solid"] is False and "seen_by" not in wall for wall in walls)
    driven = Driven(got)
    assert driven.range() < 5
    assert driven.ahead(20) > 6


def test_a_landmark_never_moves(world) -> None:
    got = world(
        FLOOR
        + "model ( pose [2 0 0 45] size [0.3 0.3 0.3] fiducial_return 7 )\n"
        + ROBOT.format(x=0)
    )
    (post,) = got.data["obstacles"]
    assert post["fiducial"] == 7
    assert "movable" not in post
    assert len(got.data["robots"]) == 1
    assert Driven(got).ahead(12) < 2


@pytest.mark.parametrize("drawn", ["", ' bitmap "hall.png"'])
def test_what_a_gripper_could_take_moves_with_its_fiducial_and_its_bitmap(world, drawn) -> None:
    got = world(
        FLOOR
        + "model ( pose [2 0 0 0] size [0.3 0.3 0.3] fiducial_return 7 gripper_return 1 mass 1"
        f"{drawn} )\n" + ROBOT.format(x=0)
    )
    (puck,) = got.data["obstacles"]
    assert (puck["movable"], puck["fiducial"], puck["mass"]) == (True, 7, 1)
    assert puck["shape"] == ("compound" if drawn else "box")
    driven = Driven(got)
    driven.ahead(8)
    assert driven.scenery.stage.movable_poses[0, 0] > 2.5


def test_a_model_upon_a_movable_one_moves_with_it_as_one_thing(world) -> None:
    got = world(
        FLOOR + "model ( pose [2 0 0 0] size [0.1 0.1 0.5] gripper_return 1 mass 2\n"
        "model ( size [0.6 0.6 0.5] pose [0 0 -0.5 0] ) )\n" + ROBOT.format(x=0)
    )
    (one,) = got.data["obstacles"]
    assert one["movable"] is True
    assert [part["size"] for part in one["parts"]] == [[0.1, 0.1], [0.6, 0.6]]
    driven = Driven(got)
    start = driven.scenery.stage.movable_poses[0, 0]
    assert driven.ahead(6) < driven.scenery.stage.movable_poses[0, 0] - 0.45
    assert driven.scenery.stage.movable_poses[0, 0] > start + 0.3


def test_models_upon_a_robot_are_parts_of_its_body(world) -> None:
    got = world(
        FLOOR
        + "position ( size [0.4 0.4 0.2] model ( pose [0.3 0 -0.2 90] size [0.6 0.1 0.2] ) )\n"
    )
    body = got.model("position_0")["body"]
    assert body["shape"] == "compound"
    vertices = got.loaded.world.models[got.robot("position_0")["model"]].body.parts
    assert len(vertices) == 2


def test_an_obstacle_of_several_blocks_is_one_with_their_heights(world) -> None:
    got = world(
        FLOOR + "model ( size [2 1 1] block( z [0 0.5] points 4\n"
        "point[0] [0 0] point[1] [1 0] point[2] [1 1] point[3] [0 1] )\n"
        "block( z [0.5 1] points 4\n"
        "point[0] [1 0] point[1] [2 0] point[2] [2 1] point[3] [1 1] ) )\n"
    )
    low, high = got.data["obstacles"]
    assert ("z" in low, low["height"]) == (False, 0.5)
    assert (high["z"], high["height"]) == (0.5, 0.5)


def test_what_cannot_be_put_elsewhere_as_one_is_listed(world) -> None:
    got = world(
        FLOOR + 'model ( name "a" size [1 1 1] )\n'
        'model ( name "b" pose [4 0 0 0] size [1 1 1] model ( size [0.2 0.2 1] ) )\n'
    )
    assert not got.noted("differs", "text.world:2")
    assert any("first part alone" in what for what in got.noted("differs", "text.world:3"))


# -- heights --------------------------------------------------------------------------------------


def test_a_laser_on_top_of_its_robot_looks_over_what_is_lower(world) -> None:
    low = "model ( pose [1 0 0 0] size [0.2 2 0.35] )\nmodel ( pose [2 0 0 0] size [0.2 2 1] )\n"
    top = ROBOT.format(x=0).replace("pose [0 0 -0.2 0]", "pose [0 0 0.1 0]")
    assert Driven(world(FLOOR + low + ROBOT.format(x=0))).range() == pytest.approx(0.9)
    got = world(FLOOR + low + top)
    assert got.model("r")["sensors"][0]["z"] == pytest.approx(0.3 + 0.1 + 0.01)
    assert Driven(got).range() == pytest.approx(1.9)


def test_a_robot_passes_beneath_what_begins_above_it(world) -> None:
    bridge = "model ( pose [2 0 0.3001 0] size [0.5 8 0.2] )\n"
    assert Driven(world(FLOOR + bridge + ROBOT.format(x=0))).ahead(8) > 3


def test_stack_children_says_where_a_sensor_sits(world) -> None:
    got = world(
        FLOOR + "position ( size [0.4 0.4 0.3] stack_children 0\n"
        "ranger ( pose [0 0 0.1 0] sensor ( samples 9 ) ) )\n"
    )
    assert got.model("position_0")["sensors"][0]["z"] == pytest.approx(0.11)


# -- where things count from ----------------------------------------------------------------------


def test_coordinates_are_stages_own(world) -> None:
    got = world(
        "model ( size [20 10 1] pose [3 1 0 0] boundary 1 )\nposition ( pose [-5 2 0 90] )\n"
        "model ( pose [8 -2 0 10] size [1 1 1] )\n"
    )
    assert got.data["origin"] == [7, 4]
    assert got.data["robots"][0]["pose"] == [-5, 2, 90]
    assert got.data["obstacles"][0]["pose"] == [8, -2, 10]
    assert world(FLOOR + "position ( )\n").data["origin"] == "center"


@pytest.mark.parametrize(
    ("told", "reads"),
    [
        ("", (2, 1, 90)),
        ('localization "odom"', (0, 0, 0)),
        ('localization "odom" localization_origin [0 0 0 0]', (2, 1, 90)),
        ('localization "odom" localization_origin [1 0 0 90]', (1, -1, 0)),
        ('localization "gps" localization_origin [1 0 0 90]', (2, 1, 90)),
    ],
)
def test_the_first_position_that_a_robot_reads_is_stages(world, told, reads) -> None:
    got = world(FLOOR + f"position ( pose [2 1 0 90] {told} )\n")
    first = Driven(got).scenery.odometry.poses[0]
    x, y, heading = reads
    assert first.tolist() == pytest.approx([x, y, math.radians(heading)], abs=1e-9)


# -- worlds that nothing may stop -----------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "position ( ranger ( size [0 0 0] sensor ( samples 9 ) ) )",
        "position ( ranger ( sensor ( fov 0 samples 11 ) ) )",
        "position ( ranger ( sensor ( range [0 0] samples 11 ) sensor ( range [0 0] ) ) )",
        "position ( ranger ( sensor ( noise [0.01] samples 9 ) ) )",
        "position ( laser ( samples 1 ) )",
        "position ( laser ( fov 0 ) )",
        "position ( blobfinder ( fov 0 image [0 0] ) fiducial ( fov 0 range_max 0 ) bumper ( ) )",
        "position ( velocity_bounds [0 0 0 0 0 0 -90 90] )",
        "position ( velocity_bounds [-1 1 0 0 0 0 0 0] )",
        "position ( velocity_bounds [0 0 0 0 0 0 0 0] )",
        "position ( noblocks 1 )",
        "position ( size [0 0 0] )",
        "model ( size [0 0 0] )",
        "model ( polygons 1 polygon[0].points 4 polygon[0].point[0] [0 0]\n"
        "polygon[0].point[1] [1 0] polygon[0].point[2] [1 1] polygon[0].point[3] [0 1] )",
        "position ( block ( points 2 ) )",
        "model ( block ( points 3 point[0] [0 0] ) )",
        "model ( pose [1 1 -3 0] )",
    ],
)
def test_nothing_that_stage_takes_stops_a_world(world, text) -> None:
    world(FLOOR + text + "\n")  # it loads: what `troupe check` refuses raises


def test_a_white_bitmap_is_an_empty_arena_with_its_boundary(world, tmp_path) -> None:
    (tmp_path / "white.pgm").write_text("P2\n2 2\n9\n9 9\n9 9\n")
    got = world('model ( size [6 4 1] bitmap "white.pgm" boundary 1 )\n' + ROBOT.format(x=0))
    assert got.data["size"] == [6, 4]
    assert got.data["boundary"]
    assert "map" not in got.data
    assert Driven(got).range() == pytest.approx(3.0)


def test_a_polygon_of_stage_2_is_a_block(world) -> None:
    got = world(
        FLOOR + "model ( size [2 1 1] polygons 1 polygon[0].points 3 polygon[0].point[0] [0 0]\n"
        "polygon[0].point[1] [4 0] polygon[0].point[2] [0 4] )\n"
    )
    (one,) = got.data["obstacles"]
    assert sorted(one["points"]) == [[-1, -0.5], [-1, 0.5], [1, -0.5]]


def test_a_map_that_player_serves_is_listed_and_the_rest_goes_on(world) -> None:
    cfg = (
        'driver ( name "stage" provides ["map:0"] model "hall" )\n'
        'driver ( name "stage" provides ["6665:position2d:0"] model "r" )\n'
        'driver ( name "stage" provides ["6665:ranger:0"] model "r.ranger:0" )\n'
        'driver ( name "mapfile" provides ["map:1"] filename "a.png" )\n'
    )
    got = world(FLOOR + ROBOT.format(x=0), cfg)
    assert got.robot("r")["controller"] == "client"
    assert any("map of hall" in what for what in got.noted("lost", "text.cfg:1"))
    assert not got.noted("lost", "text.cfg:3")


def test_transducers_keep_their_own_range_and_view(world) -> None:
    got = world(
        FLOOR + "position ( ranger ( scount 3 spose[0] [0.1 0 30] spose[1] [0 0.1 90]\n"
        "sview [0.2 4 25] sview[1] [0.2 2 10] ) )\n"
    )
    assert got.model("position_0")["sensors"] == [
        {
            "type": "ranger", "elements": [[0.1, 0, 30], [0, 0.1, 90], [0, 0, 0]],
            "range": [4, 2, 4], "min_range": 0.2, "fov": [25, 10, 25],
        }
    ]  # fmt: skip


def test_an_old_laser_and_an_old_blobfinder_keep_what_they_say(world) -> None:
    got = world(
        FLOOR + "position ( laser ( range_min 0.1 range_max 5 laser_sample_skip 2 samples 90 )\n"
        'blobfinder ( channels_count 2 channels ["red" "green" "blue"] ) )\n'
    )
    laser, blobs = got.model("position_0")["sensors"]
    assert (laser["min_range"], laser["range"]) == (0.1, 5)
    assert blobs["colors"] == ["red", "green"]
    assert any("laser_sample_skip" in what for what in got.noted("differs", "text.world:2"))


def test_equal_robots_share_a_model_whatever_the_rounding(world) -> None:
    robots = "".join(f"a ( pose [{n % 10 - 5} {n // 10 - 4} 0 {7.3 * n}] )\n" for n in range(60))
    sensor = "ranger ( pose [0.1 0.07 0 33] sensor ( samples 9 ) )"
    got = world(FLOOR + f"define a position ( size [0.2 0.2 0.2] {sensor} )\n" + robots)
    assert list(got.data["models"]) == ["a"]


def test_a_robot_with_stages_wander_is_driven_by_ours(world) -> None:
    got = world(FLOOR + 'position ( name "a" ctrl "wander" )\nposition ( pose [3 3 0 0] )\n')
    assert [robot["controller"] for robot in got.data["robots"]] == ["wander", None]


def test_a_bitmap_of_more_pixels_than_a_map_may_have_is_read_coarser(
    world, tmp_path, monkeypatch
) -> None:
    monkeypatch.setattr("sim.stage.imagemap.MOST_PIXELS", 20_000)
    monkeypatch.setattr("troupe.importers.stage.bitmap.MOST_CELLS", 10_000)
    columns, rows = 180, 150
    pixels = np.full((rows, columns), 255, np.uint8)
    pixels[:, 90] = 0  # a wall of one pixel
    pixels[[0, -1], :] = 0
    pixels[:, [0, -1]] = 0
    (tmp_path / "huge.pgm").write_bytes(b"P5 %d %d 255\n" % (columns, rows) + pixels.tobytes())
    got = world('model ( size [18 15 1] bitmap "huge.pgm" )\n' + ROBOT.format(x=-3))
    assert Driven(got).range() == pytest.approx(3.0, abs=0.25)


def test_models_keep_their_names_and_none_is_a_robots(world) -> None:
    got = world(
        FLOOR + 'model ( name "crate 1" pose [5 0 0 0] size [1 1 1] )\n'
        'model ( name "r" pose [5 3 0 0] size [0.2 0.2 0.2] gripper_return 1 )\n'
        + ROBOT.format(x=0)
    )
    assert [one["name"] for one in got.data["obstacles"]] == ["crate_1", "r_2"]
    assert any("is called r_2 here" in what for what in got.noted("differs", "text.world:3"))
