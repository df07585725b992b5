"""A controller's `args` become the options on its command line."""

from __future__ import annotations

import argparse
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.worldfile.options import options


@pytest.mark.parametrize(
    ("args", "words"),
    [
        ({}, []),
        ({"robots": 4}, ["--robots", "4"]),
        ({"max_speed": -1}, ["--max-speed=-1"]),
        ({"max_speed": -0.5}, ["--max-speed=-0.5"]),
        ({"paint": True}, ["--paint"]),
        ({"paint": False}, ["--no-paint"]),
        ({"dry_run": False}, ["--no-dry-run"]),
        ({"goals": (1, -2, 3)}, ["--goals", "1", "--goals=-2", "--goals", "3"]),
        ({"goals": [1.5, "x"]}, ["--goals", "1.5", "--goals", "x"]),
        ({"goals": ()}, []),
        ({"rule": None}, []),
        ({"name": ""}, ["--name", ""]),
        ({"name": "-x"}, ["--name=-x"]),
        ({"name": "a b"}, ["--name", "a b"]),
        ({"b": 1, "a": 2}, ["--b", "1", "--a", "2"]),
    ],
)
def test_args_become_options(args: dict[str, Any], words: list[str]) -> None:
    assert options(args) == words


VALUES = st.integers() | st.floats(allow_nan=False) | st.text(max_size=9)


@given(st.lists(VALUES, max_size=4), st.booleans(), VALUES)
def test_argparse_reads_back_what_was_meant(many: list[Any], flag: bool, one: Any) -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--many", action="append", default=[])
    parser.add_argument("--the-flag", action=argparse.BooleanOptionalAction)
    parser.add_argument("--one")
    words = options({"many": tuple(many), "the_flag": flag, "one": one})
    found = parser.parse_args(words)
    assert found.many == [str(value) for value in many]
    assert found.the_flag is flag
    assert found.one == str(one)
