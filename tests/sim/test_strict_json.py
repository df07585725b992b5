"""The result is JSON that every reader takes, whatever was reported."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import troupe
from sim import strictjson
from sim.result import FloorRecord, Result, RobotRecord
from tests import started

World = Callable[..., Path]


def strict(text: str) -> Any:
    """What a reader gets that takes no more than the standards have."""

    def no_constant(name: str) -> Any:
        raise AssertionError(f"{name} is not JSON")

    value = json.loads(text, parse_constant=no_constant)
    json.dumps(value, ensure_ascii=False).encode()  # raises for half of a surrogate pair
    return value


REFUSED = [
    "1e999",
    "-1e999",
    '[1, {"a": 1e400}]',
    "NaN",
    "Infinity",
    "-Infinity",
    "1" + "0" * 400,
    "9" * 5000,
    r'"\ud800"',
    r'["\udc80 and more"]',
    r'{"\ud800": 1}',
    "[" * 101 + "]" * 101,
    "[" * 900 + "]" * 900,
    "[" * 30_000 + "]" * 30_000,
    '{"a":' * 101 + "1" + "}" * 101,
    "",
    "nothing",
]
TAKEN = {
    "1e300": 1e300,
    "-0.0": 0.0,
    r'"\ud83e\udd16"': "\U0001f916",
    "[" * 99 + '"deep"' + "]" * 99: None,
    "1" + "0" * 300: 10**300,
    '{"a": [1, null, true]}': {"a": [1, None, True]},
}

REPORTS = """
import json, os
from player import PlayerClient, PlayerRefused, Position2dProxy, SimulationProxy, SpeechProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    simulation = SimulationProxy(robot)
    for number, text in enumerate(json.loads({texts!r})):
        try:
            simulation.set_property(robot.name, f"key{{number}}", text.encode())
        except PlayerRefused:
            pass
    SpeechProxy(robot).say("\\x1b[31m \\U0001f916")
    robot.read()
"""


def test_what_is_reported_is_refused_or_comes_out_as_valid_json(world_with: World) -> None:
    texts = [*REFUSED, *TAKEN]
    path = world_with(REPORTS.format(texts=json.dumps(texts)), duration=0.5)
    done = started.troupe("run", path, "--json")
    assert done.returncode == 0, done.stderr
    properties = strict(done.stdout)["robots"][0]["properties"]
    taken = [f"key{number}" for number in range(len(REFUSED), len(texts))]
    assert sorted(properties) == sorted(taken)
    for key, (text, value) in zip(taken, TAKEN.items(), strict=True):
        assert properties[key] == (json.loads(text) if value is None else value)
    told = [line for line in done.stderr.splitlines() if "that is refused" in line]
    assert told == [
        "one: its program sent a value of the property 'key0' that is refused: "
        "1e999 is no number in JSON"
    ]


@pytest.mark.parametrize("text", REFUSED)
def test_what_not_every_reader_takes_is_not_let_in(text: str) -> None:
    with pytest.raises(ValueError):  # noqa: PT011 - of many kinds
        strictjson.loads(text)


anything = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(),
        st.floats(),
        st.text(st.characters(codec=None), max_size=8),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.tuples(inner, inner),
        st.dictionaries(st.text(st.characters(codec=None), max_size=4), inner, max_size=4),
    ),
    max_leaves=20,
)


@settings(deadline=None)
@given(anything)
def test_whatever_is_written_is_valid(value: Any) -> None:
    strict(strictjson.dumps(value))


@settings(deadline=None)
@given(anything)
def test_what_is_let_in_comes_out_the_same(value: Any) -> None:
    try:
        read = strictjson.loads(json.dumps(value))
    except ValueError:
        return
    assert strict(strictjson.dumps(read)) == read


def test_a_result_with_numbers_that_are_none_is_valid_all_the_same() -> None:
    record = RobotRecord(
        "r\udc80", "m", 0.0, (math.nan, 0.0, 0.0), (math.inf, 0.0, 0.0), "none",
        properties={"k": -math.inf},
    )  # fmt: skip
    floor = FloorRecord(math.nan, 0.0, 0.0)
    result = Result("w\udcff", 1, "completed", 1.0, 0.5, 10, "sha256:", [record], floor, [])
    found = strict(json.dumps(result.as_json(), allow_nan=False))
    assert found["robots"][0]["start"] == [None, 0.0, 0.0]
    assert found["robots"][0]["properties"] == {"k": None}
    assert found["robots"][0]["name"] == r"r\udc80"
    assert found["floor"]["coverage"] is None


def test_a_run_reports_through_python_what_it_prints(world_with: World) -> None:
    path = world_with(REPORTS.format(texts=json.dumps(["1e999", "3"])), duration=0.5)
    result = troupe.run(path)
    assert result.robot("one").properties == {"key1": 3}
