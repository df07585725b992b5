"""What cannot be given from Python is refused by its name, before anything has begun."""

from __future__ import annotations

import math

import numpy as np
import pytest

import troupe

WORLD = {
    "size": [8, 6],
    "models": {
        "rover": {"body": {"shape": "circle", "radius": 0.3}, "sensors": [{"type": "laser"}]}
    },
    "robots": [{"name": "a", "model": "rover", "pose": [2, 2, 0]}],
}
NO_NUMBER = [math.nan, math.inf, -1.0, "5", True]


@pytest.mark.parametrize("begin", [troupe.run, troupe.Simulation])
@pytest.mark.parametrize(
    ("name", "given"),
    [
        *[("duration", one) for one in [*NO_NUMBER, 0]],
        *[("realtime", one) for one in [*NO_NUMBER, 0]],
        *[("patience", one) for one in NO_NUMBER],
        *[("seed", one) for one in (-1, 1.5, "1", True, math.nan, 1 << 63)],
        *[("listen", one) for one in ("nowhere", ("127.0.0.1", "x"), ("127.0.0.1",), 6665, (1, 2))],
        *[("controllers", one) for one in (3, "wander", ["wander"])],
    ],
)
def test_what_cannot_be_is_refused_by_its_name(begin: object, name: str, given: object) -> None:
    with pytest.raises(ValueError, match=f"^{name}"):
        begin(WORLD, **{name: given})  # type: ignore[operator]


@pytest.mark.parametrize("begin", [troupe.run, troupe.Simulation])
def test_numbers_of_numpy_are_numbers(begin: object) -> None:
    made = begin(WORLD, seed=np.int64(3), duration=np.float32(0.5), patience=np.int8(5))  # type: ignore[operator]
    assert type(made.seed) is int
    assert made.seed == 3


def test_a_simulation_listens_at_an_address_that_is_text_and_waits_for_ever_for_none() -> None:
    with troupe.Simulation(WORLD, listen="127.0.0.1:0", patience=0) as sim:
        assert sim._engine.settings.listen == ("127.0.0.1", 0)
        assert sim._engine.settings.patience == math.inf


def test_a_picture_has_the_sizes_that_a_video_has() -> None:
    with troupe.Simulation(WORLD) as sim:
        assert sim.picture("96x64").shape == (64, 96, 3)
        for size in ("small", (64,), (64, 64, 3), 64, ("a", "b"), (0, 5), (math.nan, 64)):
            with pytest.raises(ValueError, match="video size"):
                sim.picture(size)  # type: ignore[arg-type]


def test_what_is_no_name_of_a_sensor_is_refused() -> None:
    with troupe.Simulation(WORLD) as sim:
        for sensor in (5, None, "laser:x"):
            with pytest.raises(ValueError, match="is no sensor"):
                sim.readings(sensor)  # type: ignore[arg-type]


def test_a_closed_simulation_takes_no_commands_but_still_answers() -> None:
    sim = troupe.Simulation(WORLD)
    sim.step()
    sim.close()
    for act in (
        lambda: sim.command(forward=0.1),
        lambda: sim.set_pose("a", (3, 3, 0)),
        lambda: sim.say("a", "hello"),
        sim.step,
    ):
        with pytest.raises(RuntimeError, match=r"closed; reset\(\) starts it anew"):
            act()
    assert sim.poses.shape == (1, 3)
    assert len(sim.readings("laser")) == 1
