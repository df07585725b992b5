"""The registry: sensors by name, sensor files of a user's own, and clear mistakes."""

import sys
from pathlib import Path

import pytest
from pydantic import ValidationError

from sensors.readings import KINDS, Scalars
from sensors.registry import SENSORS, describe, load_file, sensor, settings_for, type_of
from sensors.settings import SensorSettings

OWN = '''
"""A sensor of a user's own."""
from sensors import Scalars, SensorSettings, View, sensor, setting

class ThermometerSettings(SensorSettings):
    scale: float = setting(1.0, gt=0, unit="K", description="how much one tick warms")

@sensor("thermometer", kind="scalars", settings=ThermometerSettings,
        readings=lambda s, n: Scalars.empty(n, ("temperature",), ("K",)))
def sense_heat(settings: ThermometerSettings, view: View, readings: Scalars) -> None:
    """How warm it is."""
    readings.values[view.rows] = settings.scale * FACTOR * view.tick
'''


def own(folder: Path, factor: int = 1, name: str = "sensors.py") -> Path:
    file = folder / name
    file.write_text(OWN.replace("FACTOR", str(factor)))
    return file


def test_every_sensor_is_described_with_units():
    described = {d["name"]: d for d in describe()}
    assert list(described) == ["laser", "ranger", "blobfinder", "fiducial", "bumper"]
    for entry in described.values():
        assert entry["kind"] in KINDS
        assert entry["summary"].endswith(".")
        for setting in entry["settings"]:
            assert setting["unit"], setting
            assert setting["description"], setting
    laser = {s["name"]: s for s in described["laser"]["settings"]}
    assert laser["range"]["default"] == 20.0
    assert laser["range"]["unit"] == "m"


def test_settings_are_values():
    spec = {"type": "ranger", "elements": [[0, 0, 0], [1, 0, 90]]}
    first, second = settings_for(spec), settings_for(dict(spec))
    assert first == second
    assert hash(first) == hash(second)
    assert first.mount == (0, 0, 0)
    assert first == second  # what was computed on the way does not matter
    assert hash(first) == hash(second)
    assert first != settings_for(spec | {"range": 4})
    assert type_of(first) is SENSORS["ranger"]
    with pytest.raises(ValidationError):
        first.range = 3


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ({}, "a sensor needs a type: laser"),
        ({"type": "lasr"}, "there is no sensor 'lasr': did you mean laser?"),
        ({"type": "{x}"}, "there is no sensor '.x.': there are laser"),
        ({"type": 3}, "a name or a file"),
        ({"type": "./nowhere.py"}, "cannot read the sensor file .*nowhere.py: No such file"),
    ],
)
def test_an_unknown_type_is_a_mistake_at_the_key_type(spec, message, tmp_path):
    with pytest.raises(ValidationError, match=message) as caught:
        settings_for(spec, tmp_path)
    assert caught.value.errors()[0]["loc"] == ("type",)


def test_a_users_file_is_a_sensor_and_gets_in_nobodys_way(tmp_path):
    """It is called sensors.py and lies in the working directory's place, as bad as can be."""
    own(tmp_path)
    before, path = set(sys.modules), list(sys.path)
    settings = settings_for({"type": "./sensors.py", "scale": 2}, tmp_path)
    assert type_of(settings).name == "thermometer"
    assert sys.path == path
    assert {m for m in sys.modules if "sensors" in m} - before == set()
    assert sys.modules["sensors"].__file__ != str(tmp_path / "sensors.py")
    assert "thermometer" not in SENSORS


def test_two_files_with_one_name_and_one_sensor_name_are_two_sensors(tmp_path):
    files = []
    for factor in (1, 2):
        (tmp_path / str(factor)).mkdir()
        files.append(own(tmp_path / str(factor), factor))
    first, second = map(load_file, files)
    assert first.settings is not second.settings
    assert load_file(files[0]) is first
    assert load_file(str(files[0])) is first


def test_a_changed_file_is_imported_anew(tmp_path):
    first = load_file(own(tmp_path, 1))
    second = load_file(own(tmp_path, 2))
    assert second is not first
    assert load_file(own(tmp_path, 1)) is first


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\n", "registers none"),
        (OWN.replace("FACTOR", "1") + OWN.replace("FACTOR", "1"), "'thermometer', 'thermometer'"),
        ("a = 1\n\nb = 1 / 0\n", r"own.py:3: ZeroDivisionError"),
        ("def\n", r"own.py:1: SyntaxError"),
        ("import no_such_module_anywhere\n", "ModuleNotFoundError"),
        (OWN.replace("scalars", "scalers"), "no kind 'scalers'"),
    ],
)
def test_what_is_wrong_with_a_file_is_said_with_its_line(tmp_path, text, message):
    file = tmp_path / "own.py"
    file.write_text(text)
    with pytest.raises(ValidationError, match=message):
        settings_for({"type": "own.py"}, tmp_path)


def test_a_mistake_in_a_file_sensors_settings_is_at_its_key(tmp_path):
    own(tmp_path)
    with pytest.raises(ValidationError) as caught:
        settings_for({"type": "sensors.py", "scale": -1}, tmp_path)
    assert caught.value.errors()[0]["loc"] == ("scale",)


def test_a_name_is_given_only_once():
    class Settings(SensorSettings):
        pass

    def empty(settings: Settings, n: int) -> Scalars:
        return Scalars.empty(n, (), ())

    with pytest.raises(ValueError, match="there is a sensor 'laser' already"):
        sensor("laser", kind="scalars", settings=Settings, readings=empty)(lambda *_: None)
    laser = SENSORS["laser"].settings
    with pytest.raises(ValueError, match="settings of its own"):
        sensor("other", kind="scalars", settings=laser, readings=empty)(lambda *_: None)


@pytest.mark.parametrize("name", SENSORS)
def test_the_settings_have_a_json_schema_with_units(name):
    schema = SENSORS[name].settings.model_json_schema()
    assert schema["additionalProperties"] is False
    for field in schema["properties"].values():
        assert field["unit"]
        assert field["description"]
