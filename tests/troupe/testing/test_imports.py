"""Scripts and the package itself do without the tests, and without what tests alone need."""

from __future__ import annotations

import ast
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import troupe.testing
from tests.processes import ROOT, environment

SCRIPTS = sorted((ROOT / "scripts").rglob("*.py"))
MODULES = [
    one.name for one in pkgutil.walk_packages(troupe.testing.__path__, "troupe.testing.")
]  # fmt: skip


def imported(path: Path) -> set[str]:
    """The modules that a file imports, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module)
    return found


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_no_script_imports_tests(script: Path) -> None:
    assert not [name for name in imported(script) if name.partition(".")[0] == "tests"]


def test_the_papers_are_judged_without_the_engine() -> None:
    """Tests of the engine's own parts are in tests/sim and tests/troupe; a script measures them."""
    rooms = ("papers", "controllers", "sensors", "gridworld", "docs")
    files = [path for room in rooms for path in (ROOT / "tests" / room).rglob("*.py")]
    files += [path for path in SCRIPTS if path.parent.name != "measures"]
    know = {path for path in files if imported(path) & {"sim.engine", "sim.run"}}
    assert sorted(path.relative_to(ROOT).as_posix() for path in know) == []


def test_the_package_needs_no_tests_and_no_test_runner() -> None:
    unwanted = ("tests", "pytest", "hypothesis", "psutil", "matplotlib")
    code = (
        f"import importlib, sys\nfor name in {MODULES!r}: importlib.import_module(name)\n"
        f"print([name for name in {unwanted!r} if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment(), capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"


def test_all_that_is_public_is_there_on_first_use() -> None:
    assert all(getattr(troupe.testing, name) for name in troupe.testing.__all__)
    assert sorted(troupe.testing.__all__) == troupe.testing.__all__
    with pytest.raises(AttributeError):
        _ = troupe.testing.nothing
