"""Stage's energy becomes batteries and chargers."""

from __future__ import annotations

import pytest

FLOOR = "model ( size [20 10 1] boundary 1 )\n"


def test_a_robot_draws_and_takes_what_it_does_in_stage(world) -> None:
    got = world(
        FLOOR + "position ( kjoules 500 mass 3 blobfinder ( )\n"
        "ranger ( watts 30 sensor ( samples 9 ) sensor ( ) )\n"
        "model ( size [0.1 0.1 0.1] pose [0.2 0 -0.1 0] take_watts 2000 watts 5 ) )\n"
    )
    assert got.model("position_0")["battery"] == pytest.approx(
        {"capacity": 500_000, "idle": 1 + 0.4 + 2 + 5, "driving": 30, "turning": 30, "intake": 2000}
    )
    assert not [note for note in got.notes if note.kind == "lost"]


@pytest.mark.parametrize(
    ("text", "battery"),
    [
        ("joules 100 joules_capacity 400", {"capacity": 400, "charge": 100}),
        ("kjoules_capacity 4", {"capacity": 4000, "charge": 0}),
        ("joules 100", {"capacity": 100}),
        ("joules 500 joules_capacity 400", {"capacity": 400, "charge": 400}),
    ],
)
def test_a_battery_holds_what_stages_does(world, text: str, battery: dict[str, float]) -> None:
    got = world(FLOOR + f"position ( {text} )\n")
    assert got.model("position_0")["battery"] == battery | {"idle": 1, "intake": 0}


@pytest.mark.parametrize("text", ["joules -1", "joules 0", ""])
def test_a_battery_that_never_runs_down_or_is_none_is_none_here(world, text: str) -> None:
    got = world(FLOOR + f"position ( {text} )\n")
    assert "battery" not in got.model("position_0")
    assert bool(got.noted("differs", "text.world:2")) == text.endswith("-1")


@pytest.mark.parametrize("movable", [0, 1])
def test_a_model_that_gives_energy_is_a_charger(world, movable: int) -> None:
    got = world(
        FLOOR + "position ( joules 100 )\n"
        f"model ( pose [3 0 0 0] size [0.1 0.3 0.1] gripper_return {movable}\n"
        "model ( size [0.05 0.2 0.1] joules -1 give_watts 2000 ) )\n"
    )
    assert [one["charger"] for one in got.data["obstacles"] if "charger" in one] == [2000]
    assert not [note for note in got.notes if note.kind == "lost"]


def test_power_is_served_where_the_table_has_it_and_the_robot_a_battery(world) -> None:
    cfg = 'driver ( name "stage" model "r" provides ["6665:position2d:0" "6665:power:0"] )\n'
    got = world(FLOOR + 'position ( name "r" joules 100 )\n', cfg)
    assert not got.noted("lost", "text.cfg:1")
    assert not got.noted("differs", "text.cfg:1")
    got = world(FLOOR + 'position ( name "r" )\n', cfg)
    assert got.noted("differs", "text.cfg:1") == ["6665:power:0 of r: not served here"]
