"""The exported JSON Schema is judged by an outsider: it takes what we take and refuses the rest."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from test_world_load import EVERYTHING

from sensors.registry import SENSORS
from sim.worldfile.json_schema import json_schema

SCHEMA = json_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
WORLDS = sorted((Path(__file__).resolve().parents[3] / "worlds").glob("*.yaml"))


def test_it_is_a_json_schema_of_draft_2020_12() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert json.loads(json.dumps(SCHEMA)) == SCHEMA


def test_it_takes_a_world_with_every_key() -> None:
    VALIDATOR.validate(yaml.safe_load(EVERYTHING))


@pytest.mark.parametrize("path", WORLDS, ids=[path.stem for path in WORLDS])
def test_it_takes_every_world_that_comes_with_troupe(path: Path) -> None:
    VALIDATOR.validate(yaml.safe_load(path.read_text(encoding="utf-8")))


def test_a_file_that_includes_others_may_leave_out_what_stands_there() -> None:
    part = {"models": {"painter": {"body": {"color": "red"}, "drive": {"kind": "car"}}}}
    assert not VALIDATOR.is_valid(part)
    VALIDATOR.validate({"include": ["base.yaml"], **part})
    part["models"]["painter"]["body"]["colour"] = "red"
    assert not VALIDATOR.is_valid({"include": ["base.yaml"], **part})


def test_it_knows_every_sensor_with_its_settings() -> None:
    for name, sensor in SENSORS.items():
        known = SCHEMA["$defs"][f"sensor_{name}"]["properties"]
        assert set(known) == {"type", *sensor.settings.model_fields}


def test_colours_are_written_as_text() -> None:
    assert SCHEMA["$defs"]["Boundary"]["properties"]["color"]["default"] == "#ff0000"
    for part in ("Boundary", "Map", "Box"):
        assert SCHEMA["$defs"][part]["properties"]["color"]["type"] == "string"


def test_every_key_is_described() -> None:
    for name, part in SCHEMA["$defs"].items():
        for key, about in part.get("properties", {}).items():
            if key == "type" and name == "sensor_file":
                continue
            assert about.get("description"), f"{name}.{key}"


BAD = [
    (("sized",), [1, 2]),
    (("size",), [16]),
    (("size",), [16, -1]),
    (("size",), "16x21"),
    (("duration",), 0),
    (("until",), "ever"),
    (("boundary", "color"), 255),
    (("boundary", "color"), "#ff00"),
    (("boundary", "shape"), "circle"),
    (("region", 0), [1, 2, 3]),
    (("obstacles", 0, "shape"), "ball"),
    (("obstacles", 0, "radius"), 1),
    (("obstacles", 0, "pose"), None),
    (("models", "painter", "body"), {}),
    (("models", "painter", "drive", "kind"), "tank"),
    (("models", "painter", "drive", "kind"), "car"),
    (("models", "painter", "drive", "max_sped"), 1),
    (("models", "painter", "sensors", 0, "samples"), 1),
    (("models", "painter", "sensors", 0, "fov"), 400),
    (("models", "painter", "sensors", 0, "samples"), 2.5),
    (("models", "painter", "sensors", 0, "smaples"), 2),
    (("models", "painter", "sensors", 0, "type"), "lazer"),
    (("models", "painter", "sensors", 1, "colors"), "red"),
    (("models", "painter", "actuators", 0, "type"), "printer"),
    (("models", "a b"), {"body": {"shape": "circle", "radius": 1}}),
    (("robots", 0, "count"), 2),
    (("robots", 0, "placement"), "random"),
    (("robots", 1, "placement"), "anywhere"),
    (("robots", 1, "placement"), None),
    (("robots", 1, "headings"), []),
    (("doors", 0, "at"), "X"),
    (("doors", 0, "at"), [1]),
    (("controllers", "mine", "command"), ["a"]),
    (("controllers", "mine", "args"), {"a": {"b": 1}}),
    (("controllers", "mine", "args"), {"-a": 1}),
    (("controllers", "hand", "external"), False),
    (("player", "port"), 70000),
    (("include",), 3),
]


@pytest.mark.parametrize(
    ("where", "value"), BAD, ids=[".".join(map(str, where)) + f"={value}" for where, value in BAD]
)
def test_it_refuses_what_we_refuse(where: tuple[str | int, ...], value: Any) -> None:
    data = copy.deepcopy(yaml.safe_load(EVERYTHING))
    here = data
    for key in where[:-1]:
        here = here[key]
    here[where[-1]] = value
    assert not VALIDATOR.is_valid(data)
