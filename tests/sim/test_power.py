"""A battery runs down as its robot moves, and is charged where the robot touches a charger."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import troupe
from sim.build import load_data
from sim.worldfile import WorldError

WORLD: dict[str, Any] = {
    "size": [10, 8],
    "duration": 60,
    "until": "duration",
    "obstacles": [
        {"shape": "box", "size": [0.2, 1], "pose": [9, 4, 0], "charger": 500},
        {"shape": "circle", "radius": 0.5, "pose": [2, 7, 0], "solid": False, "charger": 80,
         "name": "pad"},
        {"shape": "box", "size": [0.4, 0.4], "pose": [2, 2, 0], "movable": True, "charger": 20},
    ],
    "models": {
        "rover": {
            "body": {"shape": "circle", "radius": 0.3},
            "drive": {"kind": "differential", "max_acceleration": 100},
            "battery": {"capacity": 1000, "charge": 400, "idle": 2, "driving": 40, "turning": 4},
        },
        "none": {"body": {"shape": "circle", "radius": 0.3}},
    },
    "robots": [
        {"name": "a", "model": "rover", "pose": [5, 4, 0], "controller": "a"},
        {"name": "b", "model": "none", "pose": [5, 6, 0], "controller": "b"},
    ],
    "controllers": {"a": {"external": True}, "b": {"external": True}},
}  # fmt: skip


def told(drive: Callable[[Any], None], seconds: float, **changes: Any) -> list[tuple[float, ...]]:
    """What a's battery tells at each reading: time, joules, percent, watts, charging."""
    found: list[tuple[float, ...]] = []

    def a(robot: Any) -> None:
        power = robot.power
        found.append((robot.time, power.joules, power.percent, power.watts, power.charging))
        drive(robot)

    troupe.run(WORLD | changes, duration=seconds, controllers={"a": a, "b": lambda robot: None})
    return found


def test_what_is_drawn_follows_how_fast_it_moves() -> None:
    def drive(robot: Any) -> None:
        robot.base.set_speed(0.0 if robot.time < 1.0 else 0.4, 0.0 if robot.time < 3.0 else 0.5)

    found = told(drive, 5.0)
    assert found[-1][2] == pytest.approx(found[-1][1] / 10)
    watts = {round(time, 1): (watts, charging) for time, _, _, watts, charging in found}
    assert watts[0.9] == pytest.approx((-2, 0))
    assert watts[2.5] == pytest.approx((-2 - 0.4 * 40, 0))
    assert watts[4.5] == pytest.approx((-2 - 0.4 * 40 - 0.5 * 4, 0), abs=0.05)
    for (_, before, *_), (_, after, _, drawn, _) in pairwise(found):
        assert after == pytest.approx(before + 0.1 * drawn, abs=1e-3)


def test_a_charger_that_is_touched_fills_it_and_no_more() -> None:
    found = told(lambda robot: robot.base.set_speed(0.5, 0.0), 20.0)
    reached = next(time for time, *_, charging in found if charging)
    assert reached == pytest.approx((9 - 0.1 - 0.3 - 5) / 0.5, abs=0.4)
    assert max(joules for _, joules, *_ in found) == 1000
    assert found[-1][3] == pytest.approx(500 - 2, abs=1)


def test_it_takes_what_it_may_and_as_long_as_it_may() -> None:
    rover = WORLD["models"]["rover"]
    battery = rover["battery"] | {"intake": 100, "charge": 0}
    models = WORLD["models"] | {"rover": rover | {"battery": battery}}
    robots = [WORLD["robots"][0] | {"pose": [8.595, 4, 0]}, WORLD["robots"][1]]

    def drive(robot: Any) -> None:
        if robot.time == pytest.approx(1.0):
            robot.power.set_charging_policy(False)

    found = told(drive, 3.0, models=models, robots=robots)
    assert found[5][3] == pytest.approx(98)
    assert found[5][4] == 1
    assert found[-1][3] == pytest.approx(-2)
    assert found[-1][4] == 0
    assert all(joules >= 0 for _, joules, *_ in found)


@pytest.mark.parametrize(("at", "watts"), [((2.3, 6.6), 80), ((2.505, 2.0), 20), ((4.0, 6.0), 0)])
def test_pads_and_things_that_can_be_pushed_charge_too(
    at: tuple[float, float], watts: float
) -> None:
    robots = [WORLD["robots"][0] | {"pose": [*at, 0]}, WORLD["robots"][1]]
    found = told(lambda robot: None, 0.5, robots=robots)
    assert found[-1][3] == pytest.approx(watts - 2)


def test_a_charger_charges_where_it_was_put() -> None:
    robots = [WORLD["robots"][0] | {"controller": None}, WORLD["robots"][1]]
    with troupe.Simulation(WORLD | {"robots": robots}, controllers=False) as sim:
        context = sim._engine.context
        sim.step()
        (charger,) = [one for one in context.chargers if one.body.name == "pad"]
        sim.set_pose("pad", (5.0, 4.5, math.pi))
        assert charger.where(sim._engine.scenery.stage) == pytest.approx((5.0, 4.5, math.pi))


def test_a_robot_without_a_battery_has_none_and_a_charge_fits_into_it(tmp_path: Path) -> None:
    devices: list[str] = []

    def b(robot: Any) -> None:
        devices.extend(str(addr) for addr in robot.client.devices())
        robot.finish()

    troupe.run(WORLD, duration=1.0, controllers={"a": lambda robot: None, "b": b})
    assert devices
    assert not any("power" in device for device in devices)
    models = {"m": {"body": WORLD["models"]["none"]["body"],
                    "battery": {"capacity": 5, "charge": 6}}}  # fmt: skip
    with pytest.raises(WorldError, match="holds no more"):
        load_data({"size": [4, 4], "models": models, "robots": []})
