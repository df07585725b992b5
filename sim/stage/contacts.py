"""Who touches whom: counts how often robots began to touch, and where they touch now.

Chipmunk tells a contact of two edges by the two ends of what they share. A touching stretch is
the straight line between the two, and a single point where something round or a corner touches.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.stage.compiled import compiled

Indices = NDArray[np.int64]
Floats = NDArray[np.float64]
NO_STRETCHES = np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros((0, 2))
_FACTOR = 2**32
_HALF = 2**31


class Touches:
    """The contacts of robots, gathered over the steps of a tick.

    Things are numbered: movers first (`first` movable obstacles, then the robots in order),
    and what stands by negative numbers. A pair counts once when it touches in a tick and did
    not in the tick before: letting go and touching again within a tick is no new contact.
    """

    def __init__(self, first: int) -> None:
        self._first = first
        self._found: list[tuple[NDArray[np.uintp], Floats, Indices]] = []
        self._ids: Indices = np.zeros(0, dtype=np.int64)
        self._things: Indices = np.zeros(0, dtype=np.int64)
        self._keys: Indices = np.zeros(0, dtype=np.int64)
        self.unfelt: set[int] = set()
        """Things whose touch no bumper feels: they make no stretches."""
        self.robots: Indices = np.zeros(0, dtype=np.int64)
        """(k,) The robot of each contact point of the latest tick, ascending."""
        self.points: Floats = np.zeros((0, 2))
        """(k, 2) The points in the world."""
        self.stretches: tuple[Indices, Floats, Floats] = NO_STRETCHES
        """(m,) The robot of each touching stretch of the latest tick, ascending, and (m, 2), (m, 2)
        where on the robot's own outline it begins and ends, in the world."""

    def rename(self, ids: Indices, things: Indices) -> None:
        """Set which body id (b,) ascending is which thing (b,)."""
        self._ids, self._things = ids, things

    def add(self, pairs: NDArray[np.uintp], points: Floats, ends: Indices) -> None:
        """Add what touches after some steps, as `ContactTable` tells it.

        pairs (k, 3), points (k, 2, 2, 2), ends (s,): the row at which each step's contacts end.
        """
        self._found.append((pairs, points, ends))

    def finish(self, counts: Indices) -> None:
        """End the tick: counts (n,) goes up by one per pair that began to touch in it."""
        if not self._found:
            if len(self._keys):
                self._keys = np.zeros(0, dtype=np.int64)
                self.robots, self.points = np.zeros(0, dtype=np.int64), np.zeros((0, 2))
                self.stretches = NO_STRETCHES
            return
        pairs, points, ends = self._found[0]
        for more, their_points, their_ends in self._found[1:]:
            ends = np.concatenate([ends, len(pairs) + their_ends])
            pairs = np.concatenate([pairs, more])
            points = np.concatenate([points, their_points])
        self._found.clear()
        self._keys, self.robots, self.points, self.stretches = _gather(
            pairs, points, ends, self._ids, self._things, self._first, self._keys, counts,
            np.array(sorted(self.unfelt), dtype=np.int64),
        )  # fmt: skip

    @property
    def pairs(self) -> tuple[Indices, Indices]:
        """Robots (k,) and the things (k,) that they touched in the latest tick."""
        return self._keys // _FACTOR, self._keys % _FACTOR - _HALF


@compiled
def _gather(
    pairs: Any,
    points: Any,
    ends: Any,
    ids: Any,
    things: Any,
    first: int,
    before: Any,
    counts: Any,
    unfelt: Any,
) -> Any:
    """The tick's touching pairs as sorted keys, their points and their stretches, both sorted.

    ends (s,): where each step's rows end. before: the keys of the tick before. A pair's points
    are those of the last step in which it touched. counts goes up per pair that is new.
    unfelt (u,) ascending: things of which there are no stretches.
    """
    rows = np.empty(2 * len(pairs), dtype=np.int64)
    keys = np.empty(2 * len(pairs), dtype=np.int64)
    sides = np.empty(2 * len(pairs), dtype=np.int64)
    found = 0
    for row in range(len(pairs)):
        if pairs[row, 2] == 0:
            continue
        one = things[np.searchsorted(ids, np.int64(pairs[row, 0]))]
        two = things[np.searchsorted(ids, np.int64(pairs[row, 1]))]
        if one >= first:
            keys[found], rows[found] = (one - first) * _FACTOR + two + _HALF, row
            sides[found] = 0
            found += 1
        if two >= first:
            keys[found], rows[found] = (two - first) * _FACTOR + one + _HALF, row
            sides[found] = 1
            found += 1
    keys, rows = keys[:found], rows[:found]
    touching = np.unique(keys)
    last = np.zeros(len(touching), dtype=np.int64)
    for k in range(found):
        at = np.searchsorted(touching, keys[k])
        last[at] = max(last[at], np.searchsorted(ends, rows[k], side="right"))
    places = np.empty((2 * found, 3))
    stretches = np.empty((found, 5))
    shown, touched = 0, 0
    for k in range(found):
        row = rows[k]
        at = np.searchsorted(touching, keys[k])
        if np.searchsorted(ends, row, side="right") < last[at]:
            continue
        robot, other = keys[k] // _FACTOR, 1 if pairs[row, 2] > 1 else 0
        for c in range(other + 1):
            places[shown, 0] = robot
            for axis in range(2):
                places[shown, 1 + axis] = (points[row, c, 0, axis] + points[row, c, 1, axis]) / 2.0
            shown += 1
        if len(unfelt) > 0:
            thing = keys[k] % _FACTOR - _HALF
            at = np.searchsorted(unfelt, thing)
            if at < len(unfelt) and unfelt[at] == thing:
                continue
        start, end = points[row, 0, sides[k]], points[row, other, sides[k]]
        if end[0] < start[0] or (end[0] == start[0] and end[1] < start[1]):
            start, end = end, start
        stretches[touched, 0] = robot
        stretches[touched, 1:3] = start
        stretches[touched, 3:5] = end
        touched += 1
    for k in range(len(touching)):
        at = np.searchsorted(before, touching[k])
        if at == len(before) or before[at] != touching[k]:
            counts[touching[k] // _FACTOR] += 1
    places, stretches = _sorted(places[:shown]), _sorted(stretches[:touched])
    return (
        touching,
        places[:, 0].astype(np.int64),
        places[:, 1:].copy(),
        (stretches[:, 0].astype(np.int64), stretches[:, 1:3].copy(), stretches[:, 3:].copy()),
    )


@compiled
def _sorted(rows: Any) -> Any:
    """Rows (n, k) by their first number, and where those are equal by the next, and so on."""
    found = rows[np.argsort(rows[:, 0], kind="mergesort")]
    for i in range(1, len(found)):
        row = found[i].copy()
        j = i
        while j > 0:
            column = 0
            while column < len(row) - 1 and found[j - 1, column] == row[column]:
                column += 1
            if found[j - 1, column] <= row[column]:
                break
            found[j] = found[j - 1]
            j -= 1
        found[j] = row
    return found
