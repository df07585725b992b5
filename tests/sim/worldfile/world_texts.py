"""What the tests of world files share: writing one, loading it, and the mistakes it has."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.build import load
from sim.worldfile import WorldError

HEAD = """\
size: [10, 8]
models:
  rover:
    body: {shape: circle, radius: 0.3}
"""
"""A world without robots, in four lines: what a test appends begins in line 5."""


def mistakes_of(path: Path, *settings: str) -> list[str]:
    """The mistakes of a file as they are told, without the file's name."""
    with pytest.raises(WorldError) as raised:
        load(path, settings=settings)
    return [str(mistake).removeprefix(f"{path}:") for mistake in raised.value.mistakes]


def mistakes_in(tmp_path: Path, text: str) -> list[str]:
    """The mistakes of a text as a world file, without the file's name."""
    path = tmp_path / "world.yaml"
    path.write_text(text, encoding="utf-8")
    return mistakes_of(path)
