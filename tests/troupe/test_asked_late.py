"""What is asked for late, or in another form, is what it would have been from the start."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import troupe

WORLD: dict[str, Any] = {
    "size": [8, 6],
    "duration": 3.0,
    "models": {
        "rover": {
            "body": {"shape": "box", "size": [0.6, 0.4], "color": "green"},
            "drive": {"kind": "differential", "max_speed": 0.5, "max_turn_rate": 90},
            "sensors": [
                {"type": "laser", "samples": 9, "noise": 0.01},
                {"type": "bumper", "count": 4},
            ],
        }
    },
    "robots": [
        {"model": "rover", "name": "one", "pose": [1.5, 3, 0]},
        {"model": "rover", "name": "two", "pose": [2.4, 3, 180]},
    ],
}


def drive(sim: troupe.Simulation, ticks: int) -> None:
    """The two push each other."""
    for _ in range(ticks):
        sim.command(forward=0.4, turn=[0.1, -0.2])
        sim.step()


def test_readings_asked_for_late_are_those_of_a_run_that_had_them_always() -> None:
    with troupe.Simulation(WORLD) as early, troupe.Simulation(WORLD) as late:
        early.readings("laser"), early.readings("bumper")
        drive(early, 12)
        drive(late, 12)
        assert early.readings("bumper").bits.any()
        for _ in range(2):
            for sensor, what in (("laser", "ranges"), ("bumper", "bits")):
                one, other = early.readings(sensor), late.readings(sensor)
                assert np.array_equal(getattr(one, what), getattr(other, what))
                assert one.time == other.time
            drive(early, 1)
            drive(late, 1)
        assert early.contacts.tolist() == late.contacts.tolist() == [1, 1]


def test_a_robot_that_is_put_elsewhere_is_seen_there_at_once() -> None:
    with troupe.Simulation(WORLD) as sim:
        near = sim.readings("laser").ranges[0, 4]
        sim.set_pose("two", (6.0, 3.0, 0.0))
        far = sim.readings("laser").ranges[0, 4]
        assert (near, far) == (pytest.approx(0.6, abs=0.1), pytest.approx(4.2, abs=0.1))
        drive(sim, 1)
        assert sim.readings("laser").ranges[0, 4] == pytest.approx(far, abs=0.2)


def test_many_steps_in_one_call_and_a_whole_run_have_one_digest() -> None:
    with troupe.Simulation(WORLD) as sim:
        sim.step(30)
        digest = sim.result().digest
        sim.reset()
        for _ in range(30):
            sim.step()
        assert (sim.result().digest, sim.over) == (digest, True)
    assert troupe.run(WORLD).digest == digest


@pytest.mark.parametrize("robots", [None, [0, 1], ["one", "two"], np.arange(2)])
def test_robots_may_be_told_in_any_form(robots: Any) -> None:
    with troupe.Simulation(WORLD) as sim:
        sim.set_pose("two", (6.0, 3.0, 0.0))
        sim.command(robots, forward=np.array([0.1, 0.2]), turn=0.3)
        assert sim.indices(robots).tolist() == [0, 1]
        sim.step(10)
        assert sim.velocities[:, 0] == pytest.approx([0.1, 0.2], abs=1e-6)


@pytest.mark.parametrize("robots", [np.array([0, 2]), np.array([-1, 0])])
def test_an_array_with_a_robot_that_is_not_there_is_refused(robots: Any) -> None:
    with troupe.Simulation(WORLD) as sim, pytest.raises(ValueError, match="0 to 1"):
        sim.command(robots, forward=0.1)
