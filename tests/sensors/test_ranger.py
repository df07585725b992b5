"""The ranger: cones in sonar style, and scans."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError
from sensing import BOX, Stage

from sensors.cones import cast_cones
from sensors.registry import settings_for
from sensors.scene import Scene
from troupe.testing import rays


def test_each_element_looks_from_its_own_place():
    stage = Stage()
    elements = [[0.5, 0, 0], [0, 0.5, 90], [0, -0.5, -90]]
    stage.robot(1, 2, np.pi / 2, {"type": "ranger", "elements": elements, "fov": 5})
    stage.wall(-9, 5, 9, 5)  # 3 m ahead of the robot's centre
    stage.wall(-1, -9, -1, 9)  # 2 m to its left
    stage.sense()
    readings = stage.data()
    assert readings.kind == "elements"
    np.testing.assert_allclose(readings.ranges[0], [2.5, 1.5, 5.0])
    np.testing.assert_allclose(readings.poses[1], [0, 0.5, np.pi / 2])


def test_the_nearest_thing_in_the_cone_counts_not_that_straight_ahead():
    stage = Stage()
    stage.robot(0, 0, 0, {"type": "ranger", "fov": 30})
    stage.box(4, 0)
    corner = stage.box(2.0, -0.9)  # its corner at (1.5, -0.4) lies 14.9 degrees to the right
    stage.sense()
    assert stage.data().ranges[0, 0] == pytest.approx(np.hypot(1.5, 0.4))
    stage.scene.poses[corner, 1] -= 0.1  # and now outside of the cone
    stage.sense()
    ranges = stage.data().ranges[0, 0]
    assert ranges == pytest.approx(np.hypot(0.5 / np.tan(np.radians(15)), 0.5))


def test_a_ranger_with_samples_is_a_scan_from_its_one_element():
    stage = Stage()
    scan = {"samples": 61, "fov": 60, "range": 9}
    stage.robot(
        1, 1, 0.5, {"type": "ranger", "pose": [0.1, 0, 10], "elements": [[0.2, 0.1, 20]]} | scan
    )
    x, y = np.array([0.1, 0]) + turned(np.radians(10)) @ [0.2, 0.1]
    stage.robot(1, 1, 0.5, {"type": "laser", "pose": [x, y, 30]} | scan)
    stage.wall(4, -9, 4, 9)
    entities = stage.suite.groups
    stage.scene.hide(1)
    stage.scene.hide(0)
    stage.sense()
    assert stage.data(0).kind == "scan"
    assert len(entities) == 2
    np.testing.assert_allclose(stage.data(0).ranges, stage.data(1).ranges, atol=1e-9)
    assert (stage.data(0).ranges < 9).any()


def turned(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def test_samples_need_a_single_element():
    spec = {"type": "ranger", "samples": 10, "elements": [[0, 0, 0], [0, 0, 90]]}
    with pytest.raises(ValidationError, match="samples needs a single element, but there are 2"):
        settings_for(spec)


def test_noise_spares_elements_that_hit_nothing():
    stage = Stage()
    stage.robot(0, 0, 0, {"type": "ranger", "elements": [[0, 0, 0], [0, 0, 180]], "noise": 0.1})
    stage.wall(3, -1, 3, 1)
    seen = []
    for tick in range(50):
        stage.sense(tick)
        seen.append(stage.data().ranges[0].copy())
    seen = np.array(seen)
    assert (seen[:, 1] == 5.0).all()
    # 50 samples of deviation 0.1
    assert 0.05 < seen[:, 0].std() < 0.2
    assert abs(seen[:, 0].mean() - 3) < 5 * 0.1 / np.sqrt(50)


coordinate = st.floats(-3, 3).map(lambda v: round(v, 2))
pose = st.tuples(coordinate, coordinate, coordinate)


@settings(max_examples=250)
@given(
    st.lists(
        st.tuples(pose, st.sampled_from(["box", "circle", "wall", "huge", "block", "round"])),
        max_size=8,
    ),
    st.lists(pose, min_size=1, max_size=3),
    st.sampled_from([0.05, 0.5, np.pi / 2, np.pi, 4.0, 2 * np.pi]),
    st.sampled_from([1.0, 20.0]),
)
def test_a_cone_measures_what_brute_force_finds_nearest(things, sensors, fov, max_range):
    scene, world = Scene(), rays.Things()
    for at, kind in things:
        entity = scene.add_entity(pose=at)
        place = np.array(at)
        if kind == "circle":
            scene.add_circle(entity, 0.4)
            world.circle(entity, place, 0.4)
        elif kind == "wall":
            wall = np.array([[-1.0, 0.0, 1.5, 0.2]])
            scene.add_segments(entity, wall)
            world.segments(entity, place, wall)
        elif kind in ("block", "round"):
            corners = BOX if kind == "block" else BOX * 7
            scene.add_solid(entity, corners if kind == "block" else corners[::-1])
            world.inside(entity, place, corners, kind == "round")
            faces = np.hstack([corners, np.roll(corners, -1, axis=0)])
            scene.add_segments(entity, faces)
            world.segments(entity, place, faces)
        else:
            shape = BOX if kind == "box" else BOX * (6, 4)
            scene.add_polygon(entity, shape)
            world.polygon(entity, place, shape)
    scene.refresh()
    origins = np.array(sensors)
    ranges = np.empty(len(origins))
    cast_cones(scene.arrays, origins, np.full(len(origins), -1), fov, max_range, ranges)
    for origin, measured in zip(origins, ranges, strict=True):
        low, high = rays.cone(world, origin, -1, fov, max_range)
        assert low - 1e-9 <= measured <= high + 1e-9
