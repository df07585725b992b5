"""Bodies, drives and sensors of worlds in Stage's format become those of our models."""

from __future__ import annotations

import math

import numpy as np
import pytest

FLOOR = "model ( size [20 10 1] boundary 1 )\n"


# -- bodies and obstacles -----------------------------------------------------------------------


def test_blocks_are_scaled_to_the_models_size_and_moved_to_its_origin(world) -> None:
    body = world("hall.world").model("cart_1")["body"]
    assert body["shape"] == "polygon"
    # A triangle of 4 x 2 on 1 x 0.6 m, moved 0.2 m ahead.
    expected = {(-0.3, -0.3), (0.7, 0.0), (-0.3, 0.3)}
    assert {tuple(round(c, 9) for c in point) for point in body["points"]} == expected


def test_an_obstacle_that_is_not_convex_keeps_its_outline(world) -> None:
    (one,) = [o for o in world("hall.world").data["obstacles"] if o["shape"] == "compound"]
    (part,) = one["parts"]
    x, y = np.array(part["points"]).T
    area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    assert area == pytest.approx(0.4 * 0.2 * 3 / 4)  # an L: three of four quarters of its box


def test_a_robot_of_several_blocks_has_them_all(world) -> None:
    got = world(
        FLOOR + "position ( size [1 1 1]\n"
        "block( points 4 point[0] [0 0] point[1] [3 0] point[2] [3 1] point[3] [0 1] )\n"
        "block( points 4 point[0] [0 0] point[1] [1 0] point[2] [1 3] point[3] [0 3] ) )\n"
    )
    body = got.model("position_0")["body"]
    assert body["shape"] == "compound"
    first, second = body["parts"]
    assert first["size"] == pytest.approx([1, 1 / 3])
    assert second["pose"] == pytest.approx([-1 / 3, 0, 0])


def test_what_a_gripper_could_take_can_be_pushed(world) -> None:
    got = world("yard.world")
    ball = next(o for o in got.data["obstacles"] if o.get("size") == [0.3, 0.3])
    assert (ball["movable"], ball["mass"]) == (True, 0.5)


@pytest.mark.parametrize(
    ("text", "color"),
    [
        ('color "Light Blue"', "lightblue"),
        ("color_rgba [1 0.5 0 1]", "#ff8000"),
        ('color "random"', "random"),
        ('color "nosuch"', "red"),
        ("", "red"),
    ],
)
def test_colours_are_carried_over(world, text: str, color: str) -> None:
    got = world(FLOOR + f"position ( {text} )\n")
    assert got.model("position_0")["body"]["color"] == color
    assert bool(got.noted("differs", "text.world:2")) == text.endswith('such"')


# -- robots -------------------------------------------------------------------------------------


def test_a_drive_keeps_its_limits(world) -> None:
    assert world("yard.world").model("r0")["drive"] == {
        "kind": "differential", "max_speed": 0.6, "max_turn_rate": 120,
    }  # fmt: skip
    assert world("open.world").model("position_0")["drive"]["kind"] == "omnidirectional"
    car = world("hall.world").model("cart_1")["drive"]
    assert (car["kind"], car["wheelbase"]) == ("car", 0.4)


def test_robots_that_differ_in_nothing_share_a_model(world) -> None:
    got = world(
        FLOOR + "define a position ( )\na ( )\na ( pose [2 2 0 0] )\na ( mass 3 pose [4 4 0 0] )\n"
    )
    assert [robot["model"] for robot in got.data["robots"]] == ["a", "a", "a_2"]


def test_robots_that_are_written_alike_share_a_model_wherever_they_stand(world) -> None:
    robots = "".join(f"a ( pose [{x} {y} 0 30] )\n" for x, y in [(-4.5, 0), (-2, 2), (3.1, -3.7)])
    got = world(FLOOR + "define a position ( blobfinder ( pose [0.2 0 0 0] ) )\n" + robots)
    assert list(got.data["models"]) == ["a"]


def test_names_that_we_cannot_have_are_changed_and_noted(world) -> None:
    got = world("hall.world")
    assert [robot["name"] for robot in got.data["robots"]] == ["cart_1", "cart_1_2"]
    assert got.noted("differs", "hall.world:24")[-1] == "robot cart 1 is called cart_1_2 here"


def test_localization_is_carried_over(world) -> None:
    model = world("yard.world").model("r0")
    assert model["localization"] == "odometry"
    assert model["odometry_noise"] == {"bias": [0.05, 0.05, 0.1]}
    plain = world(FLOOR + 'position ( localization "odom" )\n').model("position_0")
    assert plain["odometry_noise"] == {"bias": [0.03, 0.03, 0.05]}
    exact = world(FLOOR + 'position ( localization "odom" odom_error [0 0 0 0] )\n')
    assert "odometry_noise" not in exact.model("position_0")
    assert world("hall.world").model("cart_1")["localization"] == "gps"


# -- sensors ------------------------------------------------------------------------------------


def test_single_beams_are_the_elements_of_one_ranger(world) -> None:
    assert world("yard.world").model("r0")["sensors"][0] == {
        "type": "ranger",
        "z": 0.31,
        "elements": [[0.2, 0.1, 45], [0.2, -0.1, -45], [-0.2, 0, 180]],
        "range": 3,
        "fov": 20,
    }


def test_a_scan_is_a_laser_with_the_variance_of_its_noise_as_deviation(world) -> None:
    assert world("yard.world").model("r0")["sensors"][1] == {
        "type": "laser", "pose": [0.1, 0, 0], "z": 0.11, "range": 8, "fov": 270, "samples": 271,
        "noise": 0.02,
    }  # fmt: skip


def test_a_range_finder_tells_the_size_that_its_model_has(world) -> None:
    got = world(
        FLOOR + "position ( ranger ( size [0.156 0.155 0.19] sensor ( samples 9 ) )\n"
        "ranger ( size [0 0 0] sensor ( ) ) laser ( size [0.2 0.1 0.1] ) )\n"
    )
    told = [sensor.get("housing") for sensor in got.model("position_0")["sensors"]]
    assert told == [[0.156, 0.155], None, [0.2, 0.1]]
    assert not got.noted("looks", "text.world:2")


def test_several_scans_of_one_ranger_are_sensors_of_their_own(world) -> None:
    got = world(
        FLOOR + "position ( ranger ( pose [0.1 0 0 90]\n"
        "sensor ( pose [0.2 0 0 0] samples 10 fov 30 ) sensor ( samples 20 fov 60 ) ) )\n"
    )
    first, second = got.model("position_0")["sensors"]
    assert first["pose"] == pytest.approx([0.1, 0.2, 90])
    assert (second["samples"], second["fov"], second["range"]) == (20, 60, 5)


def test_a_blobfinder_keeps_view_image_and_colours(world) -> None:
    blobs = world("hall.world").model("cart_1")["sensors"][0]
    assert blobs["pose"] == pytest.approx([0, 0, math.degrees(0.75)])
    del blobs["pose"]
    assert blobs == {
        "type": "blobfinder", "range": 7, "fov": 90, "image": [64, 48],
        "colors": ["red", "lightblue"],
    }  # fmt: skip


def test_bumpers_are_arcs_as_wide_as_they_are_seen_from_the_middle(world) -> None:
    ahead, left = world("hall.world").model("cart_1")["sensors"][2]["parts"]
    half = math.degrees(math.atan2(0.2, 0.5))
    assert ahead == pytest.approx([-half, half])
    assert left == pytest.approx([45, 135])


def test_the_ranger_of_stage_3_is_read(world) -> None:
    got = world(
        FLOOR + "position ( ranger ( scount 2 spose[0] [0.1 0 30] spose[1] [0 0.1 90]\n"
        "sview [0 4 25] ) )\n"
    )
    assert got.model("position_0")["sensors"] == [
        {"type": "ranger", "elements": [[0.1, 0, 30], [0, 0.1, 90]], "range": 4, "fov": 25}
    ]
