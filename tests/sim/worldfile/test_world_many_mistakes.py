"""Worlds with mistakes without end: the first hundred, and how many more, before one is tired."""

from __future__ import annotations

from pathlib import Path

import pytest
from world_texts import HEAD

from sim.build import load
from sim.worldfile import WorldError
from sim.worldfile.mistakes import Mistake

MANY = 20_000


def told(tmp_path: Path, text: str) -> list[str]:
    path = tmp_path / "world.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(WorldError) as raised:
        load(path)
    return str(raised.value).removeprefix("").splitlines()


@pytest.mark.parametrize(
    "text",
    [
        "".join(f"k{number}: 1\n" for number in range(MANY)),
        "robots:\n" + "  - {model: rover, pose: [5, 4, 0]}\n" * 1500,
        "robots:\n" + "  - {modl: rover, pose: [5, 4]}\n" * 1000,
        "name: a\n" * MANY,
        "region: [" + "!x 1, " * MANY + "1]\n",
    ],
    ids=["unknown keys", "robots on one spot", "broken robots", "the same key", "tags"],
)
def test_of_many_mistakes_the_first_hundred_are_told_and_how_many_more(
    tmp_path: Path, text: str
) -> None:
    lines = told(tmp_path, HEAD + text)
    assert len(lines) == 101
    assert lines[-1].startswith("... and ")
    assert lines[-1].endswith(" more mistakes")
    places = [int(line.split("world.yaml:")[1].split(":")[0]) for line in lines[:-1]]
    assert places == sorted(places)
    assert places[0] in (5, 6, 7)
    if "pose: [5, 4, 0]" in text:  # as many mistakes as robots
        assert "robots.1.pose: the robot starts in robot rover1" in lines[0]
        assert lines[-1] == "... and 1399 more mistakes"


def test_all_mistakes_are_in_the_error_all_the_same() -> None:
    mistakes = [Mistake((number,), "is wrong") for number in range(1000)]
    assert WorldError(mistakes).mistakes == mistakes
    assert len(str(WorldError(mistakes[:100])).splitlines()) == 100
    assert str(WorldError(mistakes[:101])).endswith("\n... and 1 more mistake")


@pytest.mark.parametrize("size", [61, 5000, 100_000])
def test_a_mistake_is_a_line_of_bounded_length_however_long_the_names_are(
    tmp_path: Path, size: int
) -> None:
    long, key = "x" * size, "x" * min(size, 1000)  # YAML's keys end there
    text = (
        f"{HEAD}{key}: 1\nname: {{{key}: 1}}\nmap: {{file: {long}, cell: 1}}\n"
        f"robots:\n  - {{model: {long}, controller: {long}, name: {long}, pose: [1, 1, 0]}}\n"
        f"controllers: {{{key}: {{program: {long}}}, b: {{command: [{long}]}},\n"
        f"  c: {{command: [./{long}]}}, d: {{program: ./{long}.py}}}}\nplayer: {{host: {long}}}\n"
    )
    lines = told(tmp_path, text)
    assert len(lines) >= 6
    assert max(map(len, lines)) < 2000
