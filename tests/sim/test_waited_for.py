"""A program of the world file is waited for from its entry to its end, whatever it reads and when.

Each program here dawdles, drives a rover that it meets past others, and reports which readings it
had: a world that did not wait for it would have moved on, and readings would be missing.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import troupe
from sim.result import Result
from tests.processes import ROOT
from tests.sim.serving import write_world

TICKS = 40

WORLD = """\
size: [12, 8]
duration: {duration}
until: duration
models:
  post: {{body: {{shape: box, size: [0.4, 0.4]}}, drive: null, sensors: [{{type: laser}}]}}
  rover: {{body: {{shape: circle, radius: 0.3}}, sensors: [{{type: laser}}]}}
robots:
  - {{model: {model}, name: one, pose: [6, 6, -90], controller: mine}}
  - {{model: rover, name: two, pose: [2, 4, 0], controller: go}}
controllers:
  mine: {mine}
  go: {{program: ./go.py}}
player: {{layout: {layout}}}
"""

GO = """
from player import PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        base.set_speed(0.5)
"""

HEAD = """
from player import LaserProxy, PlayerClient, Position2dProxy, SimulationProxy, SpeechProxy

had = []

def dawdle():
    sum(k * k for k in range(30_000))

def take(robot):
    dawdle()
    had.append(round(robot.time, 6))
"""

TELL = """
    SimulationProxy(robot).report("had", had)
    robot.read()
"""

LASER_ALONE = f"""
with PlayerClient() as robot:
    laser = LaserProxy(robot)
    while len(had) < {TICKS} and robot.read():
        take(robot)
{TELL}
"""

DRIVES_LATER = f"""
with PlayerClient() as robot:
    laser = LaserProxy(robot)
    while len(had) < 10 and robot.read():
        take(robot)
    dawdle()
    base = Position2dProxy(robot)
    while len(had) < {TICKS} and robot.read():
        base.set_speed(0.5)
        take(robot)
{TELL}
"""

DRIVES_NO_MORE = f"""
with PlayerClient() as robot:
    laser = LaserProxy(robot)
    base = Position2dProxy(robot)
    while len(had) < 10 and robot.read():
        base.set_speed(0.2)
        take(robot)
    base.close()
    while len(had) < {TICKS} and robot.read():
        take(robot)
{TELL}
"""

READS_NOTHING_FOR_A_WHILE = f"""
with PlayerClient() as robot:
    laser = LaserProxy(robot)
    while len(had) < 10 and robot.read():
        take(robot)
    laser.close()
    for _ in range(20):
        dawdle()
    laser = LaserProxy(robot)
    while len(had) < {TICKS} and robot.read():
        take(robot)
{TELL}
"""

TURNS_TO_PULL_LATE = f"""
with PlayerClient() as robot:
    robot.set_data_mode("push")
    dawdle()
    robot.set_data_mode("pull")
    laser = LaserProxy(robot)
    while len(had) < {TICKS} and robot.read():
        take(robot)
{TELL}
"""

TWO_CONNECTIONS_IN_TURN = f"""
with PlayerClient() as robot, PlayerClient() as other:
    laser = LaserProxy(robot)
    base = Position2dProxy(other)
    while len(had) < {TICKS} and robot.read():
        take(robot)
        assert other.read() and other.time == robot.time
        base.set_speed(0.3)
        other.flush()
{TELL}
"""

TWO_CONNECTIONS_THE_OTHER_WAY = f"""
with PlayerClient() as other, PlayerClient() as robot:
    laser = LaserProxy(other)
    base = Position2dProxy(robot)
    while len(had) < {TICKS} and robot.read():
        take(robot)
        assert other.read() and other.time == robot.time
        base.set_speed(0.3)
{TELL}
"""

COMMANDS_BY_A_SECOND = f"""
with PlayerClient() as robot, PlayerClient() as other:
    laser = LaserProxy(robot)
    base = Position2dProxy(other)
    while len(had) < {TICKS} and robot.read():
        take(robot)
        base.set_speed(0.3)
        other.flush()
{TELL}
"""

ONE_AFTER_THE_OTHER = f"""
for part in (10, {TICKS}):
    with PlayerClient() as robot:
        laser = LaserProxy(robot)
        while len(had) < part and robot.read():
            take(robot)
        if part == {TICKS}:
{TELL.replace("    ", "            ")}
    dawdle()
"""

HAS_AN_ONLOOKER = f"""
import subprocess, sys

LOOKS = '''
from player import LaserProxy, PlayerClient
with PlayerClient() as robot:
    laser = LaserProxy(robot)
    while robot.read():
        print("looked", flush=True)
'''
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    looks = subprocess.Popen([sys.executable, "-c", LOOKS], stdout=subprocess.PIPE)
    while len(had) < {TICKS} and robot.read():
        take(robot)
        base.set_speed(0.3)
{TELL}
    looks.kill()
    looks.wait()  # else it would be the program's last connection, and go on with the world alone
"""

ONE_CONNECTION = {
    "the laser alone": LASER_ALONE,
    "it drives later": DRIVES_LATER,
    "it drives no more": DRIVES_NO_MORE,
    "it reads nothing for a while": READS_NOTHING_FOR_A_WHILE,
    "it turns to pull late": TURNS_TO_PULL_LATE,
}
SEVERAL = {
    "two connections in turn": TWO_CONNECTIONS_IN_TURN,
    "two the other way round": TWO_CONNECTIONS_THE_OTHER_WAY,
    "commands go by the second": COMMANDS_BY_A_SECOND,
    "one after the other": ONE_AFTER_THE_OTHER,
    "a child of its own looks on": HAS_AN_ONLOOKER,
}


def world(
    folder: Path,
    program: str,
    kind: str = "program",
    *,
    model: str = "rover",
    layout: str = "per_robot",
    ticks: int = TICKS + 5,
) -> Path:
    (folder / "mine.py").write_text(HEAD + program)
    (folder / "go.py").write_text(GO)
    mine = "{program: ./mine.py}"
    if kind == "command":
        mine = f'{{command: ["{sys.executable}", "{folder / "mine.py"}"]}}'
    text = WORLD.format(duration=ticks * 0.1, model=model, mine=mine, layout=layout)
    return write_world(folder, text)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the programs are; those of a `command` find our packages."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    return tmp_path


def had_all(result: Result, ticks: int = TICKS) -> None:
    """Whether the program had the reading of every tick, from the first one on."""
    one = result.robot("one")
    assert one.state == "finished", one.error
    assert one.properties["had"] == [round(0.1 * (k + 1), 6) for k in range(ticks)]


@pytest.mark.parametrize("kind", ["program", "command"])
@pytest.mark.parametrize("what", ONE_CONNECTION)
def test_a_program_misses_no_reading(folder: Path, what: str, kind: str) -> None:
    had_all(troupe.run(world(folder, ONE_CONNECTION[what], kind)))


@pytest.mark.parametrize("kind", ["program", "command"])
def test_a_program_of_a_robot_without_a_drive_misses_no_reading(folder: Path, kind: str) -> None:
    had_all(troupe.run(world(folder, LASER_ALONE, kind, model="post")))


@pytest.mark.parametrize("what", SEVERAL)
def test_a_program_with_several_connections_misses_no_reading(folder: Path, what: str) -> None:
    had_all(troupe.run(world(folder, SEVERAL[what], "command")))


@pytest.mark.parametrize("model", ["rover", "post"])
def test_a_program_at_a_port_of_all_robots_misses_no_reading(folder: Path, model: str) -> None:
    had_all(troupe.run(world(folder, LASER_ALONE, "command", model=model, layout="shared")))


@pytest.mark.usefixtures("busy")
def test_runs_under_load_have_one_digest_however_the_program_is_started(folder: Path) -> None:
    """It drives from its tenth reading on: what it misses of them is in the digest."""
    kinds = ["program", "command"] * 2
    digests = {troupe.run(world(folder, DRIVES_LATER, kind, ticks=15)).digest for kind in kinds}
    assert len(digests) == 1
