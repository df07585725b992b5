"""The paint layer shows the floor as it is, however it came about."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.video.paint import STRENGTH, PaintLayer
from sim.video.palette import TINTS, bgr
from sim.video.projection import project

SIZE = (160, 120)


def layer(world: tuple[float, float], walls: np.ndarray | None = None) -> PaintLayer:
    ground = np.full((SIZE[1], SIZE[0], 3), 240, np.uint8)
    ground[::7] = 200  # lines that must shine through
    if walls is None:
        walls = np.zeros(ground.shape[:2], bool)
    return PaintLayer(ground, walls, project(world, [], SIZE))


def expected(painted: PaintLayer, cells: np.ndarray, resolution: float) -> np.ndarray:
    """Pixel by pixel: the tint of the cell under the pixel's centre."""
    p = painted._projection
    image = painted._ground.copy()
    for v in range(p.height):
        row = int(np.floor((p.bottom - v - 0.5) / p.scale / resolution))
        for u in range(p.width):
            column = int(np.floor((u + 0.5 - p.left) / p.scale / resolution))
            if not (0 <= row < cells.shape[0] and 0 <= column < cells.shape[1]):
                continue
            if cells[row, column] and not painted._walls[v, u]:
                color = np.array(bgr(TINTS[(cells[row, column] - 1) % len(TINTS)]))
                mixed = image[v, u] * (1 - STRENGTH) + color * STRENGTH
                image[v, u] = np.rint(mixed)
    return image


@pytest.mark.parametrize("resolution", [0.5, 0.13, 0.05, 0.01])  # many pixels to many cells
def test_every_pixel_has_the_tint_of_the_cell_under_its_centre(resolution: float) -> None:
    world = (4.0, 2.5)
    painted = layer(world)
    shape = (round(world[1] / resolution), round(world[0] / resolution))
    cells = np.random.default_rng(3).integers(0, 12, shape).astype(np.int16)
    painted.update(cells, resolution)
    wanted = expected(painted, cells, resolution)
    # Mixtures of whole numbers that end in .5 may be rounded either way.
    assert np.abs(painted.image.astype(int) - wanted.astype(int)).max() <= 1


@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.25, 0.05, 0.013]))
def test_many_small_changes_look_like_one_large_one(seed: int, resolution: float) -> None:
    rng = np.random.default_rng(seed)
    world = (4.0, 2.5)
    shape = (round(world[1] / resolution), round(world[0] / resolution))
    cells = np.zeros(shape, np.int16)
    step_by_step, at_once = layer(world), layer(world)
    for _ in range(5):
        row, column = rng.integers(0, shape[0]), rng.integers(0, shape[1])
        cells[row : row + 9, column : column + 9] = rng.integers(0, 20)
        step_by_step.update(cells, resolution)
    at_once.update(cells, resolution)
    assert (step_by_step.image == at_once.image).all()


def test_paint_that_goes_away_leaves_bare_ground() -> None:
    painted = layer((4, 2.5))
    cells = np.full((10, 16), 3, np.int16)
    painted.update(cells, 0.25)
    assert (painted.image != painted._ground).any()
    painted.update(np.zeros_like(cells), 0.25)
    assert (painted.image == painted._ground).all()


def test_paint_never_covers_a_wall() -> None:
    walls = np.zeros((SIZE[1], SIZE[0]), bool)
    walls[40:60, 50:70] = True
    painted = layer((4, 2.5), walls)
    painted.update(np.ones((50, 80), np.int16), 0.05)
    assert (painted.image[walls] == painted._ground[walls]).all()
    assert (painted.image[30, 60] != painted._ground[30, 60]).any()


def test_another_floor_starts_anew() -> None:
    painted, fresh = layer((4, 2.5)), layer((4, 2.5))
    painted.update(np.ones((10, 16), np.int16), 0.25)
    cells = np.zeros((50, 80), np.int16)
    cells[5, 5] = 2
    painted.update(cells, 0.05)
    fresh.update(cells, 0.05)
    assert (painted.image == fresh.image).all()
