"""The folder is on the path, for `watching`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from browsing import CHROMIUM
from watching import STILL

from tests.patience import PATIENCE


@pytest.fixture
def still(tmp_path: Path) -> Path:
    """A world in which nothing happens by itself."""
    path = tmp_path / "still.yaml"
    path.write_text(STILL)
    return path


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A headless Chromium."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with playwright.sync_playwright() as driver:
        found = driver.chromium.launch(
            executable_path=CHROMIUM,
            args=["--no-sandbox", "--disable-dev-shm-usage"],
            timeout=1000 * PATIENCE,
        )
        yield found
        found.close()
