"""The blobfinder: runs of one colour, as Stage makes blobs of them."""

import math
from itertools import groupby

import numpy as np
import pytest
from pydantic import ValidationError
from sensing import BLUE, BOX, GREEN, RED, Stage

from sensors.registry import settings_for
from troupe.testing import rays

CAMERA = {"type": "blobfinder", "fov": 90, "image": [90, 60], "range": 20}


def blobs(stage, robot=0):
    stage.sense()
    return stage.data(robot).seen(0).copy()


def test_a_box_straight_ahead_is_one_blob_in_the_middle():
    stage = Stage()
    stage.robot(0, 0, 0, CAMERA)
    stage.box(5, 0, color=BLUE, height=0.8)
    (blob,) = blobs(stage)
    assert blob["color"] == BLUE
    assert blob["left"] + blob["right"] == 89  # columns 0 to 89
    assert (blob["x"], blob["y"]) == (44, 30)
    assert 4.5 <= blob["range"] < 4.53
    half = int(math.atan2(0.4, blob["range"]) / (math.pi / 2 / 60))  # rows of half its height
    assert half == 3
    assert (blob["top"], blob["bottom"]) == (30 - half, 30 + half)
    assert blob["area"] == (blob["right"] - blob["left"]) * (blob["bottom"] - blob["top"])


def test_x_grows_to_the_right_and_blobs_come_from_the_right():
    stage = Stage()
    stage.robot(0, 0, 0, CAMERA)
    stage.box(5, 2, color=RED)
    stage.box(5, -2, color=GREEN)
    found = blobs(stage)
    assert found["color"].tolist() == [GREEN, RED]
    assert found["x"][1] < 45 < found["x"][0]
    assert (found["left"] <= found["x"]).all()
    assert (found["x"] <= found["right"]).all()


def test_touching_things_of_one_colour_are_one_blob_and_of_two_colours_two():
    stage = Stage()
    stage.robot(0, 0, 0, CAMERA)
    stage.box(5, -0.5, color=RED)
    other = stage.box(5, 0.5, color=RED)
    assert len(blobs(stage)) == 1
    stage.scene.colors[other] = BLUE
    first, second = blobs(stage)
    assert first["left"] == second["right"] + 1  # a run begins right where the last one ended


def test_a_gap_of_one_column_ends_a_blob():
    stage = Stage()
    stage.robot(0, 0, 0, CAMERA | {"image": [5, 4]})
    stage.box(5, 4.2, color=RED, size=(1, 5))
    stage.box(5, -4.2, color=RED, size=(1, 5))
    assert len(blobs(stage)) == 2


def test_height_and_distance_make_the_rows():
    stage = Stage()
    stage.robot(0, 0, 0, CAMERA)
    box = stage.box(3, 0, height=2.0)
    tall = blobs(stage)[0]
    stage.scene.heights[box] = 0.01
    flat = blobs(stage)[0]
    assert tall["bottom"] - tall["top"] == 2 * int(math.atan2(1.0, tall["range"]) / (math.pi / 120))
    assert flat["top"] == flat["bottom"] == 30
    assert flat["area"] == 0
    stage.scene.heights[box] = 1000.0
    giant = blobs(stage)[0]
    assert (giant["top"], giant["bottom"]) == (0, 60)  # never beyond the image


def test_only_the_colours_told_apart_are_blobs_but_the_others_hide_what_is_behind():
    stage = Stage()
    stage.robot(0, 0, 0, CAMERA | {"colors": ["blue", "#FF0000"]})
    stage.box(9, 0, color=RED, size=(1, 9))
    assert len(blobs(stage)) == 1
    stage.box(5, 0, color=GREEN)
    found = blobs(stage)
    assert len(found) == 2  # left and right of the green one
    assert found["id"].tolist() == [1, 1]  # the place of red among the colours
    stage.box(3, 0, color=BLUE, size=(1, 0.2))
    assert blobs(stage)["id"].tolist() == [1, 0, 1]


def test_nothing_in_range_makes_no_blob_but_the_image_keeps_its_size():
    stage = Stage()
    stage.robot(0, 0, 0, CAMERA | {"range": 4})
    stage.box(5, 0)
    assert len(blobs(stage)) == 0
    assert (stage.data().width, stage.data().height) == (90, 60)


def test_a_robots_own_colour_is_seen_on_others_alone():
    stage = Stage()
    for x in (0, 4):
        stage.robot(x, 0, 0, CAMERA, color=GREEN)
    stage.sense()
    assert stage.data(0).counts.tolist() == [1]
    assert stage.data(1).counts.tolist() == [0]


@pytest.mark.parametrize("seed", range(30))
def test_blobs_are_the_runs_of_colours_that_brute_force_sees(seed):
    rng = np.random.default_rng(seed)
    width, height = int(rng.integers(1, 200)), int(rng.integers(1, 150))
    fov = float(rng.choice([60, 180, 360]))
    stage, world = Stage(), rays.Things()
    colors = [RED, GREEN, BLUE]
    for _ in range(12):
        pose = np.array([*rng.uniform(-8, 8, 2), rng.uniform(-3, 3)])
        entity = stage.box(*pose, color=colors[rng.integers(3)], height=rng.uniform(0.2, 2))
        world.polygon(entity, pose, BOX)
    heading = rng.uniform(-3, 3)
    camera = {"fov": fov, "image": [width, height], "range": 12.0, "colors": ["green", "red"]}
    stage.robot(0.01, 0.02, heading, {"type": "blobfinder"} | camera)
    found = blobs(stage)
    bearings = np.radians(np.linspace(-fov / 2, fov / 2, width) if width > 1 else [0.0])
    seen = rays.scan(world, np.array([0.01, 0.02, heading]), -1, bearings, 12.0)
    shown = [stage.scene.colors[e] if e >= 0 else None for e in seen.owner]
    expected, column = [], 0
    for color, run in groupby(shown):
        n = len(list(run))
        rows = slice(column, column + n)
        if color in (RED, GREEN):
            distance = seen.low[rows].mean()
            tall = stage.scene.heights[seen.owner[rows]].mean()
            half = int(math.atan2(tall / 2, distance) / (math.radians(fov) / height))
            top, bottom = max(height // 2 - half, 0), min(height // 2 + half, height)
            left, right = width - column - n, width - 1 - column
            expected.append((color, left, right, top, bottom, distance))
        column += n
    assert len(found) == len(expected)
    for blob, (color, left, right, top, bottom, distance) in zip(found, expected, strict=True):
        assert (blob["color"], blob["left"], blob["right"]) == (color, left, right)
        assert (blob["top"], blob["bottom"]) == (top, bottom)
        assert blob["range"] == pytest.approx(distance, abs=1e-9)
        assert (blob["x"], blob["y"]) == ((left + right) // 2, (top + bottom) // 2)
        assert blob["id"] == (0 if color == GREEN else 1)


@pytest.mark.parametrize(
    ("mistake", "message"),
    [
        ({"colors": ["gren"]}, "did you mean green"),
        ({"colors": [3.5]}, "an X11 name or #rrggbb"),
        ({"image": [0, 120]}, "greater than or equal to 1"),
        ({"image": [160]}, "Field required"),
        ({"image": [160.5, 120]}, "valid integer"),
    ],
)
def test_impossible_settings_are_mistakes(mistake, message):
    with pytest.raises(ValidationError, match=message):
        settings_for({"type": "blobfinder"} | mistake)
