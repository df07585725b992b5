"""The fiducial finder: who is in sight, and where."""

import numpy as np
import pytest
from sensing import Stage

FINDER = {"type": "fiducial"}


def seen(stage, robot=0):
    stage.sense()
    return stage.data(robot).seen(0)


def test_it_sees_ids_and_relative_poses_nearest_first():
    stage = Stage()
    stage.robot(1, 1, np.pi / 2, FINDER, fiducial=9)
    stage.box(1, 6, 0.3, fiducial=4)
    stage.box(-1, 3, np.pi, fiducial=-7)
    found = seen(stage)
    assert found["id"].tolist() == [-7, 4]  # and never its own
    np.testing.assert_allclose(found["x"], [2, 5])
    np.testing.assert_allclose(found["y"], [2, 0], atol=1e-12)
    np.testing.assert_allclose(found["yaw"], [np.pi / 2, 0.3 - np.pi / 2])


def test_the_pose_is_relative_to_the_sensor_not_to_the_robot():
    stage = Stage()
    stage.robot(0, 0, 0, FINDER | {"pose": [0.5, 0, 90]})
    stage.box(0.5, 3, 0, fiducial=1)
    found = seen(stage)
    assert (found["x"][0], found["y"][0]) == pytest.approx((3, 0))
    assert found["yaw"][0] == pytest.approx(-np.pi / 2)


def test_what_is_hidden_behind_something_is_not_in_sight():
    stage = Stage()
    stage.robot(0, 0, 0, FINDER)
    stage.box(5, 0, fiducial=3)
    assert len(seen(stage)) == 1
    screen = stage.wall(2, -0.01, 2, 0.01)  # covers the centre alone, which is what counts
    assert len(seen(stage)) == 0
    stage.scene.hide(screen)
    assert len(seen(stage)) == 1


def test_range_and_fov_are_about_the_centre():
    stage = Stage()
    stage.robot(0, 0, 0, FINDER | {"range": 4, "fov": 90})
    box = stage.box(4.01, 0, fiducial=3)
    assert len(seen(stage)) == 0
    stage.scene.poses[box, 0] = 4.0
    assert len(seen(stage)) == 1
    stage.scene.poses[box, :2] = 2, 2.01
    assert len(seen(stage)) == 0
    stage.scene.poses[box, :2] = 2, -2
    assert len(seen(stage)) == 1


def test_what_is_too_near_is_not_seen_and_the_id_of_what_is_far_is_not_read():
    stage = Stage()
    stage.robot(0, 0, 0, FINDER | {"range": 8, "min_range": 1, "id_range": 4})
    for number, (distance, bearing) in enumerate(
        ((0.9, -1.5), (1.0, -0.7), (4.0, 0.5), (6.0, 1.3))
    ):
        stage.box(
            distance * np.cos(bearing), distance * np.sin(bearing), size=0.1, fiducial=number + 1
        )
    found = seen(stage)
    assert found["id"].tolist() == [2, 3, 0]
    np.testing.assert_allclose(np.hypot(found["x"], found["y"]), [1.0, 4.0, 6.0])


def test_only_the_ids_looked_for_are_seen():
    stage = Stage()
    stage.robot(0, 0, 0, FINDER | {"ids": [2, 5]})
    for k, y in enumerate((-4, -2, 0, 2, 4)):
        stage.box(4, y, fiducial=k + 1)
    assert sorted(seen(stage)["id"]) == [2, 5]


def test_what_has_no_id_and_what_has_no_body():
    stage = Stage()
    stage.robot(0, 0, 0, FINDER)
    stage.box(3, 0)
    stage.scene.add_entity(fiducial=6, pose=(0, 2, 0))  # a mark on the floor, say
    assert seen(stage)["id"].tolist() == [6]


def test_many_are_seen_at_once_by_each_of_several_robots():
    stage = Stage()
    for k in range(3):
        stage.robot(0.0, 20.0 * k, 0, FINDER, fiducial=100 + k)
    angles = np.linspace(-1.5, 1.5, 40)
    for k in (0, 2):
        for n, angle in enumerate(angles):
            mark = stage.scene.add_entity(
                fiducial=n + 1, pose=(7 * np.cos(angle), 20 * k + 7 * np.sin(angle), 0)
            )
            stage.scene.add_circle(mark, 0.05)
    stage.sense()
    for k, count in enumerate((40, 0, 40)):
        found = stage.data(k).seen(0)
        assert sorted(found["id"]) == list(range(1, count + 1))
    # Equally far, so in the order of the entities.
    np.testing.assert_allclose(np.hypot(found["x"], found["y"]), 7)


def test_a_thing_at_the_very_place_of_the_sensor_does_no_harm():
    stage = Stage()
    stage.robot(0, 0, 0, FINDER)
    stage.box(0, 0, fiducial=5)
    assert seen(stage)["id"].tolist() == [5]
