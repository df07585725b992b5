"""The suite: sensors of equal settings are one batch, and only what is wanted is sensed."""

import numpy as np
import pytest
from sensing import Stage

from sensors.readings import Blobs

LASER = {"type": "laser", "samples": 5, "noise": 0.01}
CAMERA = {"type": "blobfinder", "image": [20, 10]}


def room(robots=3, *specs):
    stage = Stage()
    stage.wall(-5, -5, 50, -5)
    for k in range(robots):
        stage.robot(3.0 * k, 0, 0.1 * k, *(specs or (LASER, CAMERA)))
    return stage


def test_equal_settings_make_one_batch_in_the_order_in_which_they_came():
    stage = room(3, LASER, CAMERA, LASER)
    stage.robot(0, 9, 0, CAMERA, LASER | {"range": 7})
    stage.sense()
    groups = stage.suite.groups
    assert [(g.type.name, g.kind, len(g.robots)) for g in groups] == [
        ("laser", "scan", 6),
        ("blobfinder", "blobs", 4),
        ("laser", "scan", 1),
    ]
    assert groups[0].robots.tolist() == [0, 0, 1, 1, 2, 2]
    assert groups[0].slots.tolist() == [0, 2, 3, 5, 6, 8]
    assert groups[0].readings.ranges.shape == (6, 5)
    assert stage.suite.slots == 11
    assert stage.suite.first_slot == [0, 3, 6, 9]


def test_robots_that_enter_one_by_one_are_copied_once():
    """Whoever enters asks for its places; the arrays grow when all have."""
    stage = Stage()
    for k in range(20):
        stage.robot(3.0 * k, 0, 0, LASER, CAMERA)
        group, row = stage.suite.place(k, 0)
        assert (group.kind, row) == ("scan", k)
        assert len(group.readings.ranges) == 0
    stage.sense()
    assert stage.suite.groups[0].readings.ranges.shape == (20, 5)


def test_a_reading_is_a_view_of_its_row():
    stage = room()
    stage.sense()
    group, row = stage.suite.place(2, 0)
    assert np.shares_memory(stage.data(2, 0).ranges, group.readings.ranges)
    np.testing.assert_array_equal(stage.data(2, 0).ranges[0], group.readings.ranges[row])
    assert stage.suite.reading(2, 1).data.kind == "blobs"


def test_only_what_is_wanted_is_sensed_and_the_rest_stays():
    stage = room()
    stage.sense(0)
    before = [stage.data(r, 0).ranges.copy() for r in range(3)]
    stage.scene.poses[:, 1] += 1.0
    stage.scene.poses[0, 1] = 0.0
    wanted = np.zeros(stage.suite.slots, bool)
    wanted[stage.suite.first_slot[1]] = True
    stage.sense(1, wanted=lambda: wanted)
    assert (stage.data(0, 0).ranges == before[0]).all()
    assert (stage.data(1, 0).ranges != before[1]).any()
    assert stage.suite.groups[0].rows.tolist() == [1]
    assert stage.suite.groups[1].rows.tolist() == []
    times = [stage.suite.reading(r, i).time for r in range(3) for i in range(2)]
    assert times == [0, 0, 0.1, 0, 0, 0]


def test_leaving_out_sensors_and_adding_robots_changes_no_other_reading():
    everything, little, more = room(), room(), room(5)
    wanted = np.array([True, False, False, False, True, False])
    for tick in range(4):
        everything.sense(tick)
        more.sense(tick)
        if tick != 1:
            little.sense(tick, wanted=wanted if tick != 3 else None)
    for robot in range(3):
        scan = everything.data(robot, 0).ranges
        np.testing.assert_array_equal(scan, little.data(robot, 0).ranges)
    # The fourth robot stands where the first three look at the wall: compare what is not it.
    same = everything.data(0, 0).hits == more.data(0, 0).hits
    assert same.sum() >= 3
    np.testing.assert_array_equal(everything.data(0, 0).ranges[same], more.data(0, 0).ranges[same])


def test_robots_may_come_at_any_time():
    stage = room(1)
    stage.sense(0)
    first = stage.data(0, 0).ranges.copy()
    robot = stage.robot(0, 20, 0, LASER, CAMERA)
    assert stage.suite.reading(robot, 0).time == -1
    assert (stage.data(robot, 0).ranges == 20.0).all()  # nothing seen yet
    assert (stage.data(0, 0).ranges == first).all()
    stage.sense(1)
    assert stage.suite.reading(robot, 0).time == pytest.approx(0.1)
    assert stage.suite.groups[0].readings.ranges.shape == (2, 5)


def test_the_same_run_gives_the_same_bits():
    def run():
        stage = room(4)
        out = []
        for tick in range(5):
            stage.scene.poses[:, 0] += 0.1
            stage.sense(tick)
            out.append(stage.suite.groups[0].readings.ranges.tobytes())
        return out

    assert run() == run()


def test_groups_of_one_settings_do_not_share_a_batch_when_the_mount_differs():
    stage = room(1, LASER, LASER | {"pose": [0, 0, 90]})
    stage.sense()
    assert len(stage.suite.groups) == 2
    np.testing.assert_allclose(stage.suite.groups[1].origins[0], [0, 0, np.pi / 2])


def test_mistakes_are_refused_with_a_reason():
    stage = room(1)
    stage.sense()
    with pytest.raises(IndexError, match="robot 0 has 2 sensors, no sensor 2"):
        stage.suite.reading(0, 2)
    with pytest.raises(ValueError, match="a flag for each of 2"):
        stage.suite.sense(1, 0.1, np.array([True]))


@pytest.mark.parametrize("fov", [90, 180, 360])
def test_sensors_that_are_cast_together_read_what_each_reads_alone(fov):
    laser, camera = LASER | {"fov": fov, "samples": 37}, CAMERA | {"fov": fov, "pose": [0, 0, 0]}
    both, lasers, cameras = room(4, laser, camera), room(4, laser), room(4, camera)
    only_lasers = np.array([True, False] * 4)
    for tick, wanted in enumerate([None, only_lasers, None]):
        both.sense(tick, wanted=wanted)
        lasers.sense(tick)
        if wanted is None:
            cameras.sense(tick)
        for robot in range(4):
            scan, alone = both.data(robot, 0), lasers.data(robot, 0)
            assert (scan.hits >= 0).any()
            np.testing.assert_array_equal(scan.ranges, alone.ranges)
            np.testing.assert_array_equal(scan.hits, alone.hits)
            blobs = both.data(robot, 1).seen(0)
            assert len(blobs) > 0
            np.testing.assert_array_equal(blobs, cameras.data(robot, 0).seen(0))


def test_a_robot_without_sensors_is_a_robot():
    stage = Stage()
    stage.robot(0, 0, 0)
    stage.robot(3, 0, 0, LASER)
    stage.sense()
    assert stage.suite.first_slot == [0, 0]
    with pytest.raises(IndexError):
        stage.suite.reading(0, 0)
    assert stage.data(1, 0).ranges.shape == (1, 5)


def test_what_a_camera_has_seen_stays_when_another_one_comes_and_lies_side_by_side():
    blobs = Blobs.empty(3, 16, 12)
    blobs.counts[:] = [2, 0, 16]
    blobs.blobs["id"] = np.arange(48).reshape(3, 16)
    more = blobs.resized(5)
    assert more.blobs.shape == (5, 16)
    assert more.counts.tolist() == [2, 0, 16, 0, 0]
    for row in range(3):
        assert np.array_equal(more.seen(row), blobs.seen(row))
    first = more.blobs[:, 0]
    assert first.flags.c_contiguous  # of all cameras: what lies behind takes no memory
    assert np.array_equal(more.resized(1).seen(0), blobs.seen(0))
