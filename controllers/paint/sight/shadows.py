"""Where robots that are not followed could be: the shadows of what was seen so far.

A grid over the region marks every place at which the centre of an unseen robot may be. A look
clears what it shows to be free, and time lets the rest spread at the speed of a robot. A place is
cleared if a body there would have been hit by a ray, or would overlap a body seen; all are cleared
once all robots are in view.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..constants import BODY, HALF
from ..geometry import Floats, Region
from .scan import Scan

CELL = 0.25
_HALF_DIAGONAL = CELL / math.sqrt(2.0)

FINE = 1500
"""Of no more cells than this each quarter is looked at by itself, which clears more of them."""

_QUARTERS = CELL / 4.0 * np.array([[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]])

Mask = NDArray[np.bool_]


class Shadows:
    """The places where an unseen robot's centre may be, on a grid in the own frame.

    `possible` (rows, columns): row 0 is the lowest. `speed` is the most that a robot drives, m/s.
    As long as its rank is open, nobody crosses its row, at first y = 0 (`on_row`): who is above
    stays above. So cells end at y = 0, and nothing spreads over the row.
    """

    def __init__(self, region: Region, speed: float, time: float = 0.0) -> None:
        low = np.array([region.left + HALF, region.bottom + HALF])  # centres are inside of these
        span = np.array([region.right - HALF, region.top - HALF]) - low
        columns = max(1, math.ceil(span[0] / CELL - 1e-6))
        low[0] -= 0.5 * (columns * CELL - span[0])
        self.own_row = max(0, math.ceil(-low[1] / CELL - 1e-6))
        low[1] = -self.own_row * CELL
        self._zero = -float(self.own_row)
        rows = self.own_row + max(1, math.ceil((region.top - HALF) / CELL - 1e-6))
        self.on_row = True
        self.x: Floats = np.arange(0.5, columns) * CELL + low[0]
        self.y: Floats = np.arange(0.5, rows) * CELL + low[1]
        grid_x, grid_y = np.meshgrid(self.x, self.y)
        centres = np.stack([grid_x.ravel(), grid_y.ravel()], axis=1)
        depth = region.depth(centres).reshape(rows, columns)
        self.standable: Mask = depth + _HALF_DIAGONAL >= HALF
        quarters = (centres[:, None, :] + _QUARTERS).reshape(-1, 2)
        narrow = region.depth(quarters) < HALF - _HALF_DIAGONAL / 2
        self._narrow: Mask = narrow.reshape(rows, columns, len(_QUARTERS))
        self.possible: Mask = self.standable.copy()
        self._spread_for = CELL / speed  # s in which a robot drives through a cell
        self._spread_at = time - time % self._spread_for
        self._diagonal = False

    def clear(self) -> None:
        """Nobody is unseen."""
        self.possible[:] = False

    def move_row(self, y: float) -> None:
        """The own row is now at another height, and the way there was free over all its breadth."""
        level = y / CELL - self._zero
        row = math.floor(level) if level > self.own_row else math.ceil(level)
        row = min(max(row, 0), len(self.y))
        if abs(row - level) < 1.0 and row != self.own_row:
            self.possible[min(row, self.own_row) : max(row, self.own_row)] = False
            self.own_row = row

    def spread(self, time: float) -> None:
        """Let who may be there drive on, until `time`; ahead of time by up to one cell."""
        parts = (slice(0, self.own_row), slice(self.own_row, None))
        while self._spread_at <= time:
            self._spread_at += self._spread_for
            self._diagonal = not self._diagonal
            for part in parts if self.on_row else (slice(None),):
                self.possible[part] = _grown(self.possible[part], self._diagonal)
            self.possible &= self.standable

    def look(self, scan: Scan) -> None:
        """Clear all places where a body would have been hit by a ray of the scan."""
        rows, columns = np.nonzero(self.possible)
        x, y = self.x[columns], self.y[rows]
        ahead = np.flatnonzero(_in_view(scan, x, y, BODY))
        gone = ahead[seen_free(scan, x[ahead], y[ahead], _HALF_DIAGONAL)]
        self.possible[rows[gone], columns[gone]] = False
        if 0 < rows.size - gone.size <= FINE:
            self._look_closely(scan)

    def _look_closely(self, scan: Scan) -> None:
        """Clear the places of which each quarter is seen to be free, or no body has room in it."""
        rows, columns = np.nonzero(self.possible)
        free = self._narrow[rows, columns]
        ahead = _in_view(scan, self.x[columns], self.y[rows], BODY + CELL)
        open_ = np.flatnonzero(~free & ahead[:, None])
        cell, quarter = np.divmod(open_, len(_QUARTERS))
        x = self.x[columns[cell]] + _QUARTERS[quarter, 0]
        y = self.y[rows[cell]] + _QUARTERS[quarter, 1]
        free.reshape(-1)[open_] = seen_free(scan, x, y, _HALF_DIAGONAL / 2)
        gone = free[:, 0] & free[:, 1] & free[:, 2] & free[:, 3]
        self.possible[rows[gone], columns[gone]] = False

    def exclude(self, x: float, y: float, radius: float) -> None:
        """No unseen robot's centre is within `radius` of a point (a body is known to be there)."""
        self._near(x, y, radius - _HALF_DIAGONAL, False)

    def admit(self, x: float, y: float, radius: float, above: bool | None = None) -> None:
        """An unseen robot's centre may be within `radius` of a point, above (below) the row."""
        self._near(x, y, radius + _HALF_DIAGONAL, True, above if self.on_row else None)

    def _near(
        self, x: float, y: float, radius: float, value: bool, above: bool | None = None
    ) -> None:
        if radius <= 0.0:
            return
        j0, j1 = np.searchsorted(self.x, (x - radius, x + radius))
        i0, i1 = (int(i) for i in np.searchsorted(self.y, (y - radius, y + radius)))
        if above is not None:
            i0, i1 = (max(i0, self.own_row), i1) if above else (i0, min(i1, self.own_row))
        if i0 >= i1:
            return
        dx, dy = self.x[j0:j1] - x, self.y[i0:i1] - y
        near = dx[None, :] ** 2 + dy[:, None] ** 2 < radius * radius
        part = self.possible[i0:i1, j0:j1]
        part[near] = value
        if value:
            part &= self.standable[i0:i1, j0:j1]

    def room_above(self, y: float) -> int:
        """At most how many unseen robots can have their centres above (or at) a height."""
        first = self.own_row if self.on_row else int(np.searchsorted(self.y + CELL / 2, y))
        return self._room(first, len(self.y))

    def room_below(self, y: float) -> int:
        """At most how many unseen robots can have their centres below (or at) a height."""
        above = np.searchsorted(self.y - CELL / 2, y, side="right")
        return self._room(0, self.own_row if self.on_row else int(above))

    def _room(self, first: int, last: int) -> int:
        # Two centres are at least a body apart, and no tile of 2 x 2 cells holds two such points.
        part = self.possible[first:last]
        lone = first % 2  # its tile begins below
        return _tiles(part[:lone]) + _tiles(part[lone:])

    def nearest_height(self, y: float, upwards: bool) -> float:
        """The nearest height above (below) y at which an unseen robot may be; infinite if none."""
        rows = np.flatnonzero(self.possible.any(axis=1))
        if upwards:
            rows = rows[self.y[rows] + CELL / 2 > y]
            return max(y, float(self.y[rows[0]] - CELL / 2)) if rows.size else math.inf
        rows = rows[self.y[rows] - CELL / 2 < y]
        return min(y, float(self.y[rows[-1]] + CELL / 2)) if rows.size else -math.inf

    def any_in(self, left: float, right: float, bottom: float, top: float) -> bool:
        """Whether an unseen robot's centre may lie in a rectangle."""
        j0 = int(np.searchsorted(self.x + CELL / 2, left, side="right"))
        j1 = int(np.searchsorted(self.x - CELL / 2, right))
        i0 = int(np.searchsorted(self.y + CELL / 2, bottom, side="right"))
        i1 = int(np.searchsorted(self.y - CELL / 2, top))
        return bool(self.possible[i0:i1, j0:j1].any())

    def places(self) -> Floats:
        """The centres (n, 2) of the cells where an unseen robot may be."""
        rows, columns = np.nonzero(self.possible)
        return np.stack([self.x[columns], self.y[rows]], axis=1)


def _tiles(p: Mask) -> int:
    """How many tiles of 2 x 2 cells, from the first row and column on, have a marked cell."""
    rows = p[::2].copy()
    rows[: len(p) // 2] |= p[1::2]
    tiles = rows[:, ::2].copy()
    tiles[:, : p.shape[1] // 2] |= rows[:, 1::2]
    return int(np.count_nonzero(tiles))


def _grown(p: Mask, diagonal: bool) -> Mask:
    """What is marked and its neighbours, on every other call those at the corners as well."""
    grown = p.copy()
    grown[1:] |= p[:-1]
    grown[:-1] |= p[1:]
    wide = grown if diagonal else p
    sides = grown.copy()
    sides[:, 1:] |= wide[:, :-1]
    sides[:, :-1] |= wide[:, 1:]
    return sides


def _in_view(scan: Scan, x: Floats, y: Floats, within: float) -> Mask:
    """Whether places (n,) are ahead of the scan's sensor, or less than `within` (m) behind it."""
    if max(-scan.bearings[0], scan.bearings[-1]) > math.pi / 2 + 1e-6:
        return np.ones(len(x), bool)  # it looks back as well
    cos, sin = math.cos(scan.pose.yaw), math.sin(scan.pose.yaw)
    ahead: Mask = (x - scan.pose.x) * cos + (y - scan.pose.y) * sin > -within
    return ahead


def seen_free(scan: Scan, x: Floats, y: Floats, around: float) -> Mask:
    """Whether no robot's centre can be within `around` (m) of places (n,), by one scan.

    A ray that passes the place nearer than half a body, less `around`, and goes on beyond it, would
    have hit a body whose centre was there.
    """
    dx, dy = x - scan.pose.x, y - scan.pose.y
    distance = np.hypot(dx, dy)
    bearing = np.arctan2(dy, dx) - scan.pose.yaw
    bearing = np.remainder(bearing + math.pi, math.tau) - math.pi
    reach = np.arcsin(np.minimum((HALF - around) / np.maximum(distance, HALF), 1.0))
    first_bearing, count = float(scan.bearings[0]), len(scan.ranges)
    step = (float(scan.bearings[-1]) - first_bearing) / (count - 1)
    first = np.ceil((bearing - reach - first_bearing) / step).astype(int)
    last = np.floor((bearing + reach - first_bearing) / step).astype(int)
    first, last = np.maximum(first, 0), np.minimum(last, count - 1)
    covered = first <= last
    farthest = _range_maximum(scan, first[covered], last[covered])
    free: Mask = distance < BODY - around  # the own body is there
    free[covered] |= farthest > distance[covered] + around + 0.02
    return free


_DISC = np.concatenate(
    [
        [[0.0, 0.0]],
        *(
            r * np.stack([np.cos(a), np.sin(a)], axis=1)
            for r, n in ((0.35, 6), (0.7, 12), (1.0, 18))
            for a in [np.arange(n) * math.tau / n]
        ),
    ]
)


def refuted(scan: Scan, region: Region, places: Floats, radii: Floats) -> Mask:
    """Whether a scan shows that no robot is within `radii` (n,) of places (n, 2), m: (n,).

    37 points of each are looked at, those where a body has room.
    """
    points = (places[:, None, :] + _DISC[None, :, :] * radii[:, None, None]).reshape(-1, 2)
    free = region.depth(points) < HALF
    ahead = np.flatnonzero(~free)
    free[ahead] = seen_free(scan, points[ahead, 0], points[ahead, 1], 0.1)
    all_free: Mask = np.logical_and.reduce(free.reshape(len(places), -1), axis=1)
    return all_free


def _range_maximum(scan: Scan, first: NDArray[np.intp], last: NDArray[np.intp]) -> Floats:
    """The largest range within each run of rays first..last (inclusive)."""
    level = np.frexp((last - first + 1).astype(float))[1] - 1
    table = scan.maxima
    maxima: Floats = np.maximum(table[level, first], table[level, last - (1 << level) + 1])
    return maxima
