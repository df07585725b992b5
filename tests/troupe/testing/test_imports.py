"""Scripts and the package itself do without the tests, and without what tests alone need."""

from __future__ import annotations

import ast
import pkgutil
import subprocess
import sys

import pytest

import troupe.testing
from tests.processes import ROOT, environment

SCRIPTS = sorted((ROOT / "scripts").glob("*.py"))
MODULES = [
    one.name for one in pkgutil.walk_packages(troupe.testing.__path__, "troupe.testing.")
]  # fmt: skip


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_no_script_imports_tests(script) -> None:
    imported = set()
    for node in ast.walk(ast.parse(script.read_text())):
        if isinstance(node, ast.Import):
            imported |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            imported.add(node.module)
    assert not [name for name in imported if name.partition(".")[0] == "tests"]


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
