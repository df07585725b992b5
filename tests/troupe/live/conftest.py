"""The folder is on the path, for `watching`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from browsing import Page, chromium
from watching import STILL, Watched, watched


@pytest.fixture
def still(tmp_path: Path) -> Path:
    """A world in which nothing happens by itself."""
    path = tmp_path / "still.yaml"
    path.write_text(STILL)
    return path


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """A headless Chromium."""
    with chromium() as found:
        yield found


@pytest.fixture
def run(still: Path) -> Iterator[Watched]:
    """A run of that world, which stands at its beginning."""
    with watched(still, paused=True, realtime=20) as run:
        yield run


@pytest.fixture
def page(browser: Any, run: Watched) -> Iterator[Page]:
    """A browser's page at it."""
    context = browser.new_context(viewport={"width": 1100, "height": 720})
    yield Page(context.new_page(), run.address)
    context.close()
