"""A run is never longer than its duration, and what it says of its start is a pose like any."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import troupe

WORLD = """\
size: [10, 10]
clock: {{interval: {interval!r}}}
until: duration
models: {{r: {{body: {{shape: circle, radius: 0.3}}}}}}
robots:
  - {{name: a, model: r, pose: [5, 5, {heading!r}]}}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("duration")


def run(
    folder: Path, duration: float, interval: float = 0.1, heading: float = 0.0
) -> troupe.Result:
    path = folder / "world.yaml"
    path.write_text(WORLD.format(interval=interval, heading=heading))
    return troupe.run(path, duration=duration)


@pytest.mark.parametrize(
    ("duration", "interval", "ticks"),
    [
        (0.25, 0.1, 2),
        (0.3, 0.1, 3),  # 3 * 0.1 is above 0.3 in doubles
        (0.7, 0.1, 7),  # 0.7 / 0.1 is below 7
        (1.0, 0.3, 3),
        (5.0, 5.0, 1),
        (7.0, 5.0, 1),
        (0.05, 0.1, 0),
    ],
)
def test_a_run_ends_with_the_last_whole_interval_within_its_duration(
    folder: Path, duration: float, interval: float, ticks: int
) -> None:
    result = run(folder, duration, interval)
    assert result.ticks == ticks
    assert result.sim_time == pytest.approx(ticks * interval, abs=1e-9)
    assert result.outcome == "completed"


@settings(max_examples=20, deadline=None)
@given(duration=st.floats(0.01, 5.0), interval=st.floats(0.05, 1.0))
def test_no_run_is_longer_than_its_duration(folder: Path, duration: float, interval: float) -> None:
    result = run(folder, duration, interval)
    # A billionth of a second is what the sum of intervals in doubles may be off.
    assert result.sim_time <= duration + 1e-9
    assert result.sim_time > duration - interval - 1e-9


@pytest.mark.parametrize(
    ("heading", "wrapped"),
    [(0.0, 0.0), (270.0, -90.0), (-180.0, 180.0), (180.0, 180.0), (540.0, 180.0), (-350.0, 10.0)],
)
def test_the_starts_heading_in_a_result_is_wrapped(
    folder: Path, heading: float, wrapped: float
) -> None:
    robot = run(folder, 0.1, heading=heading).robots[0]
    assert robot.start == pytest.approx((5.0, 5.0, math.radians(wrapped)))
    assert -math.pi < robot.start[2] <= math.pi
    assert robot.start == pytest.approx(robot.pose)
