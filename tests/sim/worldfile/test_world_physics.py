"""Worlds that the physics could not keep whole are refused, with the number that works."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.build import load
from sim.worldfile import WorldError

WORLD = """\
size: [40, 10]
clock: {{interval: {interval}, physics_step: {step}}}
models:
  strong:
    body: {{shape: box, size: [1, 1], mass: {heavy}}}
    drive: {{max_speed: {speed}, max_force: {force}}}
  light: {{body: {{shape: circle, radius: 0.1, mass: {light}}}}}
  unused: {{body: {{shape: circle, radius: 0.1, mass: 1e-9}}}}
obstacles:
  - {{shape: circle, radius: 0.2, pose: [20, 5, 0], movable: true, mass: {ball}}}
robots:
  - {{model: strong, pose: [2, 2, 0]}}
  - {{model: light, pose: [5, 5, 0]}}
"""
GIVEN = {"interval": 1, "step": 0.02, "heavy": 10, "light": 10, "ball": 10, "speed": 1, "force": 9}


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"heavy": 10_000, "force": 1e6},  # 1000 to 1, and 100 m/s2
        {"light": 0.01, "force": 1000},
        {"ball": 0.01, "force": 1000},
        {"speed": 10, "step": 1},
    ],
)
def test_masses_forces_and_clocks_that_hold_are_no_mistakes(
    tmp_path: Path, given: dict[str, float]
) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(WORLD.format(**{**GIVEN, **given}))
    load(path)


@pytest.mark.parametrize(
    ("given", "where", "allowed"),
    [
        (
            {"heavy": 1e6, "light": 1e-3, "ball": 1e-3},
            "models.strong.body.mass",
            "1000 times the 0.001 kg",
        ),
        ({"ball": 20_000}, "obstacles.0.mass", "1000 times the 10 kg of models.strong"),
        ({"force": 1.1e6}, "models.strong.drive.max_force", "at most 1e+06"),
        ({"ball": 0.1, "force": 2e4}, "models.strong.drive.max_force", "0.1 kg of obstacles.0"),
        ({"speed": 50, "step": 1}, "clock.physics_step", "such as physics_step: 0.5"),
    ],
)
def test_what_the_physics_could_not_keep_apart_is_refused_with_what_works(
    tmp_path: Path, given: dict[str, float], where: str, allowed: str
) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(WORLD.format(**{**GIVEN, **given}))
    with pytest.raises(WorldError) as raised:
        load(path)
    assert [".".join(map(str, one.where)) for one in raised.value.mistakes] == [where]
    assert allowed in str(raised.value.mistakes[0].allowed)
    assert raised.value.mistakes[0].line is not None


SMALL = """\
size: [40, 10]
clock: {{{clock}}}
models: {{mote: {{body: {{shape: circle, radius: {radius}}}, drive: {{max_speed: {speed}}}}}}}
robots: [{{model: mote, pose: [2, 2, 0]}}]
"""


@pytest.mark.parametrize(
    ("radius", "speed", "clock"),
    [
        (0.1, 50, "interval: 1, physics_step: 1"),
        (0.1, 90, "interval: 1, physics_step: 1"),  # a third: no few decimals divide the interval
        (1e-5, 100, "interval: 0.7"),
        (1e-6, 1, "interval: 0.1"),
        (1e-9, 0.5, "interval: 0.1"),  # more steps than an interval may have
        (1e-9, 0.5, "interval: 60, physics_step: 1"),
    ],
)
def test_the_clock_that_is_proposed_is_taken(
    tmp_path: Path, radius: float, speed: float, clock: str
) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(SMALL.format(radius=radius, speed=speed, clock=clock))
    with pytest.raises(WorldError) as raised:
        load(path)
    [mistake] = raised.value.mistakes
    assert mistake.where == ("clock", "physics_step")
    proposed = str(mistake.allowed).rpartition("such as ")[2]
    if "interval" not in proposed:
        proposed += ", " + clock.partition(",")[0]
    path.write_text(SMALL.format(radius=radius, speed=speed, clock=proposed))
    load(path)


def test_the_period_that_is_proposed_is_taken(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    text = (
        "size: [40, 10]\nclock: {interval: 0.333333}\n"
        "models: {rover: {body: {shape: circle, radius: 0.3}}}\n"
        "doors: [{name: s, at: [1, 1], model: rover, period: PERIOD}]\n"
    )
    path.write_text(text.replace("PERIOD", "4.1"))
    with pytest.raises(WorldError) as raised:
        load(path)
    [mistake] = raised.value.mistakes
    assert mistake.where == ("doors", 0, "period")
    path.write_text(text.replace("PERIOD", str(mistake.allowed).rpartition("such as ")[2]))
    load(path)
