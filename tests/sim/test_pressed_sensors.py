"""A sensor on the rim of its body reads 0 while that is pressed on something, whatever it is."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from tests.sim.moved_world import Moved

WORLD = """\
size: [10, 6]
duration: 20
boundary: {{color: red}}
models:
  pressing:
    body: {body}
    drive: {{kind: omnidirectional}}
    sensors:
      - {{type: laser, pose: {mount}, range: 8, fov: 90, samples: 5}}
      - {{type: laser, pose: {mount}, range: 8, fov: 360, samples: 9}}
      - {{type: ranger, elements: [{mount}], range: 5}}
      - {{type: ranger, elements: [{mount}], range: 5, fov: 60, samples: 7}}
      - {{type: blobfinder, pose: {mount}, fov: 90, image: [40, 30]}}
      - {{type: fiducial, pose: {mount}, fov: 360}}
  other: {{body: {{shape: circle, radius: 0.4, color: blue}}, fiducial: 7}}
robots:
  - {{name: one, model: pressing, pose: {start}, controller: null}}
  - {{name: marked, model: other, pose: [7.5, 5, 0], controller: null}}
{more}
"""
BODIES = {
    "circle": ("{shape: circle, radius: 0.3}", "[0.3, 0, 0]"),
    "box": ("{shape: box, size: [0.6, 0.4]}", "[0.3, 0, 0]"),
    "corner of a box": ("{shape: box, size: [0.6, 0.4]}", "[0.3, 0.2, 45]"),
    "tip of a polygon": (
        "{shape: polygon, points: [[0.35, 0], [-0.2, 0.25], [-0.2, -0.25]]}",
        "[0.35, 0, 0]",
    ),
    "flat of a polygon": (
        "{shape: polygon, points: [[0.3, -0.2], [0.3, 0.2], [-0.3, 0]]}",
        "[0.3, -0.1, -30]",
    ),
}
TEXT_MAP = "\n".join(
    ["..........", "..........", ".....#####", ".....#####", ".....#....", ".........."]
)
CORNERS = "[[5, 2.4], [5.1, 3.5], [6, 3.1]]"  # a triangle whose long side is met at a slant
THINGS = {
    "the boundary": ("", 0xFF0000),
    "a box": ("obstacles: [{shape: box, size: [1, 1], pose: [5.5, 3, 0], color: green}]", 0xFF00),
    "a turned box": (
        "obstacles: [{shape: box, size: [1, 1], pose: [5.5, 3, 20], color: green}]",
        0xFF00,
    ),
    "a disc": ("obstacles: [{shape: circle, radius: 1, pose: [6, 3, 0], color: green}]", 0xFF00),
    "a triangle": (
        f"obstacles: [{{shape: polygon, points: {CORNERS}, pose: [0, 0, 0], color: green}}]",
        0xFF00,
    ),
    "a movable box": (
        "obstacles: [{shape: box, size: [1, 1], pose: [5.5, 3, 0], color: green, "
        "movable: true, mass: 200, friction: 1}]",
        0xFF00,
    ),
    "a robot": ("  - {name: two, model: other, pose: [5.5, 3, 0], controller: null}", 0xFF),
    "a map's cells": ("map: {file: cells.txt, cell: 1, color: green}", 0xFF00),
}


def pressed(folder: Path, body: str, thing: str) -> Moved:
    """A body that was driven ahead onto something for long enough."""
    shape, mount = BODIES[body]
    more = THINGS[thing][0]
    start = "[9.2, 3, 0]" if thing == "the boundary" else "[4.3, 3, 0]"
    moved = Moved(
        folder,
        WORLD.format(body=shape, mount=mount, start=start, more=more),
        **{"cells.txt": TEXT_MAP},
    )
    moved.drive([(0.4, 0, 0), (0, 0, 0), (0, 0, 0)][: len(moved.names)], 3.5)
    assert moved.scenery.stage.touching[0]
    return moved


FLAT = ["the boundary", "a box", "a movable box", "a map's cells"]
TOUCHING = [(body, thing) for body in BODIES for thing in FLAT]
TOUCHING += [(body, thing) for body in ("circle", "tip of a polygon") for thing in THINGS]
TOUCHING += [("box", "a disc"), ("box", "a robot")]
"""The bodies that touch a thing where their sensors are."""


@pytest.mark.parametrize(("body", "thing"), sorted(set(TOUCHING)))
def test_a_sensor_on_the_rim_reads_zero_where_its_body_is_pressed_on_something(
    body: str, thing: str, tmp_path: Path
) -> None:
    moved = pressed(tmp_path, body, thing)
    if body == "circle" and thing in ("a turned box", "a triangle"):
        # It meets a slanted face: turn, so that the mount is where it touches.
        points = moved.scenery.stage.contact_points[1]
        toward = math.atan2(*(points[0] - moved.poses[0, :2])[::-1])
        moved.scenery.put({0: (*moved.poses[0, :2], toward)})
        moved.drive([(0, 0, 0)] * len(moved.names), 0.1)
    for index in range(4):
        assert (moved.data(0, index).ranges == 0.0).all(), index
    (blob,) = moved.data(0, 4).seen(0)
    assert (blob["color"], blob["range"]) == (THINGS[thing][1], 0.0)
    assert (blob["left"], blob["right"]) == (0, 39)
    # Of the marked robots the one that it touches may be in sight, and nothing behind.
    seen = moved.data(0, 5).seen(0)
    assert len(seen) == (1 if thing == "a robot" else 0)


def test_a_body_in_a_corner_has_its_sensors_within_both_walls(tmp_path: Path) -> None:
    body, _ = BODIES["box"]
    for mount in ("[0.3, 0.2, 45]", "[0.3, 0, 0]", "[0, 0.2, 90]", "[0.3, -0.2, -90]"):
        text = WORLD.format(body=body, mount=mount, start="[9, 5.2, 0]", more="")
        moved = Moved(tmp_path, text)
        moved.drive([(0.3, 0.3, 0), (0, 0, 0)], 5)
        for index in range(4):
            assert (moved.data(0, index).ranges == 0.0).all(), mount
        assert moved.data(0, 4).seen(0)["range"].tolist() == [0.0]


def test_beside_the_place_where_it_touches_a_sensor_reads_the_distance(tmp_path: Path) -> None:
    moved = pressed(tmp_path, "circle", "the boundary")
    x, y, heading = moved.poses[0]
    for turn in (0.3, 1.0, -1.0, 2.0):
        # 2 mm back, as where it is pressed it may be deeper in the wall than one may be put
        assert moved.scenery.put({0: (x - 0.002, y, heading + turn)}) == []
        moved.drive([(0, 0, 0)] * 2, 0.1)
        x, y, now = moved.poses[0]
        mount = np.array([x + 0.3 * math.cos(now), y + 0.3 * math.sin(now)])
        ranges = moved.data(0, 0).ranges[0]
        along = np.cos(now + np.radians([-45, -22.5, 0, 22.5, 45]))
        with np.errstate(divide="ignore"):
            to_wall = np.where(along > 0, (10 - mount[0]) / along, np.inf)
        assert (ranges > 0.0).all()
        near = to_wall < 2.0  # the other walls are 2.7 m off at the least
        np.testing.assert_allclose(ranges[near], to_wall[near], atol=1e-9)
        assert (ranges[~near] >= 2.0).all()


@pytest.mark.parametrize("radius", [0.2, 1.0, 20.0])
def test_a_round_obstacle_is_touched_where_it_is_seen(radius: float, tmp_path: Path) -> None:
    """From every side: to physics it is as round as to sensors."""
    shape, mount = BODIES["circle"]
    middle = np.array([30.0, 30.0])
    obstacle = f"{{shape: circle, radius: {radius}, pose: [30, 30, 0]}}"
    text = WORLD.format(body=shape, mount=mount, start="[3, 3, 0]", more=f"obstacles: [{obstacle}]")
    moved = Moved(tmp_path, text.replace("size: [10, 6]", "size: [60, 60]"))
    for angle in np.radians([0, 3.75, 7.5, 90, 131, 222.2, 300]):
        away = np.array([math.cos(angle), math.sin(angle)])
        moved.scenery.put({0: (*(middle + (radius + 0.4) * away), angle + math.pi)})
        moved.drive([(0.3, 0, 0), (0, 0, 0)], 2)
        assert moved.scenery.stage.touching[0]
        gap = np.hypot(*(moved.poses[0, :2] - middle)) - radius - 0.3
        # Chipmunk leaves bodies that rest on each other 5 mm in one another at the most.
        assert -0.0055 < gap <= 0.0
        for index in range(4):
            assert (moved.data(0, index).ranges == 0.0).all()


def test_a_robot_that_is_pressed_on_another_does_not_look_through_it(tmp_path: Path) -> None:
    more = "  - {name: two, model: pressing, pose: [6, 3, 180], controller: null}"
    shape, mount = BODIES["circle"]
    moved = Moved(tmp_path, WORLD.format(body=shape, mount=mount, start="[5, 3, 0]", more=more))
    moved.drive([(0.3, 0, 0), (0, 0, 0), (0.3, 0, 0)], 2)
    for robot in (0, 2):
        for index in range(4):
            assert (moved.data(robot, index).ranges == 0.0).all()
