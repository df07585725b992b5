"""The page on the architecture is true: its names are there, its floors are the contract's."""

from __future__ import annotations

import ast
import re
import tomllib
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
FILE = re.compile(
    r"`((?:troupe|sim|sensors|player|gridworld|controllers)/[\w/]+\.py)(?::([\w.]+))?`"
)


def section(title: str) -> str:
    return PAGE.split(f"\n## {title}\n")[1].split("\n## ")[0]


def table(text: str) -> list[list[str]]:
    """The cells of a table's rows, without its head."""
    rows = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("|")]
    return rows[2:]


@cache
def defined(path: str) -> set[str]:
    """What a file defines: functions, classes, and their methods behind a dot."""
    names: set[str] = set()
    for node in ast.parse((ROOT / path).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        if isinstance(node, ast.ClassDef):
            inside = [one for one in node.body if isinstance(one, ast.FunctionDef)]
            names |= {f"{node.name}.{one.name}" for one in inside}
    return names


def test_every_file_and_every_name_that_the_page_tells_is_there() -> None:
    found = FILE.findall(PAGE)
    assert len(found) > 40
    lost = [path for path, _ in found if not (ROOT / path).is_file()]
    assert lost == []
    gone = [f"{path}:{name}" for path, name in found if name and name not in defined(path)]
    assert gone == []


@pytest.mark.parametrize("title", ["A scan's way", "A command's way back"])
def test_a_walk_meets_each_name_once_and_no_room_twice(title: str) -> None:
    walk = "\n".join(line for line in section(title).splitlines() if line.startswith("|"))
    for part in walk.split("*the wire*"):
        stops = FILE.findall(part)
        assert len(stops) >= 2
        assert len(set(stops)) == len(stops)
        rooms = [path.rsplit("/", 1)[0] for path, _ in stops]
        left = [room for room, after in zip(rooms, [*rooms[1:], ""], strict=True) if room != after]
        assert len(set(left)) == len(left)


def test_the_floors_are_those_that_the_contract_holds() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    floors = next(one["layers"] for one in contracts["contracts"] if one["type"] == "layers")
    rows = table(section("The floors of sim"))
    told = [re.findall(r"`(\w+)`", rooms) for _, rooms, _ in rows]
    assert told == [floor.split(" | ") for floor in floors]
    assert [int(number) for number, *_ in rows] == list(range(len(floors), 0, -1))


def test_all_packages_ship_are_typed_and_keep_to_the_contracts() -> None:
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]
    packages = tools["importlinter"]["root_packages"]
    assert tools["hatch"]["build"]["targets"]["wheel"]["packages"] == packages
    assert tools["mypy"]["files"] == [*packages, "scripts"]
    assert sorted(packages) == sorted(
        path.parent.name for path in ROOT.glob("*/__init__.py") if path.parent.name != "tests"
    )
