"""What the tests share: small worlds with controllers of their own."""

from __future__ import annotations

import gc
import signal
import textwrap
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# A machine may be slow: that is no failure, neither of one example nor of making them.
settings.register_profile("patient", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("patient")

# Tests that are run in the background of a script have Ctrl-C ignored, and so would have every
# process that they start.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_finish() -> None:
    """What is loaded lives to the end: no test's garbage is looked for in it."""
    gc.collect()
    gc.freeze()


WORLD = """\
size: [10, 10]
duration: {duration}
until: {until}
models:
  rover:
    body: {{shape: box, size: [1, 1]}}
    sensors: [{{type: laser, samples: 36}}]
robots:
  - {{name: one, model: rover, pose: [2, 5, 0], controller: mine}}
  - {{name: two, model: rover, pose: [5, 5, 90], controller: other}}
controllers:
  mine: {{program: ./mine.py}}
  other: {{program: wander}}
"""


@pytest.fixture
def world_with(tmp_path: Path) -> Callable[..., Path]:
    """A world of two robots: one driven by the given program, the other wandering."""

    def make(program: str, *, duration: float = 3.0, until: str = "duration") -> Path:
        (tmp_path / "mine.py").write_text(textwrap.dedent(program))
        path = tmp_path / "world.yaml"
        path.write_text(WORLD.format(duration=duration, until=until))
        return path

    return make
