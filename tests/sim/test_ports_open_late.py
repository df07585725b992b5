"""Ports open when the world can answer: all has entered, and all that it computes is compiled."""

from __future__ import annotations

from pathlib import Path

import pytest

import troupe
from sim.build import load
from sim.engine import Engine, Settings
from sim.fleet.idle import NoFleet
from sim.rehearsal import is_served, rehearse
from tests.sim.serving import World, write_world


def test_all_robots_have_entered_and_perceived_before_a_port_is_open(world: World) -> None:
    seen: list[tuple[int, int]] = []

    def say(line: str) -> None:
        if "is served at" in line:
            seen.append((len(engine.robots), engine.sensing.encodings.round))

    settings = Settings(1, 1.0, listen=("127.0.0.1", 0))
    engine = Engine(load(world("hand")), settings, NoFleet(), say)  # type: ignore[arg-type]
    try:
        engine.begin()
    finally:
        engine.crew.dismiss()
    assert seen == [(2, 1)] * 2


SENSOR = """
from sensors import Scalars, SensorSettings, sensor

class MineSettings(SensorSettings):
    pass

def empty(settings, robots):
    return Scalars.empty(robots, names=("one",), units=("1",))

def count(values):
    open({told!r}, "a").write("sensed\\n")
    values[:] = 1.0

@sensor("mine", kind="scalars", settings=MineSettings, readings=empty)
def sense_mine(settings, view, readings):
    "What is compiled at its first call, say."
    {body}
"""

WORLD = """\
size: [9, 9]
duration: 0.2
until: duration
models: {rover: {body: {shape: circle, radius: 0.3}, sensors: [{type: ./mine.py}]}}
robots: [{model: rover, name: one, pose: [4, 4, 0]}]
"""


def own_sensor(folder: Path, body: str) -> Path:
    told = folder / "told.txt"
    (folder / "mine.py").write_text(SENSOR.format(told=str(told), body=body))
    return told


@pytest.mark.parametrize("listens", [True, False])
def test_a_world_that_is_served_is_rehearsed_before_its_ports_open(
    tmp_path: Path, listens: bool
) -> None:
    told = own_sensor(tmp_path, "count(readings.values)")
    before: list[bool] = []

    def say(line: str) -> None:
        if "is served at" in line:
            before.append(told.exists())

    path = write_world(tmp_path, WORLD)
    result = troupe.run(path, listen="127.0.0.1:0" if listens else None, say=say)
    assert before == [True] * listens
    assert told.exists() is listens  # nobody reads it in the run itself
    assert result.digest == troupe.run(path).digest


def test_an_error_in_the_rehearsal_is_none_of_the_run(tmp_path: Path) -> None:
    own_sensor(tmp_path, "raise RuntimeError('it has no nose')")
    path = write_world(tmp_path, WORLD)
    rehearse(load(path))
    assert troupe.run(path, listen="127.0.0.1:0").outcome == "completed"


@pytest.mark.parametrize(
    ("more", "served"),
    [
        ("", False),
        ("player: {port: 0}\n", True),
        ("controllers: {hand: {external: true}}\n", False),  # no robot has it
    ],
)
def test_only_worlds_with_ports_are_rehearsed(tmp_path: Path, more: str, served: bool) -> None:
    own_sensor(tmp_path, "pass")
    path = write_world(tmp_path, WORLD + more)
    assert is_served(load(path), None) is served
    assert is_served(load(path), ("127.0.0.1", 0))


@pytest.mark.parametrize("controller", ["{external: true}", '{command: ["true"]}'])
def test_a_world_is_served_whose_controllers_need_a_port(tmp_path: Path, controller: str) -> None:
    own_sensor(tmp_path, "pass")
    world = WORLD.replace("pose: [4, 4, 0]}", "pose: [4, 4, 0], controller: it}")
    loaded = load(write_world(tmp_path, f"{world}controllers: {{it: {controller}}}\n"))
    assert is_served(loaded, None)
    assert not is_served(loaded, None, controllers=False)
