"""docs/worlds.md says every key that there is, none besides, and its worlds can be loaded."""

from __future__ import annotations

import re
import shlex
from functools import cache
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml

from sim.build import load
from sim.worldfile import WorldError
from sim.worldfile.json_schema import json_schema

DOCS = Path(__file__).resolve().parents[3] / "docs" / "worlds.md"
TEXT = DOCS.read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```yaml\n(.*?)^```", TEXT, re.MULTILINE | re.DOTALL)

BASE = """\
size: [10, 8]
models:
  rover:
    body: {shape: circle, radius: 0.3}
    drive: {kind: differential}
"""
"""What a block that is no world by itself is laid upon; also the rovers.yaml that one includes."""


def documented() -> dict[str, dict[str, str]]:
    """Section -> key -> default, of every table below `## The keys`."""
    sections: dict[str, dict[str, str]] = {}
    for part in re.split(r"^### ", TEXT[TEXT.index("## The keys") :], flags=re.MULTILINE)[1:]:
        heading = re.match(r"`([^`]+)`", part)
        assert heading, part[:40]
        rows = re.findall(r"^\| `([^`]+)` \| (.*?) \|", part, re.MULTILINE)
        if rows:
            sections[heading[1]] = dict(rows)
    return sections


@cache
def in_schema() -> dict[str, dict[str, dict[str, Any]]]:
    """Section, named as in the docs -> key -> its JSON Schema; of shapes all keys in one."""
    schema = json_schema()
    found: dict[str, dict[str, dict[str, Any]]] = {}

    def walk(node: dict[str, Any], where: str) -> None:
        for choice in node.get("anyOf", []) + node.get("oneOf", []):
            walk(choice, where)
        if "$ref" in node:
            name = node["$ref"].removeprefix("#/$defs/")
            if not name.startswith("sensor_"):
                walk(schema["$defs"][name], where)
        if where.endswith(".args"):
            return
        for key, inside in node.get("properties", {}).items():
            if "description" in inside or "$ref" in inside:
                found.setdefault(where, {})[key] = inside
            walk(inside, key if where == "world" else f"{where}.{key}")
        if isinstance(node.get("items"), dict):
            walk(node["items"], f"{where}[]")
        if isinstance(node.get("additionalProperties"), dict):
            walk(node["additionalProperties"], f"{where}.NAME")

    walk(schema["$defs"]["World"], "world")
    return found


def test_every_key_of_the_schema_is_documented_and_no_other() -> None:
    documents = {section: set(keys) for section, keys in documented().items()}
    schema = {section: set(keys) for section, keys in in_schema().items()}
    assert documents == schema


def test_the_documented_defaults_are_the_schemas() -> None:
    schema = in_schema()
    compared = 0
    for section, keys in documented().items():
        for key, default in keys.items():
            info = schema[section][key]
            given = yaml.safe_load(default.strip("`")) if "required" not in default else None
            is_word = re.fullmatch(r"`[a-z_]+`", default) and given is not None
            if is_word or isinstance(given, bool | int | float | list):
                assert info["default"] == given, f"{section}.{key}"
                compared += 1
            elif default in ("none", "any", "`null`"):
                assert info.get("default") in (None, [], False), f"{section}.{key}"
    assert compared > 30


def test_required_keys_are_documented_as_required() -> None:
    """In JSON Schema `required` stands beside the properties, so the loader is asked."""
    required = {
        (section, key)
        for section, keys in documented().items()
        for key, default in keys.items()
        if default == "required"
    }
    assert required == {
        ("map", "file"), ("obstacles[]", "shape"), ("obstacles[]", "pose"),
        ("models.NAME", "body"), ("models.NAME.body", "shape"),
        ("models.NAME.battery", "capacity"),
        ("models.NAME.actuators[]", "type"), ("robots[]", "model"), ("doors[]", "name"),
        ("doors[]", "at"), ("doors[]", "model"), ("doors[]", "period"),
        ("log", "file"),
        ("models.NAME.body.parts[]", "shape"), ("obstacles[].parts[]", "shape"),
    }  # fmt: skip
    for section, key in required:
        assert "default" not in in_schema()[section][key], f"{section}.{key}"


def test_mistakes_are_told_as_documented(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arena.yaml").write_text(
        BASE.replace("0.3", "-0.3").replace("    drive: {kind: differential}\n", "")
        + "robots:\n  - {model: rover, pose: [5, 4, 0], contoler: wander}\n"
    )
    with pytest.raises(WorldError) as raised:
        load("arena.yaml")
    assert f"```text\n{raised.value}\n```" in TEXT


def test_the_documented_settings_can_be_laid_upon_their_world() -> None:
    lines = re.findall(r"^    (troupe run .*--set .*)$", TEXT, re.MULTILINE)
    assert lines
    for line in lines:
        _, _, world, *words = shlex.split(line)
        assert words[::2] == ["--set"] * (len(words) // 2)
        load(DOCS.parents[1] / "worlds" / f"{world}.yaml", settings=words[1::2])


def test_there_are_examples() -> None:
    assert len(BLOCKS) >= 10


@pytest.mark.parametrize("block", BLOCKS, ids=[block.split("\n")[0][:40] for block in BLOCKS])
def test_every_example_can_be_loaded(tmp_path: Path, block: str) -> None:
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "maze.txt").write_text("#####\n#...#\n#S#.#\n#####\n")
    picture = np.full((80, 120), 255, dtype=np.uint8)
    picture[:4] = 0
    assert cv2.imwrite(str(tmp_path / "maps" / "cave.png"), picture)
    (tmp_path / "mine.py").write_text("")
    (tmp_path / "a.out").write_text("#!/bin/sh\n")
    (tmp_path / "a.out").chmod(0o755)
    (tmp_path / "rovers.yaml").write_text(BASE)
    path = tmp_path / "world.yaml"
    path.write_text(block)
    if "include:" not in block and "name: Two rovers" not in block:
        base = BASE.replace("size: [10, 8]\n", "") if "map:" in block else BASE
        (tmp_path / "rovers.yaml").write_text(base)
        path.write_text("include: rovers.yaml\n" + block)
    load(path)
