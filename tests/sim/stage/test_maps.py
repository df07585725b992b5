"""Maps of either kind: merged blocks and merged outlines equal the pixels."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from stage_worlds import world

from sim.stage.layout import build_layout
from sim.stage.raster import Raster, merged_outlines, merged_rectangles, rectangles_in_world
from sim.stage.textmap import parse_text_map
from sim.worldfile.mistakes import WorldError

WALLS = arrays(np.bool_, array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=12))


@given(walls=WALLS)
def test_blocks_cover_exactly_the_walls_and_none_twice(walls: np.ndarray) -> None:
    times = np.zeros(walls.shape, dtype=int)
    for left, top, right, bottom in merged_rectangles(walls):
        times[top:bottom, left:right] += 1
    assert np.array_equal(times, walls.astype(int))


@given(walls=WALLS, cell=st.sampled_from([0.05, 1.0, 1.5]))
def test_blocks_in_the_world_have_row_0_at_the_top(walls: np.ndarray, cell: float) -> None:
    raster = Raster(walls, cell)
    rows, columns = walls.shape
    blocks = np.array(rectangles_in_world(raster)).reshape(-1, 4)
    for row in range(rows):
        for column in range(columns):
            x, y = raster.centre(column, row)
            assert raster.at(x, y) == (column, row)
            assert y == pytest.approx((rows - 1 - row + 0.5) * cell)
            inside = (blocks[:, 0] < x) & (x < blocks[:, 2]) & (blocks[:, 1] < y)
            assert np.count_nonzero(inside & (y < blocks[:, 3])) == walls[row, column]
            assert raster.is_wall([[x, y]])[0] == walls[row, column]


def pixel_edges(walls: np.ndarray) -> set[tuple[tuple[int, int], tuple[int, int]]]:
    """Unit edges between wall and free pixels, by asking each pixel's four neighbours."""
    rows, columns = walls.shape
    edges = set()
    for row in range(rows):
        for column in range(columns):
            if not walls[row, column]:
                continue
            x, y = column, rows - 1 - row
            around = {
                (-1, 0): ((x, y), (x, y + 1)),
                (1, 0): ((x + 1, y), (x + 1, y + 1)),
                (0, 1): ((x, y), (x + 1, y)),
                (0, -1): ((x, y + 1), (x + 1, y + 1)),
            }
            for (dx, dy), edge in around.items():
                near_column, near_row = column + dx, row + dy
                on = 0 <= near_column < columns and 0 <= near_row < rows
                if not (on and walls[near_row, near_column]):
                    edges.add(edge)
    return edges


@given(walls=WALLS)
def test_outlines_are_the_edges_of_the_pixels_merged(walls: np.ndarray) -> None:
    found = []
    for x1, y1, x2, y2 in merged_outlines(Raster(walls, 1.0)):
        steps = round(abs(x2 - x1) + abs(y2 - y1))
        assert steps >= 1
        dx, dy = np.sign(x2 - x1), np.sign(y2 - y1)
        assert abs(dx) + abs(dy) == 1
        for k in range(steps):
            ends = sorted([(x1 + k * dx, y1 + k * dy), (x1 + (k + 1) * dx, y1 + (k + 1) * dy)])
            found.append(tuple((int(x), int(y)) for x, y in ends))
    assert len(found) == len(set(found))
    assert set(found) == pixel_edges(walls)


def test_a_straight_wall_is_one_segment_on_each_side() -> None:
    walls = np.zeros((5, 40), dtype=bool)
    walls[2, 3:33] = True
    assert len(merged_outlines(Raster(walls, 0.1))) == 4
    assert len(merged_rectangles(walls)) == 1


def test_a_text_map_is_read_as_one_reads_it() -> None:
    read = parse_text_map("#.S\r\n..#\n\n", "maze.txt")
    assert read.walls.tolist() == [[True, False, False], [False, False, True]]
    assert read.doors == ((2, 0),)


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("###\n#x#\n##y", [(2, 2), (3, 3)]),
        ("###\n##\n####", [(2, 3), (3, 4)]),
        ("", [(1, 1)]),
        ("\n\n", [(1, 1)]),
    ],
)
def test_mistakes_in_a_text_map_have_their_line_and_column(
    text: str, places: list[tuple[int, int]]
) -> None:
    with pytest.raises(WorldError) as caught:
        parse_text_map(text, "maze.txt")
    assert [(m.line, m.column) for m in caught.value.mistakes] == places
    assert all(m.file == "maze.txt" for m in caught.value.mistakes)


@settings(max_examples=20)
@given(walls=WALLS)
def test_an_image_map_is_its_dark_pixels(walls: np.ndarray, tmp_path_factory: object) -> None:
    folder = tmp_path_factory.mktemp("map")  # type: ignore[attr-defined]
    shades = np.where(walls, 127, 128).astype(np.uint8)
    cv2.imwrite(str(folder / "cave.png"), shades)
    made = world(size=(2.0, 2.0), map={"file": "cave.png", "resolution": 0.1}, boundary=None)
    layout = build_layout(made, folder)
    assert layout.raster is not None
    assert np.array_equal(layout.raster.walls, walls)
    assert layout.grid is None
    rows, columns = walls.shape
    centres = [
        ((c + 0.5) * 0.1, (rows - r - 0.5) * 0.1) for r in range(rows) for c in range(columns)
    ]
    assert np.array_equal(layout.inside(centres), ~walls.ravel())


@pytest.mark.parametrize("channels", [3, 4])
def test_colours_and_transparency_are_brightness_and_freedom(tmp_path: Path, channels: int) -> None:
    pixels = np.zeros((1, 4, channels), dtype=np.uint8)
    pixels[0, :, :3] = [(0, 0, 0), (255, 255, 255), (0, 255, 255), (255, 0, 0)]
    if channels == 4:
        pixels[0, :, 3] = (255, 255, 255, 0)
    cv2.imwrite(str(tmp_path / "cave.png"), pixels)
    made = world(map={"file": "cave.png", "resolution": 1.0})
    raster = build_layout(made, tmp_path).raster
    assert raster is not None
    # black; white; yellow, which is bright; blue, which is dark, or is not there at all
    assert raster.walls[0].tolist() == [True, False, False, channels == 3]


def test_maps_that_cannot_be_read_are_told(tmp_path: Path) -> None:
    (tmp_path / "none.png").write_text("no picture")
    (tmp_path / "binary.txt").write_bytes(b"\xff\xfe\x00")
    for entry, what in [
        ({"file": "gone.png", "resolution": 0.1}, "cannot be read"),
        ({"file": "none.png", "resolution": 0.1}, "not an image"),
        ({"file": "gone.txt", "cell": 1.0}, "cannot be read"),
        ({"file": "binary.txt", "cell": 1.0}, "not a text"),
    ]:
        with pytest.raises(WorldError, match=what) as caught:
            build_layout(world(map=entry), tmp_path)
        assert caught.value.mistakes[0].where == ("map", "file")


def test_an_image_larger_than_its_world_is_a_mistake(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "cave.png"), np.zeros((50, 101), dtype=np.uint8))
    made = world(map={"file": "cave.png", "resolution": 0.1}, size=(10.0, 5.0))
    with pytest.raises(WorldError, match="does not fit the map"):
        build_layout(made, tmp_path)
