"""Noise without a state: every random number is a hash of what it is for.

A sensor's stream has a key, hashed from the run's seed, the robot's name and the sensor's index.
The number for (key, tick, channel) depends on nothing else: leaving out a sensor that nobody reads,
or adding a robot, changes no other number. The mixing function is splitmix64's (Steele, Lea and
Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014, figure 17), the Gaussian
Box and Muller's.
"""

import hashlib
import math

import numpy as np
import numpy.typing as npt

from sensors.compiled import compiled
from sensors.grid import Floats, Ints
from sensors.picture import Hits

Keys = npt.NDArray[np.uint64]


def stream_key(seed: int, *names: str | int) -> np.uint64:
    """The key of a stream: a hash of the run's seed and of what the stream is for.

    >>> int(stream_key(1, "r1", 0)) == int(stream_key(1, "r1", 0))
    True
    """
    text = repr((int(seed), *names)).encode()
    return np.uint64(int.from_bytes(hashlib.blake2b(text, digest_size=8).digest(), "little"))


@compiled
def mix(z: np.uint64) -> np.uint64:
    """splitmix64's mixing of 64 bits."""
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


@compiled
def uniform_at(key: np.uint64, tick: int, channel: int) -> float:
    """A number in (0, 1), the same for the same arguments for ever."""
    gamma = np.uint64(0x9E3779B97F4A7C15)
    z = mix(key + gamma * np.uint64(tick + 1))
    z = mix(z + gamma * np.uint64(channel + 1))
    return ((z >> np.uint64(11)) + 0.5) * (1.0 / 9007199254740992.0)


@compiled
def gaussian_at(key: np.uint64, tick: int, channel: int) -> float:
    """A standard Gaussian number, the same for the same arguments for ever."""
    u = uniform_at(key, tick, 2 * channel)
    v = uniform_at(key, tick, 2 * channel + 1)
    return math.sqrt(-2.0 * math.log(u)) * math.cos(2.0 * math.pi * v)


@compiled
def add_range_noise(
    ranges: Floats,
    hits: Hits,
    rows: Ints,
    keys: Keys,
    tick: int,
    deviation: float,
    max_range: float,
) -> None:
    """Add Gaussian noise (metres) to the ranges that hit something, kept within [0, max_range]."""
    for j in rows:
        for i in range(ranges.shape[1]):
            if hits[j, i] >= 0:
                noisy = ranges[j, i] + deviation * gaussian_at(keys[j], tick, i)
                ranges[j, i] = min(max(noisy, 0.0), max_range)


@compiled
def add_element_noise(
    ranges: Floats, rows: Ints, keys: Keys, tick: int, deviation: float, far: Floats
) -> None:
    """The same for ranges without hits: what is nearer than its range `far` did hit something.

    So it does not become that range either, which would say that nothing is there.
    """
    for j in rows:
        for i in range(ranges.shape[1]):
            if ranges[j, i] < far[i]:
                noisy = ranges[j, i] + deviation * gaussian_at(keys[j], tick, i)
                ranges[j, i] = min(max(noisy, 0.0), np.nextafter(far[i], 0.0))


def random_color(seed: int, name: str) -> int:
    """A colour 0xRRGGBB for a thing of a name: the same whenever the seed is."""
    return int(stream_key(seed, name, "color")) & 0xFFFFFF


def gaussians(keys: Keys, tick: int, channels: int = 1) -> Floats:
    """Standard Gaussian numbers (n, channels) for n streams at a tick: for sensors of your own."""
    out = np.empty((len(keys), channels))
    _fill(np.ascontiguousarray(keys, np.uint64), tick, out)
    return out


@compiled
def _fill(keys: Keys, tick: int, out: Floats) -> None:
    for j in range(out.shape[0]):
        for i in range(out.shape[1]):
            out[j, i] = gaussian_at(keys[j], tick, i)
