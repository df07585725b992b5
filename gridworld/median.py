"""The best door: the cell with the least sum of distances to all cells (end of section 3.1)."""

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from gridworld.compiled import compiled
from gridworld.regions import Cell, Region, RegionError
from gridworld.topology import distances, first_hole

_MOST_CELLS_WITH_HOLES = 20_000


def best_door(region: Region) -> Cell:
    """The geometric median of a connected region: (column, row), the first in reading order.

    With the door there, total travel is the least of all doors. Raises RegionError for a region
    with holes and more than 20,000 cells, whose search would take too long.
    """
    sums = sums_of_distances(region.free)
    best = int(np.argmin(np.where(region.free, sums, np.iinfo(np.int64).max)))
    row, column = divmod(best, region.columns)
    return column, row


def sums_of_distances(free: NDArray[np.bool_]) -> NDArray[np.int64]:
    """For every cell the sum of distances to all cells, (rows, columns); 0 in walls.

    In a simply connected region a shortest path makes as few vertical steps as any path does, and
    as few horizontal ones. Vertical steps are counted on the tree of the horizontal runs of cells,
    horizontal steps on that of the vertical runs. So the work grows as the number of cells. With
    holes the runs form no tree, and every cell is searched from on its own.
    """
    if first_hole(free)[0] is None:
        horizontal, vertical = _run_sums(free), _run_sums(np.ascontiguousarray(free.T)).T
        return np.ascontiguousarray(np.where(free, horizontal + vertical, 0))
    if np.count_nonzero(free) > _MOST_CELLS_WITH_HOLES:
        raise RegionError("the best door of so large a region with holes takes too long to find")
    sums = np.zeros(free.shape, np.int64)
    for row, column in np.argwhere(free):
        distance = distances(free, [(int(column), int(row))])
        sums[row, column] = distance[distance > 0].sum(dtype=np.int64)
    return sums


def _run_sums(free: NDArray[np.bool_]) -> NDArray[np.int64]:
    """For every cell the sum over all cells of the vertical steps between, for runs in a tree."""
    rows, columns = free.shape
    starts = free.copy()
    starts[:, 1:] &= ~free[:, :-1]
    run = np.cumsum(starts.ravel()).reshape(rows, columns) - 1  # of every free cell
    weight = np.bincount(run[free])
    touching = free[:-1] & free[1:]
    pairs = np.stack([run[:-1][touching], run[1:][touching]], axis=1)
    pairs = np.unique(pairs, axis=0)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    both = both[np.argsort(both[:, 0], kind="stable")]
    first = np.searchsorted(both[:, 0], np.arange(weight.size + 1))
    neighbours = np.ascontiguousarray(both[:, 1])
    sums = _tree_sums(weight.astype(np.int64), first.astype(np.int64), neighbours.astype(np.int64))
    result: NDArray[np.int64] = sums[np.where(free, run, 0)]
    return result


def _weighted_tree_sums(
    weight: NDArray[np.int64], first: NDArray[np.int64], neighbours: NDArray[np.int64]
) -> NDArray[np.int64]:
    """For every node of a tree the sum of weight x distance over all nodes.

    The neighbours of node i are neighbours[first[i]:first[i + 1]]. Node 0's sum by a search from
    it; then from parent to child: one nearer to what is below the child, one farther from the rest.
    """
    n = weight.size
    order = np.empty(n, np.int64)
    parent = np.full(n, -1, np.int64)
    depth = np.zeros(n, np.int64)
    order[0] = 0
    tail = 1
    for head in range(n):
        node = order[head]
        for index in range(first[node], first[node + 1]):
            neighbour = neighbours[index]
            if neighbour != parent[node]:
                parent[neighbour] = node
                depth[neighbour] = depth[node] + 1
                order[tail] = neighbour
                tail += 1
    below = weight.copy()
    sums = np.zeros(n, np.int64)
    for place in range(n - 1, 0, -1):
        node = order[place]
        below[parent[node]] += below[node]
        sums[0] += weight[node] * depth[node]
    for place in range(1, n):
        node = order[place]
        sums[node] = sums[parent[node]] + below[0] - 2 * below[node]
    return sums


_i8 = numba.types.Array(numba.int64, 1, "C")
_tree_sums: Any = compiled(_i8(_i8, _i8, _i8), _weighted_tree_sums)
