"""Maps, their mistakes, connectedness and holes, generators, and the best door."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from gridworld import generators
from gridworld.median import best_door, sums_of_distances
from gridworld.regions import Region, RegionError, load, parse, rectangle
from gridworld.topology import FAR, distances, first_hole, first_unreached

SHAPES = st.tuples(st.integers(1, 9), st.integers(1, 9))
CELLS = SHAPES.flatmap(lambda shape: arrays(np.bool_, shape))


def test_a_map_is_read_as_one_reads_it():
    region = parse("#.S\n..#\n", "m.txt")
    assert region.free.tolist() == [[False, True, True], [True, True, False]]
    assert region.doors == ((2, 0),)
    assert (region.columns, region.rows, region.cells) == (3, 2, 4)


@given(CELLS)
def test_a_map_written_is_the_map_read(free):
    assume(free.any())
    assert (parse(Region(free).to_text()).free == free).all()


@given(st.text(alphabet="#.S x\n\r\t", max_size=60))
def test_any_text_is_a_region_or_a_clear_mistake(text):
    lines = text.replace("\r\n", "\n").rstrip(" \n\r\t").split("\n")
    good = len({len(line) for line in lines}) == 1 and set("".join(lines)) <= set("#.S")
    if good and set(text) & set(".S") and not set(text) & set(" \r\t"):
        assert parse(text, "m.txt").cells == text.count(".") + text.count("S")
    elif not good or not set(text) & set(".S"):
        with pytest.raises(RegionError, match=r"^m\.txt:1?"):
            parse(text, "m.txt")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "m.txt:1:1: the map is empty"),
        ("\n\n", "m.txt:1:1: the map is empty"),
        ("##\n##\n", "m.txt:1:1: the map has no free cell"),
        ("...\n..\n", "m.txt:2:3: the map is ragged: this line has 2 cells, the first has 3"),
        ("...\n....\n", "m.txt:2:4: the map is ragged: this line has 4 cells, the first has 3"),
        (".x.\n", "m.txt:1:2: 'x' is not allowed (# is a wall, . is free, S is a door)"),
    ],
)
def test_a_bad_map_says_where_and_what(text, message):
    with pytest.raises(RegionError) as caught:
        parse(text, "m.txt")
    assert str(caught.value) == message


def test_all_mistakes_are_told_at_once_but_not_hundreds():
    with pytest.raises(RegionError) as caught:
        parse("?.?\n..\n" + "?" * 500, "m.txt")
    lines = str(caught.value).splitlines()
    assert lines[0].startswith("m.txt:1:1:")
    assert lines[1].startswith("m.txt:1:3:")
    assert lines[2].startswith("m.txt:2:3:")
    assert lines[-1] == "m.txt: and 494 more mistakes"
    assert len(lines) == 11


def test_a_file_that_is_no_text_is_a_mistake(tmp_path):
    path = tmp_path / "map.png"
    path.write_bytes(b"\x89PNG\xff")
    with pytest.raises(RegionError, match="not a text file"):
        load(path)


@pytest.mark.parametrize("door", [(0, 0), (3, 0), (0, -1), (-1, 0), (0, 2)])
def test_a_door_must_be_a_free_cell(door):
    with pytest.raises(RegionError, match="door"):
        parse("#..\n...\n").with_doors([door])


def test_two_doors_must_differ():
    with pytest.raises(RegionError, match="twice"):
        rectangle(3, 3, [(1, 1), (1, 1)])


def test_a_part_that_cannot_be_reached_is_named():
    with pytest.raises(RegionError) as caught:
        parse("S.#.\n..##\n###.\n", "m.txt").check()
    assert "m.txt:1:4: the region is not connected: 2 free cells" in str(caught.value)


def test_the_hole_is_named():
    with pytest.raises(RegionError) as caught:
        parse("....\n.##.\n....\n", "m.txt").check()
    assert "m.txt:2:2: the region is not simply connected" in str(caught.value)
    assert "2 wall cells at column 1, row 1" in str(caught.value)
    parse("....\n.##.\n....\n").check(holes=True)


def test_walls_that_touch_diagonally_close_a_gap():
    parse("...#\n..#.\n....\n").check()  # joined to the outside by a corner
    with pytest.raises(RegionError, match="not connected"):
        parse(".#.\n#..\n...\n").check()


@given(CELLS)
def test_holes_are_those_that_eulers_formula_counts(free):
    # A connected region is simply connected if cells - adjacent pairs + blocks of four is one.
    assume(free.any() and first_unreached(free)[0] is None)
    pairs = (free[1:] & free[:-1]).sum() + (free[:, 1:] & free[:, :-1]).sum()
    blocks = (free[1:, 1:] & free[1:, :-1] & free[:-1, 1:] & free[:-1, :-1]).sum()
    assert (first_hole(free)[0] is None) == (free.sum() - pairs + blocks == 1)


@given(CELLS, st.data())
def test_distances_are_the_least_over_neighbours_plus_one(free, data):
    assume(free.any())
    cells = [(int(c), int(r)) for r, c in np.argwhere(free)]
    doors = data.draw(st.lists(st.sampled_from(cells), min_size=1, max_size=3, unique=True))
    found = distances(free, doors)
    assert (found[~free] == FAR).all()
    for column, row in cells:
        if (column, row) in doors:
            assert found[row, column] == 0
            continue
        around = [(column + 1, row), (column - 1, row), (column, row + 1), (column, row - 1)]
        near = [found[r, c] for c, r in around if (c, r) in cells and found[r, c] != FAR]
        assert found[row, column] == (min(near) + 1 if near else FAR)


@pytest.mark.parametrize("kind", generators.KINDS)
def test_every_kind_of_random_region_is_simply_connected(kind):
    for seed in range(60):
        rng = np.random.default_rng(seed)
        generators.random_region(kind, rng, 2 + seed % 20).check()


def test_grown_regions_have_walls_that_touch_only_diagonally():
    region = generators.random_region("branching", np.random.default_rng(0), 15)
    free = region.free
    assert (free[1:, 1:] & free[:-1, :-1] & ~free[1:, :-1] & ~free[:-1, 1:]).any()


def test_the_same_seed_makes_the_same_region():
    for kind in generators.KINDS:
        one, two = (generators.random_region(kind, np.random.default_rng(4)) for _ in "12")
        assert one.to_text() == two.to_text()


def test_a_spiral_is_one_corridor():
    free = generators.spiral(9).free
    grid = np.pad(free, 1).astype(int)
    neighbours = sum(np.roll(grid, shift, axis) for shift in (1, -1) for axis in (0, 1))
    inside = neighbours[np.pad(free, 1)]
    assert (inside == 1).sum() == 2  # its ends
    assert (inside <= 2).all()


def test_the_ring_and_the_comb_with_a_loop_have_one_hole():
    assert first_hole(generators.ring(7, 6, 2).free) == ((2, 2), 6)
    assert first_hole(generators.comb(5).free)[0] is not None
    generators.comb(None).check()


def test_the_comb_has_the_papers_measures():
    region = generators.comb(7, sight=2)  # r = 2: 20 columns, 4 apart, 120 high, bottom row 80
    assert region.free[-1].sum() == 80
    heights = region.free[1:, ::4].sum(axis=0)
    assert heights.tolist() == [121 if k in (1, 7) else 120 for k in range(1, 21)]
    assert region.doors == ((0, region.rows - 1),)


def test_polyominoes_are_as_many_as_are_known():
    # Fixed polyominoes, https://oeis.org/A001168
    known = [1, 2, 6, 19, 63, 216, 760, 2725]
    for size, count in enumerate(known, 1):
        shapes = {(shape.shape, shape.tobytes()) for shape in generators.polyominoes(size)}
        assert len(shapes) == count


@settings(max_examples=40)
@given(st.sampled_from(sorted(generators.KINDS)), st.integers(0, 10**6), st.integers(1, 12))
def test_sums_of_distances_from_runs_are_those_from_searches(kind, seed, size):
    region = generators.random_region(kind, np.random.default_rng(seed), size)
    sums = sums_of_distances(region.free)
    for row, column in np.argwhere(region.free):
        found = distances(region.free, [(int(column), int(row))])
        assert sums[row, column] == found[region.free].sum()
    column, row = best_door(region)
    assert sums[row, column] == sums[region.free].min()


def test_sums_of_distances_hold_with_a_hole_too():
    region = generators.ring(6, 5)
    sums = sums_of_distances(region.free)
    # A loop of 18 cells: 2 * (1 + ... + 8) + 9 from anywhere.
    assert (sums[region.free] == 81).all()


def test_the_best_door_of_a_square_is_its_middle():
    assert best_door(rectangle(31, 31)) == (15, 15)
