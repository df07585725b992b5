"""docs/sensors.md is true: its example runs, its tables are right, its world file loads."""

import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from sensing import RED, Stage

from sensors.colors import parse_color
from sensors.readings import KINDS
from sensors.registry import SENSORS, describe, settings_for, type_of

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "sensors.md").read_text()


@pytest.fixture
def folder(tmp_path):
    """A folder with the page's example in it."""
    code = re.search(r"<!-- example: nose\.py -->\n```python\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "nose.py").write_text(code.group(1))
    return tmp_path


def test_the_example_is_a_sensor(folder):
    spec = {"type": "./nose.py", "color": "red", "reach": 2.0}
    settings = settings_for(spec, folder)
    assert type_of(settings).kind == "scalars"
    assert settings.color == parse_color("red")
    stage = Stage()
    stage.box(3, 4, color=RED)
    for x in (0, 1):
        entity = stage.scene.add_entity(pose=(x, 0, 0), color=RED)
        stage.suite.add_robot(entity, f"r{x}", [settings])
    stage.sense()
    values = [stage.suite.reading(k, 0).data.values[0, 0] for k in range(2)]
    np.testing.assert_allclose(
        values,
        [np.exp(-5 / 2) + np.exp(-1 / 2), np.exp(-np.hypot(2, 4) / 2) + np.exp(-1 / 2)],
    )


def test_the_examples_noise_is_the_robots_own_and_repeats(folder):
    settings = settings_for({"type": "./nose.py", "color": "red", "noise": 1.0}, folder)

    def smells():
        stage = Stage(seed=5)
        for k in range(4):
            stage.suite.add_robot(stage.scene.add_entity(), f"r{k}", [settings])
        stage.sense(3)
        return [stage.suite.reading(k, 0).data.values[0, 0] for k in range(4)]

    assert smells() == smells()
    assert len(set(smells())) == 4


def test_the_pages_world_file_loads(folder):
    listed = yaml.safe_load(re.search(r"```yaml\n(sensors:.*?)```", PAGE, re.DOTALL).group(1))
    settings = [settings_for(spec, folder) for spec in listed["sensors"]]
    assert len(settings) == 7


@pytest.mark.parametrize("name", SENSORS)
def test_the_tables_have_every_setting_with_its_unit_and_default(name):
    section = PAGE.split(f"### `{name}`")[1].split("\n##")[0]
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*)$", section, re.MULTILINE))
    described = next(d for d in describe() if d["name"] == name)
    assert list(rows) == [s["name"] for s in described["settings"]]
    for setting in described["settings"]:
        unit, default, _ = (cell.strip() for cell in rows[setting["name"]].split("|", 2))
        assert unit == setting["unit"]
        shown = None if default == "none" else yaml.safe_load(default)
        assert shown == plain(setting["default"])


def plain(value):
    """Tuples as the lists that a world file writes."""
    return [plain(v) for v in value] if isinstance(value, tuple) else value


def test_the_page_names_every_kind_of_readings():
    assert set(re.findall(r"^  \| `(\w+)` \| `\w+\.empty", PAGE, re.MULTILINE)) == set(KINDS)
