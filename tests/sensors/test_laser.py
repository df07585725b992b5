"""The laser: where it looks from, what it reads, its noise."""

import numpy as np
import pytest
from pydantic import ValidationError
from sensing import Stage

from sensors.registry import settings_for


def test_the_defaults_are_180_rays_over_180_degrees_to_20_metres():
    stage = Stage()
    stage.robot(0, 0, 0, {"type": "laser"})
    stage.sense()
    scan = stage.data()
    assert scan.ranges.shape == (1, 180)
    assert (scan.ranges == 20.0).all()
    np.testing.assert_allclose(scan.bearings[[0, -1]], [-np.pi / 2, np.pi / 2])
    assert scan.resolution == pytest.approx(np.pi / 179)


def test_readings_run_counter_clockwise_from_the_right():
    stage = Stage()
    stage.robot(0, 0, np.pi / 2, {"type": "laser", "samples": 5})
    stage.wall(2, -1, 2, 1)  # the robot looks up: x = 2 is to its right
    stage.wall(-3, -1, -3, 1)
    stage.sense()
    np.testing.assert_allclose(stage.data().ranges[0, [0, -1]], [2, 3])


def test_the_mount_pose_is_in_the_robots_frame_and_in_degrees():
    stage = Stage()
    laser = {"type": "laser", "pose": [0.5, 0.25, 90], "samples": 3}
    stage.robot(1, 1, np.pi / 2, laser)  # so the laser is at (0.75, 1.5) and looks along -x
    stage.wall(-4, 0, -4, 3)
    stage.wall(0, 4, 2, 4)
    stage.sense()
    ranges = stage.data().ranges[0]
    assert ranges[1] == pytest.approx(4.75)
    assert ranges[0] == pytest.approx(2.5)


def test_heights_do_not_matter_to_a_laser():
    stage = Stage()
    stage.robot(0, 0, 0, {"type": "laser", "samples": 3})
    stage.box(3, 0, height=0.001)
    stage.sense()
    assert stage.data().ranges[0, 1] == pytest.approx(2.5)


def noisy(deviation=0.05, seed=1, name="r", ticks=200, **more):
    """Ranges (ticks, 3) of a laser whose rays hit at 2 m, nothing, and 0.01 m."""
    stage = Stage(seed)
    stage.robot(0, 0, 0, {"type": "laser", "samples": 3, "noise": deviation} | more, name=name)
    stage.wall(-1, -2, 1, -2)
    stage.wall(-1, 0.01, 1, 0.01)
    ranges = []
    for tick in range(ticks):
        stage.sense(tick)
        ranges.append(stage.data().ranges[0].copy())
    return np.array(ranges)


def test_noise_is_gaussian_with_the_given_deviation_on_hits_alone():
    ranges = noisy(ticks=2000)
    off = (ranges[:, 0] - 2.0) / 0.05
    # 2000 samples: the mean is within 5 / sqrt(2000), the deviation within 5 / sqrt(4000).
    assert abs(off.mean()) < 5 / np.sqrt(2000)
    assert abs(off.std() - 1) < 5 / np.sqrt(4000)
    assert abs((np.abs(off) < 1).mean() - 0.6827) < 5 * np.sqrt(0.6827 * 0.3173 / 2000)
    assert (ranges[:, 1] == 20.0).all()


def test_noisy_ranges_stay_between_0_and_the_range():
    ranges = noisy(0.5, range=2.2)
    assert ranges.min() == 0.0
    assert ranges[:, 0].max() == 2.2


def test_noise_repeats_with_the_seed_and_differs_between_seeds_robots_and_ticks():
    first = noisy(ticks=5)
    np.testing.assert_array_equal(first, noisy(ticks=5))
    assert (first[:, 0] != noisy(seed=2, ticks=5)[:, 0]).all()
    assert (first[:, 0] != noisy(name="other", ticks=5)[:, 0]).all()
    assert len(set(first[:, 0])) == 5


@pytest.mark.parametrize(
    ("mistake", "where"),
    [
        ({"samples": 1}, "samples"),
        ({"samples": 10.0}, "samples"),
        ({"samples": True}, "samples"),
        ({"samples": "180"}, "samples"),
        ({"fov": 361}, "fov"),
        ({"fov": 0}, "fov"),
        ({"range": -1}, "range"),
        ({"range": float("nan")}, "range"),
        ({"range": float("inf")}, "range"),
        ({"range": "20"}, "range"),
        ({"min_range": -0.1}, "min_range"),
        ({"min_range": "1"}, "min_range"),
        ({"noise": -0.1}, "noise"),
        ({"pose": [0, 0]}, "pose"),
        ({"sample": 5}, "sample"),
    ],
)
def test_impossible_settings_are_mistakes_at_their_key(mistake, where):
    with pytest.raises(ValidationError) as caught:
        settings_for({"type": "laser"} | mistake)
    assert caught.value.errors()[0]["loc"][0] == where


@pytest.mark.parametrize("kind", ["laser", "ranger"])
@pytest.mark.parametrize("least", [5.0, 6.0])
def test_a_least_range_that_leaves_nothing_to_measure_is_a_mistake(kind, least):
    with pytest.raises(ValidationError, match="min_range must be below range"):
        settings_for({"type": kind, "range": 5.0, "min_range": least})


def test_noise_too_can_bring_a_reading_below_the_least_range():
    """One rule: what would read less than min_range reads 0; nothing else changes."""
    plain, blind = noisy(0.5), noisy(0.5, min_range=1.9)
    np.testing.assert_array_equal(blind, np.where(plain < 1.9, 0.0, plain))
    assert 0 < (blind[:, 0] == 0.0).sum() < len(blind)
