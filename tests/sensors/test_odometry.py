"""Odometry: exact in the robot's own start frame, or drifting with the way."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sensors.odometry import Odometry


def drive(odometry, start, moves, first_tick=0):
    """Move one robot by (ahead, left, turn) per tick and return its true and reported poses."""
    x, y, heading = start
    for tick, (ahead, left, turn) in enumerate(moves, start=first_tick):
        x += np.cos(heading) * ahead - np.sin(heading) * left
        y += np.sin(heading) * ahead + np.cos(heading) * left
        heading += turn
        reported = odometry.update([[x, y, heading]], 0.1, tick)
    return np.array([x, y, heading]), reported[0].copy()


def test_a_robot_starts_at_the_origin_of_its_own_frame():
    odometry = Odometry(1)
    odometry.add_robot("a", (3, 4, 1.0))
    assert odometry.poses.tolist() == [[0, 0, 0]]
    _, reported = drive(odometry, (3, 4, 1.0), [(2.0, 0, 0)])
    np.testing.assert_allclose(reported, [2, 0, 0], atol=1e-12)
    _, reported = drive(odometry, (3, 4, 1.0), [(2.0, 0, 0.5), (0, 1.0, 0)])
    np.testing.assert_allclose(reported, [2 - np.sin(0.5), np.cos(0.5), 0.5], atol=1e-12)


def test_a_gps_reports_the_world_pose_with_its_yaw_within_a_turn():
    odometry = Odometry(1)
    odometry.add_robot("a", (3, 4, 7.0), gps=True)
    np.testing.assert_allclose(odometry.poses, [[3, 4, 7.0 - 2 * np.pi]])
    reported = odometry.update([[5, 6, -4.0]], 0.1, 0)
    np.testing.assert_allclose(reported, [[5, 6, 2 * np.pi - 4.0]])
    odometry.set_odometry(0, (0, 0, 0))
    odometry.reset(0)
    np.testing.assert_allclose(odometry.update([[5, 6, 1.0]], 0.1, 1), [[5, 6, 1.0]])


@pytest.mark.parametrize("slip", [0.0, 1e-12])  # integrated, too: this slip is no slip
def test_odometry_can_be_set_and_reset(slip):
    odometry = Odometry(1)
    odometry.add_robot("a", (3, 4, 1.0), slip=slip)
    here, _ = drive(odometry, (3, 4, 1.0), [(1, 0, 0.3)] * 4)
    odometry.set_odometry(0, (10, 20, np.pi / 2))
    np.testing.assert_allclose(odometry.poses[0], [10, 20, np.pi / 2])
    here, reported = drive(odometry, here, [(2, 0, 0.1)])
    np.testing.assert_allclose(reported, [10, 22, np.pi / 2 + 0.1], atol=1e-9)
    odometry.reset(0)
    assert odometry.poses[0].tolist() == [0, 0, 0]
    _, reported = drive(odometry, here, [(0, 0.5, 0)])
    np.testing.assert_allclose(reported, [0, 0.5, 0], atol=1e-9)


@pytest.mark.parametrize("start", [0.0, 0.5, 1.0, -2.3, np.pi])
@pytest.mark.parametrize("slip", [0.0, 0.1])
def test_half_a_turn_is_plus_half_a_turn(slip, start):
    for told in (np.pi, -np.pi, 3 * np.pi):
        odometry = Odometry(1)
        odometry.add_robot("a", (3, 4, start), slip=slip)
        odometry.set_odometry(0, (1, 2, told))
        assert odometry.poses[0, 2] == np.pi
        _, reported = drive(odometry, (3, 4, start), [(0, 0, 0)])
        assert reported[2] == pytest.approx(np.pi, abs=1e-12)
    odometry.set_odometry(0, (1, 2, 1e-9 - np.pi))  # and what is beyond is not
    assert odometry.poses[0, 2] == pytest.approx(1e-9 - np.pi, abs=1e-14)


@pytest.mark.parametrize("slip", [0.0, 1e-12])
def test_being_carried_about_turns_no_wheel(slip):
    odometry = Odometry(1)
    odometry.add_robot("a", (0, 0, 0), slip=slip)
    drive(odometry, (0, 0, 0), [(1, 0, 0)])
    odometry.relocate(0, (50, 60, 2.0))
    np.testing.assert_allclose(odometry.update([[50, 60, 2.0]], 0.1, 1), [[1, 0, 0]], atol=1e-9)
    _, reported = drive(odometry, (50, 60, 2.0), [(1, 0, 0)], first_tick=2)
    np.testing.assert_allclose(reported, [2, 0, 0], atol=1e-9)


def errors(slip, turn, moves, robots=400, start=0.0):
    """Reported minus exact poses (robots, 3) after the same moves of many robots.

    Headings are told as a stage tells them: in (-pi, pi]. The yaw's error is within half a turn.
    """
    noisy, exact = Odometry(7), Odometry(7)
    for k in range(robots):
        noisy.add_robot(f"r{k}", (0, 0, start), slip=slip, turn=turn)
        exact.add_robot(f"r{k}", (0, 0, start))
    x, y, heading = 0.0, 0.0, start
    for tick, (ahead, rotation) in enumerate(moves):
        x, y = x + np.cos(heading) * ahead, y + np.sin(heading) * ahead
        heading += rotation
        true = np.tile([x, y, np.pi - (np.pi - heading) % (2 * np.pi)], (robots, 1))
        noisy.update(true, 0.1, tick)
        exact.update(true, 0.1, tick)
    off = noisy.poses - exact.poses
    off[:, 2] = (off[:, 2] + np.pi) % (2 * np.pi) - np.pi
    return off


@pytest.mark.parametrize("steps", [10, 250])
@pytest.mark.parametrize("metres", [1.0, 4.0])
def test_the_distance_error_grows_with_the_root_of_the_way_however_often_one_looks(steps, metres):
    off = errors(0.02, 0.0, [(metres / steps, 0.0)] * steps)
    # 400 robots: a deviation is known to 1 / sqrt(800), a mean to 1 / 20 of it; five of each.
    expected = 0.02 * np.sqrt(metres)
    assert off[:, 0].std() == pytest.approx(expected, rel=5 / np.sqrt(800))
    assert abs(off[:, 0].mean()) < 5 * expected / 20
    np.testing.assert_array_equal(off[:, 1:], 0)


@pytest.mark.parametrize("turned", [2.0, -2.0, 2 * np.pi, -2 * np.pi])
@pytest.mark.parametrize("start", np.radians([0, 90, 135, 177, 180, -90, -170]))
def test_the_heading_error_grows_with_the_root_of_the_angle_turned(start, turned):
    off = errors(0.0, 0.05, [(0.0, turned / 100)] * 100, start=start)
    # 400 robots: a deviation is known to 1 / sqrt(800), a mean to 1 / 20 of it; five of each.
    expected = 0.05 * np.sqrt(abs(turned))
    assert off[:, 2].std() == pytest.approx(expected, rel=5 / np.sqrt(800))
    assert abs(off[:, 2].mean()) < 5 * expected / 20
    np.testing.assert_array_equal(off[:, :2], 0)


def test_odometry_drifts_the_same_wherever_the_world_has_its_zero_of_headings():
    """The increments alone count, so robots that start at any heading report one and the same."""
    moves = [(0.05, 0.07)] * 100
    reported = []
    for start in (0.0, np.pi / 2, np.pi, -np.radians(178)):
        odometry = Odometry(3)
        odometry.add_robot("a", (0, 0, start), slip=0.02, turn=0.05)
        x, y, heading = 0.0, 0.0, start
        for tick, (ahead, rotation) in enumerate(moves):
            x, y = x + np.cos(heading) * ahead, y + np.sin(heading) * ahead
            heading += rotation
            odometry.update([[x, y, np.pi - (np.pi - heading) % (2 * np.pi)]], 0.1, tick)
        reported.append(odometry.poses[0].copy())
    # 100 increments, each rounded at 1e-15 and its noise with it, turned by a yaw as exact.
    np.testing.assert_allclose(reported, [reported[0]] * 4, atol=1e-10)


def test_a_robot_that_stands_does_not_drift():
    odometry = Odometry(1)
    odometry.add_robot("a", (0, 0, 0), slip=0.5, turn=0.5)
    here, before = drive(odometry, (0, 0, 0), [(1, 0, 1)] * 5)
    _, after = drive(odometry, here, [(0, 0, 0)] * 100, first_tick=5)
    np.testing.assert_array_equal(before, after)


def test_noise_is_integrated_so_that_the_pose_never_jumps():
    odometry = Odometry(1)
    odometry.add_robot("a", (0, 0, 0), slip=0.1)
    before = np.zeros(3)
    here = (0.0, 0.0, 0.0)
    for tick in range(500):
        here, now = drive(odometry, here, [(0.01, 0, 0)], first_tick=tick)
        # An increment of 1 cm is off by 0.1 * sqrt(0.01) = 1 cm; six deviations never come.
        assert np.hypot(*(now - before)[:2]) < 0.01 + 6 * 0.01
        before = now


def test_drift_repeats_and_is_each_robots_own():
    def run(seed, names):
        odometry = Odometry(seed)
        for name in names:
            odometry.add_robot(name, (0, 0, 0), slip=0.1, turn=0.1)
        for tick in range(20):
            odometry.update(np.tile([0.1 * tick, 0, 0.1 * tick], (len(names), 1)), 0.1, tick)
        return odometry.poses

    alone, both = run(1, ["a"]), run(1, ["b", "a"])
    np.testing.assert_array_equal(alone[0], both[1])  # another robot changes nothing
    assert (both[0] != both[1]).any()
    assert (run(2, ["a"]) != alone).any()


@settings(max_examples=60)
@given(
    st.tuples(*[st.floats(-50, 50)] * 3),
    st.lists(st.tuples(*[st.floats(-2, 2)] * 3), min_size=1, max_size=20),
)
def test_exact_odometry_is_the_true_pose_seen_from_the_start(start, moves):
    odometry = Odometry(0)
    odometry.add_robot("a", start)
    true, reported = drive(odometry, start, moves)
    seen = complex(*(true - start)[:2]) * np.exp(-1j * start[2])
    # Poses up to about 100 m and 100 rad are rounded to 1.4e-14; a dozen such roundings.
    assert complex(reported[0], reported[1]) == pytest.approx(seen, abs=1e-11)
    turned = np.exp(1j * (true[2] - start[2]))
    assert np.exp(1j * reported[2]) == pytest.approx(turned, abs=1e-11)
    assert -np.pi <= reported[2] <= np.pi


def test_mistakes_are_refused_with_a_reason():
    odometry = Odometry(1)
    with pytest.raises(ValueError, match="must not be negative"):
        odometry.add_robot("a", (0, 0, 0), slip=-1)
    odometry.add_robot("a", (0, 0, 0))
    with pytest.raises(ValueError, match="odometry of 1 robots"):
        odometry.update(np.zeros((2, 3)), 0.1, 0)


def test_a_bias_is_one_factor_of_all_ways_drawn_once_a_run_within_half_of_it():
    def error(seed, bias, twist):
        odometry = Odometry(seed)
        odometry.add_robot("a", (0, 0, 0), bias=bias)
        poses = np.array([twist]) * np.linspace(0, 1, 11)[1:, None]
        for tick, pose in enumerate(poses):
            odometry.update([pose], 0.1, tick)
        return odometry.poses[0] / np.where(np.array(twist) == 0, 1, twist) - (np.array(twist) != 0)

    ahead = np.array([error(seed, (0.1, 0, 0), (2, 0, 0))[0] for seed in range(40)])
    assert (abs(ahead) <= 0.05 + 1e-12).all()
    assert ahead.min() < -0.03
    assert ahead.max() > 0.03
    assert error(3, (0.1, 0, 0), (2, 0, 0))[0] == pytest.approx(ahead[3])
    turns = np.array([error(seed, (0, 0, 0.2), (0, 0, 1.5))[2] for seed in range(40)])
    assert (abs(turns) <= 0.1 + 1e-12).all()
    assert np.ptp(turns) > 0.1
    assert error(3, (0, 0, 0), (2, 0, 0)) == pytest.approx([0, 0, 0])


def test_odometry_may_count_from_a_pose_of_the_world():
    odometry = Odometry(1)
    odometry.add_robot("a", (2, 1, np.pi / 2), frame=(1, 0, np.pi / 2))
    np.testing.assert_allclose(odometry.poses[0], [1, -1, 0], atol=1e-12)
    odometry.update([(2, 3, np.pi / 2)], 0.1, 1)
    np.testing.assert_allclose(odometry.poses[0], [3, -1, 0], atol=1e-12)
