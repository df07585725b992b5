"""The folder is on the path, for `watching`."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from watching import STILL


@pytest.fixture
def still(tmp_path: Path) -> Path:
    """A world in which nothing happens by itself."""
    path = tmp_path / "still.yaml"
    path.write_text(STILL)
    return path
