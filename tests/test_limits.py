"""No test fails because the machine is slow: what is waited for ends by what happens."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from hypothesis import settings

from tests.patience import PATIENCE

TESTS = Path(__file__).parent
GIVES_UP = 1.0
"""Seconds up to which a limit is one that a test wants to see run out."""
NAMES = {"timeout", "within", "seconds", "deadline"}
WAITS = {"wait", "join", "settimeout", "poll", "communicate"}


def limits(source: str) -> list[tuple[int, float]]:
    """Numbers of seconds that stand in a test as limits of a wait, with their lines."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.Call):
            continue
        given = [word.value for word in node.keywords if word.arg in NAMES]
        if isinstance(node.func, ast.Attribute) and node.func.attr in WAITS:
            given += node.args[:1]
        for value in given:
            if isinstance(value, ast.Constant) and isinstance(value.value, int | float):
                found.append((node.lineno, float(value.value)))
    return found


@pytest.mark.parametrize(
    ("source", "found"),
    [
        ("run(words, timeout=60)", [(1, 60.0)]),
        ("thread.join(20)", [(1, 20.0)]),
        ("thread.join(PATIENCE)\n', '.join(words)", []),
    ],
)
def test_limits_are_found(source: str, found: list[tuple[int, float]]) -> None:
    assert limits(source) == found


def test_no_limit_is_one_that_a_busy_machine_could_pass() -> None:
    short = [
        f"{path.relative_to(TESTS)}:{line}: {seconds:g} s"
        for path in TESTS.rglob("*.py")
        for line, seconds in limits(path.read_text())
        if GIVES_UP < seconds < PATIENCE
    ]
    assert short == []


def test_no_example_of_a_property_has_a_deadline() -> None:
    assert settings().deadline is None
