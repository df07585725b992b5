"""The paint layer: who painted what, how much of the floor, how often."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stage_worlds import world

from sim.stage.floor import FloorPaint
from sim.stage.layout import build_layout
from sim.stage.stage import Stage


def floor(resolution: float = 0.05, **keys: Any) -> FloorPaint:
    return FloorPaint(build_layout(world(size=(4.0, 3.0), **keys), Path()), resolution)


def spray(paint: FloorPaint, ways: Any, size: Any = (1.0, 1.0), offset: Any = (0.0, 0.0)) -> None:
    """One tick of sprayers 0, 1, ... on robots 0, 1, ...; a way is a pose, or several in turn."""
    poses = np.array(ways, dtype=float)
    poses = poses[:, None] if poses.ndim == 2 else poses
    count = len(poses)
    numbers = np.arange(count)
    paint.spray(
        numbers,
        numbers,
        poses.reshape(count, poses.shape[1] if count else 1, 3),
        np.tile(np.array(size, dtype=float), (count, 1)),
        np.tile(np.array(offset, dtype=float), (count, 1)),
    )


def centres(paint: FloorPaint) -> np.ndarray:
    """The cells' centres as complex numbers."""
    rows, columns = paint.owner.shape
    x, y = np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
    return (x + 1j * y) * paint.resolution


def depth_in(cells: np.ndarray, poses: np.ndarray, size: Any, offset: Any) -> np.ndarray:
    """(poses, cells) How deep cells lie in a sprayer at each pose; below 0 outside of it."""
    at = poses[:, 0] + 1j * poses[:, 1]
    z = (cells[None] - at[:, None]) * np.exp(-1j * poses[:, 2])[:, None] - complex(*offset)
    return np.minimum(size[0] / 2 - abs(z.real), size[1] / 2 - abs(z.imag))


def finely(way: Any, parts: int = 500) -> np.ndarray:
    """The poses of an even motion from each pose of a way to the next, in so many parts each."""
    way = np.array(way, dtype=float)
    steps = np.arange(len(way)) * parts
    fine = np.arange(steps[-1] + 1)
    return np.stack([np.interp(fine, steps, way[:, axis]) for axis in range(3)], axis=1)


def doubtful(depth: np.ndarray, margin: float) -> np.ndarray:
    """(cells,) Which only touch the edge somewhere on the way: by how much is below `margin`."""
    turns = (np.diff(depth[:-1], axis=0) * np.diff(depth[1:], axis=0)) <= 0
    return ((abs(depth[1:-1]) < margin) & turns).any(axis=0) | (abs(depth[[0, -1]]) < margin).any(0)


step = st.tuples(st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-0.4, 0.4))
leap = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-4.0, 4.0))
straight = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.just(0.0))


@settings(max_examples=60)
@given(
    moves=st.lists(st.one_of(step, leap, straight), min_size=1, max_size=5),
    size=st.tuples(st.floats(0.06, 1.2), st.floats(0.06, 1.2)),
    offset=st.tuples(st.floats(-0.5, 0.5), st.floats(-0.3, 0.3)),
    heading=st.floats(-3.0, 3.0),
    ticks=st.booleans(),
)
def test_paint_and_passes_are_those_of_a_sweep_in_the_finest_steps(
    moves: Any, size: Any, offset: Any, heading: float, ticks: bool
) -> None:
    paint = floor(0.1)
    way = np.cumsum([(2.0, 1.5, heading), *moves], axis=0)
    for tick in [way[i : i + 2] for i in range(len(moves))] if ticks else [way]:
        spray(paint, [tick], size, offset)
    cells = centres(paint).ravel()
    poses = finely(way)
    depth = depth_in(cells, poses, size, offset)
    under = depth >= 0
    visits = under[0].astype(int) + (under[1:] & ~under[:-1]).sum(axis=0)
    # Between two fine poses an edge may come nearer by what the sprayer moves in half of a step.
    reach = math.hypot(abs(offset[0]) + size[0] / 2, abs(offset[1]) + size[1] / 2)
    moved = np.hypot(*np.diff(poses[:, :2], axis=0).T) + abs(np.diff(poses[:, 2])) * reach
    sure = ~doubtful(depth, moved.max() / 2 + 1e-4)
    assert sure.mean() > 0.9
    assert np.array_equal(paint.visits.ravel()[sure], visits[sure])
    assert np.array_equal(paint.owner.ravel()[sure] == 1, visits[sure] > 0)
    painted = np.count_nonzero(paint.owner)
    assert np.array_equal(paint.visits > 0, paint.owner == 1)
    assert paint.coverage == pytest.approx(painted / (40 * 30))
    assert paint.painted_area == pytest.approx(painted * 0.1**2)
    assert paint.passes == pytest.approx(paint.visits.sum() / max(1, painted))


def drive(interval: float, seconds: float, twist: Any, sprayer: Any, **clock: Any) -> FloorPaint:
    """The floor of 10 x 10 m under a robot that drives so from the middle, its sprayer on."""
    actuator = {"type": "sprayer", **sprayer}
    model = {
        "body": {"shape": "circle", "radius": 0.2},
        "drive": {"kind": "omnidirectional", "max_speed": 5, "max_turn_rate": 3600},
        "actuators": (actuator,),
    }
    made = world(models={"r": model}, clock={"interval": interval, **clock})
    layout = build_layout(made, Path())
    stage, paint = Stage(layout, made.models, made.clock), FloorPaint(layout, 0.05)
    robot = stage.add_robot("r", (5.0, 5.0, 0.0))
    mount = made.models["r"].actuators[0]
    for _ in range(round(seconds / interval)):
        stage.command([robot], [twist])
        which = np.array([robot])
        ways = stage.tick(which)
        paint.spray(which, which, ways, np.array([mount.size]), np.array([mount.offset]))
    return paint


@pytest.mark.parametrize("interval", [0.02, 0.1, 0.5, 5.0])
def test_a_sprayer_that_turns_on_the_spot_paints_its_disc_at_any_interval(interval: float) -> None:
    paint = drive(interval, 10.0, (0.0, 0.0, math.pi / 2), {"size": (4.0, 0.1)})
    far = abs(centres(paint) - complex(5.0, 5.0))
    disc = math.hypot(2.0, 0.05)
    # The body's place wanders by less than 1e-6 m; a cut bends by a thousandth of a cell.
    sure = abs(far - disc) > 1e-4
    assert np.array_equal(paint.owner[sure] == 1, far[sure] < disc)
    assert paint.painted_area == pytest.approx(math.pi * disc**2, rel=0.01)


@pytest.mark.parametrize("turn_rate", [1.0, 30.0])
def test_a_sprayer_off_the_middle_paints_a_ring(turn_rate: float) -> None:
    sprayer = {"size": (0.2, 0.3), "offset": (1.0, 0.0)}
    paint = drive(0.5, 10.0, (0.0, 0.0, turn_rate), sprayer)
    far = abs(centres(paint) - complex(5.0, 5.0))
    inner, outer = 0.9, math.hypot(1.1, 0.15)
    sure = (abs(far - inner) > 1e-4) & (abs(far - outer) > 1e-4)
    assert np.array_equal(paint.owner[sure] == 1, (inner < far[sure]) & (far[sure] < outer))


def test_the_interval_does_not_change_what_a_motion_paints() -> None:
    """The physics are the same, step by step, however many of them make an interval."""
    floors = [
        drive(interval, 3.0, (0.7, 0.2, 1.9), {"size": (0.4, 0.8), "offset": (0.3, 0.1)})
        for interval in (0.02, 0.1, 0.5, 3.0)
    ]
    for other in floors[1:]:
        # Where a way is cut depends on the ticks: a centre on the very edge may go either way.
        assert np.count_nonzero(other.owner != floors[0].owner) <= 1
        assert np.count_nonzero(other.visits != floors[0].visits) <= 1


def test_a_robot_that_is_lifted_paints_nothing_between_its_places() -> None:
    paint = floor()
    spray(paint, [(1.0, 1.5, 0.0)], (0.2, 0.2))
    spray(paint, [(3.0, 1.5, 0.0)], (0.2, 0.2))
    assert np.count_nonzero(paint.owner) == 2 * 16


def test_a_sprayer_paints_from_where_it_was_turned_on() -> None:
    paint = floor()
    spray(paint, [[(1.0, 1.5, 0.0), (3.0, 1.5, 0.0)]], (0.2, 0.2))
    assert (paint.owner[29, 18:62] == 1).all()
    assert (paint.visits[29, 18:62] == 1).all()


def test_a_sprayer_that_is_away_within_a_tick_and_back_is_a_second_pass() -> None:
    paint = floor()
    spray(paint, [[(1.0, 1.5, 0.0), (2.2, 1.5, 0.0), (1.0, 1.5, 0.0)]])
    assert paint.visits[30, 20] == 2


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
    spray(paint, [[(0.5, 1.5, 0.0), (3.5, 1.5, 0.0)]], (0.2, 0.2))
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
