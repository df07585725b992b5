"""A large batch is shared out to threads, and every reading is what one thread would make of it."""

import math

import numpy as np
import pytest

from sensors import together as module
from sensors.registry import settings_for
from sensors.scene import Scene
from sensors.suite import Suite
from sensors.together import ENOUGH_FOR_THREADS

SENSORS = [
    {"type": "laser", "samples": 60, "noise": 0.01},
    {"type": "blobfinder", "image": [40, 30]},
]


def crowd() -> Suite:
    """More robots than one thread is given, at random."""
    scene = Scene()
    walls = scene.add_entity(color=0xFF0000)
    side = 80.0
    scene.add_segments(
        walls, [[0, 0, side, 0], [side, 0, side, side], [side, side, 0, side], [0, side, 0, 0]]
    )
    suite = Suite(scene, seed=3)
    random = np.random.default_rng(4)
    for k in range(2 * ENOUGH_FOR_THREADS):
        x, y = random.uniform(1.0, side - 1.0, 2)
        entity = scene.add_entity(color=0x00FF00, pose=(x, y, random.uniform(-math.pi, math.pi)))
        scene.add_circle(entity, 0.4)
        suite.add_robot(entity, f"r{k}", [settings_for(spec) for spec in SENSORS])
    scene.refresh()
    return suite


@pytest.mark.parametrize("cores", [2, 3, 7])
def test_the_number_of_threads_changes_no_reading(
    cores: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415

    readings = []
    with ThreadPoolExecutor(cores - 1) as pool:
        for crew in ((1, None), (cores, pool)):
            monkeypatch.setattr(module, "threads", lambda crew=crew: crew)
            suite = crowd()
            suite.sense(5, 0.5)
            laser, camera = suite.groups
            readings.append((laser.readings, camera.readings))
    (one, blobs), (many, more) = readings
    assert one.ranges.tobytes() == many.ranges.tobytes()
    assert one.hits.tobytes() == many.hits.tobytes()
    assert blobs.counts.tobytes() == more.counts.tobytes()
    assert blobs.counts.min() > 0
    for k in range(2 * ENOUGH_FOR_THREADS):
        assert blobs.seen(k).tobytes() == more.seen(k).tobytes()
