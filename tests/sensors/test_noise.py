"""Noise is a function of what it is for, and looks like chance."""

import numpy as np

from sensors.noise import gaussians, mix, stream_key, uniform_at

MASK = (1 << 64) - 1


def reference_mix(z):
    """splitmix64's mixing in Python's integers."""
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return z ^ (z >> 31)


def test_the_mixing_is_splitmix64s():
    # The generator's first outputs for the seed 1234567, as published with its reference code.
    gamma, state, outputs = 0x9E3779B97F4A7C15, 1234567, []
    for _ in range(3):
        state = (state + gamma) & MASK
        outputs.append(reference_mix(state))
    assert outputs == [6457827717110365317, 3203168211198807973, 9817491932198370423]
    for z in (0, 1, 1234567, MASK, 1 << 63):
        assert int(mix(np.uint64(z))) == reference_mix(z)


def test_gaussians_have_mean_0_deviation_1_and_no_memory():
    keys = np.array([stream_key(1, f"r{k}", 0) for k in range(50)], np.uint64)
    draws = np.stack([gaussians(keys, tick, 40) for tick in range(50)])  # tick, key, channel
    n = draws.size  # 100 000: five standard errors each
    assert abs(draws.mean()) < 5 / np.sqrt(n)
    assert abs(draws.std() - 1) < 5 / np.sqrt(2 * n)
    assert abs((np.abs(draws) > 2).mean() - 0.0455) < 5 * np.sqrt(0.0455 / n)
    for neighbour in (draws[1:] * draws[:-1], draws[:, 1:] * draws[:, :-1]):
        assert abs(neighbour.mean()) < 5 / np.sqrt(neighbour.size)
    neighbour = draws[..., 1:] * draws[..., :-1]
    assert abs(neighbour.mean()) < 5 / np.sqrt(neighbour.size)


def test_uniforms_fill_the_open_unit_interval_evenly():
    key = stream_key(3, "a")
    draws = np.array([uniform_at(key, tick, c) for tick in range(100) for c in range(100)])
    assert draws.min() > 0
    assert draws.max() < 1
    counts = np.histogram(draws, 20, (0, 1))[0]
    # Each bin is binomial with mean 500 and deviation 22; five of those.
    assert np.abs(counts - 500).max() < 110


def test_streams_differ_by_seed_robot_and_sensor():
    keys = {
        int(stream_key(seed, robot, index))
        for seed in (0, 1, -1, 2**70)
        for robot in ("a", "b", "a1", "")
        for index in range(5)
    }
    assert len(keys) == 4 * 4 * 5


def test_a_draw_does_not_depend_on_what_else_is_drawn():
    keys = np.array([stream_key(1, name) for name in "abc"], np.uint64)
    many = gaussians(keys, 17, 9)
    np.testing.assert_array_equal(gaussians(keys[1:2], 17, 4), many[1:2, :4])
