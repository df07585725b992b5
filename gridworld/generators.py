"""Regions by construction: grown, eroded, mazes, rooms, spirals, combs, rings, small polyominoes.

All but `ring`, `comb` with a loop, and what is said to be otherwise are simply connected. Random
ones draw from the generator they are given and nothing else.
"""

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from gridworld.regions import Cell, Region

# The eight neighbours clockwise from up, as (row, column): sides at even places.
_AROUND = ((-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1))


def grown(
    columns: int, rows: int, cells: int, rng: np.random.Generator, branching: bool = False
) -> Region:
    """A shape of `cells` cells (fewer if it gets stuck), grown from the middle one cell at a time.

    A cell is added if that makes no hole. Walls that touch only diagonally are common, and most so
    if `branching`: then a cell is added only where it has one free neighbour.
    """
    free = np.zeros((rows + 2, columns + 2), np.bool_)
    start = (rows // 2 + 1, columns // 2 + 1)
    free[start] = True
    border = _sides(start)
    size = 1
    while border and size < min(cells, columns * rows):
        choice = int(rng.integers(len(border)))
        border[choice], border[-1] = border[-1], border[choice]
        cell = border.pop()
        inside = 1 <= cell[0] <= rows and 1 <= cell[1] <= columns
        if inside and not free[cell] and _is_simple(free, cell):
            if branching and sum(bool(free[side]) for side in _sides(cell)) > 1:
                continue
            free[cell] = True
            size += 1
            border.extend(_sides(cell))
    return _cropped(free)


def eroded(columns: int, rows: int, share: float, rng: np.random.Generator) -> Region:
    """A rectangle from which walls have eaten their way in: about `share` of it is left.

    A free cell at a wall becomes wall if the region stays connected and without holes.
    """
    free = np.zeros((rows + 2, columns + 2), np.bool_)
    free[1:-1, 1:-1] = True
    cells = [(row, column) for row in range(1, rows + 1) for column in range(1, columns + 1)]
    left = len(cells)
    for _ in range(4):  # what could not go in one round may go in a later one
        for index in rng.permutation(len(cells)):
            if left <= max(1.0, share * len(cells)):
                break
            cell = cells[index]
            if free[cell] and _is_simple(free, cell):
                free[cell] = False
                left -= 1
    return _cropped(free)


def maze(columns: int, rows: int, rng: np.random.Generator) -> Region:
    """A maze of `columns` x `rows` junctions: corridors of width 1 that form a random tree."""
    free = np.zeros((2 * rows - 1, 2 * columns - 1), np.bool_)
    start = (2 * int(rng.integers(rows)), 2 * int(rng.integers(columns)))
    free[start] = True
    trail = [start]
    while trail:
        row, column = trail[-1]
        ways = [
            (row + 2 * dr, column + 2 * dc)
            for dr, dc in _AROUND[::2]
            if 0 <= row + 2 * dr < free.shape[0]
            and 0 <= column + 2 * dc < free.shape[1]
            and not free[row + 2 * dr, column + 2 * dc]
        ]
        if not ways:
            trail.pop()
            continue
        way = ways[int(rng.integers(len(ways)))]
        free[way] = free[(row + way[0]) // 2, (column + way[1]) // 2] = True
        trail.append(way)
    return Region(free)


def rooms(columns: int, rows: int, rng: np.random.Generator, smallest: int = 3) -> Region:
    """A rectangle that walls divide again and again into rooms, each wall with one gap.

    Rooms measure at least `smallest` cells either way.
    """
    free = np.ones((rows, columns), np.bool_)
    undivided = [(0, 0, rows, columns)]
    while undivided:
        top, left, height, width = undivided.pop()
        across = height > width or (height == width and bool(rng.integers(2)))
        length = height if across else width
        places = list(range(smallest, length - smallest))
        # A wall must not end at a gap of the walls around: that would seal the gap.
        start, end = (left - 1, left + width) if across else (top - 1, top + height)
        places = [
            p for p in places if _closed(free, across, (top if across else left) + p, start, end)
        ]
        if not places:
            continue
        place = places[int(rng.integers(len(places)))]
        gap = int(rng.integers(width if across else height))
        if across:
            free[top + place, left : left + width] = False
            free[top + place, left + gap] = True
            undivided.append((top, left, place, width))
            undivided.append((top + place + 1, left, height - place - 1, width))
        else:
            free[top : top + height, left + place] = False
            free[top + gap, left + place] = True
            undivided.append((top, left, height, place))
            undivided.append((top, left + place + 1, height, width - place - 1))
    return Region(free)


def spiral(size: int) -> Region:
    """A corridor of width 1 that winds clockwise from the top left into a square of `size`."""
    free = np.zeros((size + 2, size + 2), np.bool_)
    row, column, heading = 1, 1, 1  # of the four sides in _AROUND[::2]
    free[row, column] = True
    turned = 0
    while turned < 2:
        dr, dc = _AROUND[::2][heading]
        ahead, beyond = (row + dr, column + dc), (row + 2 * dr, column + 2 * dc)
        inside = 1 <= ahead[0] <= size and 1 <= ahead[1] <= size
        if inside and not free[ahead] and not free[beyond]:
            row, column = ahead
            free[ahead] = True
            turned = 0
        else:
            heading = (heading + 1) % 4
            turned += 1
    return _cropped(free)


def ring(columns: int, rows: int, thickness: int = 1) -> Region:
    """A frame around one rectangular hole, as in figure 7: not simply connected."""
    free = np.ones((rows, columns), np.bool_)
    free[thickness:-thickness, thickness:-thickness] = False
    return Region(free)


def comb(k: int | None, sight: int = 2) -> Region:
    """G(k) of section 3.3 for robots that see `sight` cells far, with its door at the bottom left.

    A bottom row of 20 r^2 cells; 10 r columns of width 1 and height 30 r^2, 2 r apart; the first
    column and column `k` (from 2 to 10 r) are one higher and meet a top row. For `k` None only
    the first meets it, and the comb is simply connected.
    """
    count, apart, height = 10 * sight, 2 * sight, 30 * sight**2
    if k is not None and not 2 <= k <= count:
        raise ValueError(f"k is {k}: it must be from 2 to {count}")
    free = np.zeros((height + 2, 20 * sight**2), np.bool_)
    free[-1, :] = True  # the bottom row
    free[1:-1, ::apart] = True
    free[1, ::apart] = False  # the height of the others is one less
    free[1, 0] = True
    free[0, : apart * (count - 1) + 1] = True  # the top row
    if k is not None:
        free[1, apart * (k - 1)] = True
    return Region(free, ((0, height + 1),))


def polyominoes(cells: int) -> Iterator[NDArray[np.bool_]]:
    """Every polyomino of `cells` cells, up to translation, as a bool array in its bounding box.

    Redelmeier's method ("Counting polyominoes: yet another attack", 1981). Those with holes too.
    """
    # Cells above row 0, or left of column 0 in it, are out of bounds: the origin is the first
    # cell in reading order.
    untried: list[Cell] = [(0, 0)]
    known = {(0, 0)}
    shape: list[Cell] = []

    def extend(untried: list[Cell]) -> Iterator[NDArray[np.bool_]]:
        while untried:
            cell = untried.pop()
            shape.append(cell)
            if len(shape) == cells:
                yield _drawn(shape)
            else:
                column, row = cell
                new = [
                    (c, r)
                    for c, r in (
                        (column, row - 1),
                        (column + 1, row),
                        (column, row + 1),
                        (column - 1, row),
                    )
                    if (c, r) not in known and (r > 0 or (r == 0 and c >= 0))
                ]
                known.update(new)
                yield from extend(untried + new)
                known.difference_update(new)
            shape.pop()

    return extend(untried)


def random_region(kind: str, rng: np.random.Generator, size: int = 12) -> Region:
    """A simply connected region of a kind from KINDS, about `size` x `size`, door at random."""
    region = KINDS[kind](size, rng)
    free = np.argwhere(region.free)
    row, column = free[int(rng.integers(len(free)))]
    return region.with_doors([(int(column), int(row))])


KINDS: Mapping[str, Callable[[int, np.random.Generator], Region]] = {
    "grown": lambda size, rng: grown(size, size, max(1, size * size * 2 // 3), rng),
    "eroded": lambda size, rng: eroded(size, size, 0.6, rng),
    "branching": lambda size, rng: grown(size, size, size * size, rng, branching=True),
    "maze": lambda size, rng: maze((size + 1) // 2, (size + 1) // 2, rng),
    "rooms": lambda size, rng: rooms(size, size, rng, smallest=2),
}
"""Kinds of random simply connected regions."""


def _is_simple(free: NDArray[np.bool_], cell: tuple[int, int]) -> bool:
    """Whether adding or removing `cell` keeps the region connected and without holes.

    So it is if the free cells among its eight neighbours that touch its sides hang together
    there (one run of free cells with a side in it), and one of its sides is wall.
    """
    row, column = cell
    around = [bool(free[row + dr, column + dc]) for dr, dc in _AROUND]
    if all(around[::2]):
        return False
    runs = 0
    for side in (0, 2, 4, 6):
        # A side opens a run unless the run goes on from the side before it.
        if around[side] and not (around[side - 1] and around[side - 2]):
            runs += 1
    return runs == 1


def _sides(cell: tuple[int, int]) -> list[tuple[int, int]]:
    return [(cell[0] + dr, cell[1] + dc) for dr, dc in _AROUND[::2]]


def _closed(free: NDArray[np.bool_], across: bool, place: int, start: int, end: int) -> bool:
    """Whether a dividing wall at `place` would meet closed walls at `start` and at `end`."""
    line = free[place] if across else free[:, place]
    return all(not 0 <= stop < line.size or not line[stop] for stop in (start, end))


def _cropped(free: NDArray[np.bool_]) -> Region:
    rows = np.flatnonzero(free.any(axis=1))
    columns = np.flatnonzero(free.any(axis=0))
    return Region(np.ascontiguousarray(free[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]))


def _drawn(shape: list[Cell]) -> NDArray[np.bool_]:
    cells = np.array(shape)
    cells -= cells.min(axis=0)
    free = np.zeros(cells.max(axis=0)[::-1] + 1, np.bool_)
    free[cells[:, 1], cells[:, 0]] = True
    return free
