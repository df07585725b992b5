"""What CONTRIBUTING.md says how to add is one file and one line, and works."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from controllers.dispersal.rules import MODULES
from sensors.compiled import MARK, state_of
from sensors.registry import BUILT_IN
from sim.devices.build import OTHERS
from tests.processes import ROOT, environment, troupe_command
from troupe.app import COMMANDS
from troupe.warm import machine, sources

PACKAGES = ("troupe", "gridworld", "controllers", "sim", "sensors", "player", "worlds")
TEXT = (ROOT / "CONTRIBUTING.md").read_text()
FILES = dict(re.findall(r"^<!-- file: (\S+) -->\n```python\n(.*?)^```", TEXT, re.M | re.S))
LINES = re.findall(r"^<!-- line: (\S+), in (\w+) -->\n```python\n(.*?\n)```", TEXT, re.M | re.S)
WORLD = re.findall(r"^```yaml\n(.*?)^```", TEXT, re.M | re.S)[-1]


def files_with(folder: str, text: str) -> set[str]:
    """The modules of a folder in which a text stands."""
    found = (ROOT / folder).glob("*.py")
    return {path.stem for path in found if text in path.read_text() and path.stem != "__init__"}


def test_no_file_lacks_its_line() -> None:
    assert files_with("sensors", "\n@sensor(") == set(BUILT_IN)
    assert files_with("sim/devices", "\ndef devices(") == set(OTHERS)
    assert files_with("controllers/dispersal/rules", "\nRULES = ") == set(MODULES)
    assert files_with("troupe/commands", "") == set(COMMANDS)


@pytest.fixture(scope="module")
def contributed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the packages to which every example has been added: its file, and its line."""
    root = tmp_path_factory.mktemp("contributed")
    for package in PACKAGES:
        shutil.copytree(ROOT / package, root / package)
    for path, text in FILES.items():
        assert not (root / path).exists()
        (root / path).write_text(text)
    for path, table, line in LINES:
        file = root / path
        source = file.read_text()
        end = re.search(rf"^{table} = \(\n(?:    .*\n)*?(?=\)\n)", source, re.M)
        assert end is not None, f"{path} has no table {table}"
        assert line.count("\n") == 1
        file.write_text(source[: end.end()] + line + source[end.end() :])
    keep_compiled(root)
    return root


def keep_compiled(root: Path) -> None:
    """Have a copy trust the machine code that came with it: no kernel draws on what was added."""
    for package in ("sensors", "sim/stage"):
        mark = root / package / "__pycache__" / MARK
        if mark.exists() and mark.read_text() == state_of(ROOT / package):
            mark.write_text(state_of(root / package))
    warm = root / "sensors" / "__pycache__" / f"{machine()}-{sources()}.warm"
    if warm.exists():
        warm.with_name(f"{machine()}-{sources(root)}.warm").touch()


def troupe(root: Path, *words: str) -> str:
    done = subprocess.run(
        troupe_command(*words), cwd=root, env=environment(PYTHONPATH=str(root)),
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, f"{words}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def test_everything_that_is_promised_is_shown() -> None:
    assert {Path(path).parts[0] for path in FILES} == {"sensors", "sim", "controllers", "troupe"}
    assert len(FILES) == 5
    assert len(LINES) == 4  # a controller's line is in the world file


READER = """\
from player import AioProxy, PlayerClient, Position2dProxy, SimulationProxy

with PlayerClient() as robot:
    base, simulation = Position2dProxy(robot), SimulationProxy(robot)
    compass, meter = AioProxy(robot, 0), AioProxy(robot, 1)
    while robot.read() and robot.time < 2.0:
        base.set_speed(1.0)
    simulation.report("heading", float(compass.values[0]))
    simulation.report("way", float(meter.values[0]))
    base.set_speed(0.0)
    meter.set_output(0, 0.0)
    for _ in range(3):
        robot.read()
    simulation.report("set back", float(meter.values[0]))
"""


@pytest.fixture(scope="module")
def robots(contributed: Path) -> dict[str, Any]:
    """What came of the robots of the page's world, and of one that has all that was added."""
    (contributed / "reader.py").write_text(READER)
    world = yaml.safe_load(WORLD)
    body = {"shape": "circle", "radius": 0.3}
    sensed = {"body": body, "drive": {"max_speed": 1.0}, "sensors": [{"type": "compass"}]}
    world["models"]["sensed"] = sensed
    one = {"name": "one", "model": "sensed", "pose": [1, 1, 30], "controller": "reader"}
    world["robots"].append(one)
    world["controllers"] = {"reader": {"program": "./reader.py"}}
    (contributed / "world.yaml").write_text(yaml.safe_dump(world))
    result = json.loads(troupe(contributed, "run", "world.yaml", "--json", "--quiet"))
    assert result["outcome"] == "completed", result
    return {robot["name"]: robot for robot in result["robots"]}


def test_a_new_sensor_is_listed_and_read_by_a_controller(
    contributed: Path, robots: dict[str, Any]
) -> None:
    assert "sensor compass: The heading in the world" in troupe(contributed, "sensors")
    assert robots["one"]["properties"]["heading"] == pytest.approx(math.radians(30), abs=1e-3)


def test_a_new_device_is_served_and_obeys(robots: dict[str, Any]) -> None:
    told = robots["one"]["properties"]
    assert told["way"] == pytest.approx(robots["one"]["distance"], abs=0.25)
    assert told["way"] > 1.0
    assert 0.0 <= told["set back"] < 0.25


def test_a_new_rule_fills_a_grid(contributed: Path) -> None:
    words = ("disperse", "--grid", "6x4", "--door", "0,3", "--rule", "staircase", "--json")
    result = json.loads(troupe(contributed, *words))
    assert (result["outcome"], result["settled"]) == ("completed", 24)


def test_a_new_command_has_help_and_works(contributed: Path) -> None:
    assert "Tell how many robots" in troupe(contributed, "crowd", "--help")
    assert troupe(contributed, "crowd", "wander") == "4\n"


def test_a_new_controller_drives_the_robots_of_a_world_that_names_it(
    robots: dict[str, Any],
) -> None:
    assert robots["rover"]["distance"] > 6.0
    assert 1.8 < robots["rover"]["pose"][0] < 4.2


def test_a_link_leads_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", TEXT):
        assert (ROOT / target).exists(), target
