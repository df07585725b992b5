"""Runs of small worlds in a thread of the test's own process, which plays their clients."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

from sim.engine import Engine
from troupe.testing import Lockstep

World = Callable[..., Path]
"""What the fixture `world` gives: it writes a world file."""


class Serving(Lockstep):
    """A served run whose engine is looked at as well: for tests of how it serves, of no others.

    `now` is the wall clock by which it is held to real time.
    """

    def __init__(self, path: Path, *, now: Callable[[], float] | None = None, **told: Any) -> None:
        self.now = now
        super().__init__(path, **told)

    def _prepare(self) -> None:
        if self.now is not None:
            self.engine.pace.now = self.now
            self.engine.pace.begin()

    @property
    def engine(self) -> Engine:
        """What the run does its ticks with."""
        return self.simulation._engine


def write_world(folder: Path, world: str) -> Path:
    """A world file of that text."""
    path = folder / "world.yaml"
    path.write_text(textwrap.dedent(world))
    return path
