"""The examples in docstrings are true."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
from types import ModuleType

import pytest

PACKAGES = ["player", "sensors", "controllers", "gridworld", "troupe"]
PROGRAMS = {"__main__"}
"""Modules that run when they are imported."""


def modules() -> list[ModuleType]:
    """Every module of the packages that are meant to be imported."""
    found = []
    for name in PACKAGES:
        package = importlib.import_module(name)
        found.append(package)
        for info in pkgutil.walk_packages(package.__path__, f"{name}."):
            if info.name.rpartition(".")[2] not in PROGRAMS:
                found.append(importlib.import_module(info.name))
    return found


WITH_EXAMPLES = [m for m in modules() if any(t.examples for t in doctest.DocTestFinder().find(m))]


def test_there_are_examples() -> None:
    assert {m.__name__.partition(".")[0] for m in WITH_EXAMPLES} >= {"player", "sensors"}


@pytest.mark.parametrize("module", WITH_EXAMPLES, ids=lambda module: module.__name__)
def test_examples_are_true(module: ModuleType) -> None:
    failed, tried = doctest.testmod(module, raise_on_error=False)
    assert tried
    assert failed == 0
