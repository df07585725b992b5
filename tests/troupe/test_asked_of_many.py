"""What is made of a robot only when somebody asks for it, and that nobody notices."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from troupe import Simulation

LASER: dict[str, Any] = {"type": "laser", "range": 5, "samples": 7}
SONAR: dict[str, Any] = {"type": "ranger", "elements": [[0.1, 0, 0]], "range": 5}


def world(**models: Any) -> dict[str, Any]:
    """Two robots of each model, one after the other of the other models."""
    names = [*models, *models]
    return {
        "size": [30, 10],
        "duration": 10,
        "models": {
            name: {"body": {"shape": "circle", "radius": 0.3}, **model}
            for name, model in models.items()
        },
        "robots": [
            {"model": name, "name": f"{name}{number}", "pose": [2 + 3 * number, 5, 0]}
            for number, name in enumerate(names)
        ],
        "controllers": {"mine": {"external": True}},
    }


def have_devices(simulation: Simulation) -> list[str]:
    return [robot.name for robot in simulation._engine.robots if "port" in vars(robot)]


def test_robots_that_nobody_comes_to_have_no_devices() -> None:
    with Simulation(world(rover={"sensors": [LASER]}), controllers=False) as simulation:
        simulation.command(forward=0.3)
        simulation.step(3)
        assert simulation.readings("laser").ranges.min() < 5
        assert not have_devices(simulation)
        (robot, _) = simulation._engine.robots
        assert [str(addr) for addr in robot.port.devices][:2] == ["position2d:0", "laser:0"]
        assert have_devices(simulation) == [robot.name]


def test_a_gripper_shows_that_nobody_has_asked_for() -> None:
    data = world(rover={}, fetcher={"actuators": [{"type": "gripper"}]})
    with Simulation(data, controllers=False) as simulation:
        drawings = [len(robot.drawings) for robot in simulation._engine.robots]
        assert drawings == [0, 2, 0, 2]


@pytest.mark.parametrize("layout", ["per_robot", "shared"])
def test_robots_that_clients_can_come_to_have_theirs_from_their_entry_on(layout: str) -> None:
    data = world(rover={"sensors": [LASER]})
    data["player"] = {"layout": layout}
    with Simulation(data, controllers=False, listen=("127.0.0.1", 0)) as simulation:
        assert have_devices(simulation) == simulation.names
        firsts = [robot.port.first for robot in simulation._engine.robots]
        assert firsts == ([0, 0] if layout == "per_robot" else [0, 1])


def test_a_sensor_is_found_by_its_place_among_its_kind_whatever_other_robots_have() -> None:
    farther, noisy = {**LASER, "range": 6}, {**LASER, "noise": 0.1}
    data = world(
        one={"sensors": [SONAR, LASER]},
        two={"sensors": [farther, SONAR, LASER]},
        none={},
        three={"sensors": [noisy, noisy, farther]},
    )
    with Simulation(data, controllers=False) as simulation:
        suite = simulation._engine.scenery.suite

        def expected(number: int) -> dict[int, Any]:
            """Of every robot that has it, by the robot's own sensors one after the other."""
            found = {}
            for robot, model in enumerate(("one", "two", "none", "three") * 2):
                lasers = [
                    index
                    for index, sensor in enumerate(data["models"][model].get("sensors", []))
                    if sensor["type"] == "laser"
                ]
                if number < len(lasers):
                    reading: Any = suite.reading(robot, lasers[number]).data
                    found[robot] = reading.ranges[0].tolist()
            return found

        for number in range(3):
            readings = simulation.readings(f"laser:{number}")
            rows = readings.ranges.tolist()
            assert dict(zip(readings.robots.tolist(), rows, strict=True)) == expected(number)
        with pytest.raises(ValueError, match=r"there are: ranger:0, laser:0, laser:1, laser:2$"):
            simulation.readings("laser:3")
        with pytest.raises(ValueError, match="there are: ranger:0"):
            simulation.readings("bumper")


def test_blobs_have_room_for_as_many_as_an_image_has_columns() -> None:
    camera = {"type": "blobfinder", "range": 20, "image": [40, 30]}
    data = world(rover={"sensors": [camera]})
    with Simulation(data, controllers=False) as simulation:
        seen = simulation.readings("blobfinder")
        assert seen.blobs.shape == (2, 40)
        assert seen.blobs.flags.c_contiguous
        suite = simulation._engine.scenery.suite
        for robot in range(2):
            one: Any = suite.reading(robot, 0).data
            count = seen.counts[robot]
            assert count == one.counts[0] > 0
            assert np.array_equal(one.blobs[0, :count], seen.blobs[robot, :count])
