"""The paint layer: who painted what, how much of the floor, how often."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stage_worlds import world

from sim.stage.floor import FloorPaint
from sim.stage.layout import build_layout


def floor(resolution: float = 0.05, **keys: Any) -> FloorPaint:
    return FloorPaint(build_layout(world(size=(4.0, 3.0), **keys), Path()), resolution)


def spray(paint: FloorPaint, poses: Any, size: Any = (1.0, 1.0), offset: Any = (0.0, 0.0)) -> None:
    """One tick of sprayers 0, 1, ... on robots 0, 1, ..."""
    count = len(poses)
    numbers = np.arange(count)
    paint.spray(
        numbers,
        numbers,
        np.array(poses, dtype=float).reshape(-1, 3),
        np.tile(np.array(size, dtype=float), (count, 1)),
        np.tile(np.array(offset, dtype=float), (count, 1)),
    )


def under(paint: FloorPaint, pose: Any, size: Any, offset: Any = (0.0, 0.0)) -> np.ndarray:
    """Which cells' centres lie under a sprayer: the truth, on all cells at once."""
    rows, columns = paint.owner.shape
    x, y = np.meshgrid(
        (np.arange(columns) + 0.5) * paint.resolution, (np.arange(rows) + 0.5) * paint.resolution
    )
    z = ((x - pose[0]) + 1j * (y - pose[1])) * np.exp(-1j * pose[2]) - complex(*offset)
    return (abs(z.real) <= size[0] / 2 + 1e-9) & (abs(z.imag) <= size[1] / 2 + 1e-9)


@settings(max_examples=30)
@given(
    way=st.lists(
        st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-0.2, 0.2)),
        min_size=1,
        max_size=12,
    ),
    size=st.tuples(st.floats(0.4, 1.2), st.floats(0.4, 1.2)),
    offset=st.tuples(st.floats(-0.5, 0.5), st.floats(-0.3, 0.3)),
)
def test_coverage_and_passes_equal_what_counting_all_cells_gives(
    way: Any, size: Any, offset: Any
) -> None:
    # Steps are shorter than half of the sprayer, so that no stamp lies between two ticks.
    paint = floor()
    poses = np.cumsum([(2.0, 1.5, 0.3), *way], axis=0)
    visits = np.zeros(paint.owner.shape, dtype=int)
    before = np.zeros(paint.owner.shape, dtype=bool)
    for pose in poses:
        spray(paint, [pose], size, offset)
        now = under(paint, pose, size, offset)
        visits += now & ~before
        before = now
    painted = visits > 0
    assert np.array_equal(paint.owner == 1, painted)
    assert np.array_equal(paint.visits, visits)
    assert paint.coverage == pytest.approx(painted.sum() / (80 * 60))
    assert paint.painted_area == pytest.approx(painted.sum() * 0.05**2)
    assert paint.passes == pytest.approx(visits.sum() / painted.sum())


def test_a_sprayer_that_comes_back_is_a_second_pass() -> None:
    paint = floor()
    for x in (1.0, 2.2, 1.0):
        spray(paint, [(x, 1.5, 0.0)])
    assert paint.visits.max() == 2
    spray(paint, [(1.0, 1.5, 0.0)])
    assert paint.visits.max() == 2  # to stay is no pass


def test_a_sprayer_that_was_off_begins_a_new_pass() -> None:
    paint = floor()
    spray(paint, [(1.0, 1.5, 0.0)])
    spray(paint, [])
    spray(paint, [(1.0, 1.5, 0.0)])
    assert paint.passes == 2.0


def test_a_fast_sprayer_leaves_no_gap() -> None:
    paint = floor()
    spray(paint, [(0.5, 1.5, 0.0)], (0.2, 0.2))
    spray(paint, [(3.5, 1.5, 0.0)], (0.2, 0.2))
    middle = paint.owner[29, :]
    assert (middle[9:71] == 1).all()
    assert paint.passes == 1.0


def test_the_last_painter_owns_a_cell() -> None:
    paint = floor()
    spray(paint, [(1.0, 1.5, 0.0), (1.5, 1.5, 0.0)])
    assert paint.owner[30, 12] == 1
    assert paint.owner[30, 25] == 2
    assert set(np.unique(paint.owner)) == {0, 1, 2}


def test_nothing_is_painted_off_the_region_or_under_obstacles() -> None:
    region = ((0.0, 0.0), (2.0, 0.0), (2.0, 3.0), (0.0, 3.0))
    box = {"shape": "box", "size": (0.5, 0.5), "pose": (1.0, 1.5, 0)}
    paint = floor(region=region, obstacles=[box])
    assert paint.coverage == 0.0
    spray(paint, [(2.0, 1.5, 0.0)], (4.0, 3.0))
    assert paint.coverage == 1.0
    assert paint.painted_area == pytest.approx(2.0 * 3.0 - 0.25)
    assert paint.passes == 1.0


def test_row_0_lies_at_y_0() -> None:
    paint = floor()
    spray(paint, [(0.5, 0.25, 0.0)], (0.2, 0.2))
    rows, columns = np.nonzero(paint.owner)
    assert (rows.min(), rows.max()) == (3, 6)
    assert (columns.min(), columns.max()) == (8, 11)
