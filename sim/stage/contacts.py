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
Stretches = tuple[Indices, Floats, Floats]
NO_POINTS = np.zeros(0, dtype=np.int64), np.zeros((0, 2))
NO_STRETCHES: Stretches = np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros((0, 2))
NOTHING = np.zeros(0, dtype=np.int64)
_FACTOR = 2**32
_HALF = 2**31


class Touches:
    """The contacts of robots, gathered over the steps of a tick.

    Things are numbered: movers first (`first` movable obstacles, then the robots in order),
    and what stands by negative numbers. A pair counts once when it touches in a tick and did
    not in the tick before: letting go and touching again within a tick is no new contact.

    Who touches whom is known after each tick; where they do is found when it is asked for.
    """

    def __init__(self, first: int) -> None:
        self._first = first
        self._found: list[Floats] = []  # contacts, as `steps.run_steps` tells them
        self._latest: Floats | None = None  # those of the latest tick
        self._places: tuple[tuple[Indices, Floats], Stretches] | None = None
        self._ids: Indices = np.zeros(0, dtype=np.int64)
        self._things: Indices = np.zeros(0, dtype=np.int64)
        self._keys: Indices = np.zeros(16, dtype=np.int64)  # with room for more
        self._before: Indices = np.zeros(16, dtype=np.int64)
        self._touching = 0  # how many keys there are
        self.unfelt: set[int] = set()
        """Things whose touch no bumper feels: they make no stretches."""

    def rename(self, ids: Indices, things: Indices) -> None:
        """Set which body id (b,) ascending is which thing (b,)."""
        self._ids, self._things = ids, things

    def add(self, contacts: Floats) -> None:
        """Add the contacts (t, CONTACT) of some substeps, at least one: see `steps`."""
        if self._found:  # substeps are counted from 0 again
            contacts[:, -1] += self._found[-1][-1, -1] + 1
        self._found.append(contacts)

    def finish(self, counts: Indices) -> None:
        """End the tick: counts (n,) goes up by one per pair that began to touch in it."""
        if not self._found:
            if self._touching:
                self._touching, self._latest, self._places = 0, None, None
            return
        found = self._found
        self._latest = found[0] if len(found) == 1 else np.concatenate(found)
        self._found, self._places = [], None
        self._keys, self._before = self._before, self._keys
        if len(self._keys) < 2 * len(self._latest):
            self._keys = np.zeros(4 * len(self._latest), dtype=np.int64)
        self._touching = _count_pairs(
            self._latest, self._ids, self._things, self._first,
            self._before, self._touching, self._keys, counts,
        )  # fmt: skip

    @property
    def pairs(self) -> tuple[Indices, Indices]:
        """Robots (k,) and the things (k,) that they touched in the latest tick."""
        keys = self._keys[: self._touching]
        return keys // _FACTOR, keys % _FACTOR - _HALF

    @property
    def points(self) -> tuple[Indices, Floats]:
        """(k,) The robot of each contact point of the latest tick, ascending, and (k, 2) points."""
        return self._located()[0]

    def points_of(self, robots: Indices) -> tuple[Indices, Floats]:
        """Those points of some robots (r,) alone: quicker where these are few."""
        if self._latest is None:
            return NO_POINTS
        contacts = _involving(self._latest, self._ids, self._things, self._first + robots)
        found, points, _ = _locate(
            contacts, self._ids, self._things, self._first, self._keys[: self._touching], NOTHING
        )
        own = np.isin(found, robots)
        return found[own], points[own]

    @property
    def stretches(self) -> Stretches:
        """(m,) The robot of each touching stretch of the latest tick, ascending, and (m, 2), (m, 2)
        where on the robot's own outline it begins and ends, in the world."""
        return self._located()[1]

    def _located(self) -> tuple[tuple[Indices, Floats], Stretches]:
        if self._latest is None:
            return NO_POINTS, NO_STRETCHES
        if self._places is None:
            robots, points, stretches = _locate(
                self._latest, self._ids, self._things, self._first,
                self._keys[: self._touching], np.array(sorted(self.unfelt), dtype=np.int64),
            )  # fmt: skip
            self._places = (robots, points), stretches
        return self._places


@compiled
def _key(robot: int, thing: int) -> int:
    """One number for a robot that touches a thing."""
    return robot * _FACTOR + thing + _HALF


@compiled
def _count_pairs(
    contacts: Any,
    ids: Any,
    things: Any,
    first: int,
    before: Any,
    earlier: int,
    keys: Any,
    counts: Any,
) -> int:
    """Write the keys of the tick's touching pairs to `keys`, ascending; how many there are.

    before: in its first `earlier` places the keys of the tick before. counts goes up per pair that
    is new.
    """
    found = 0
    for row in range(len(contacts)):
        if contacts[row, 2] == 0:
            continue
        one = things[np.searchsorted(ids, np.int64(contacts[row, 0]))]
        two = things[np.searchsorted(ids, np.int64(contacts[row, 1]))]
        for side in range(2):
            robot, thing = (one, two) if side == 0 else (two, one)
            if robot < first:
                continue
            key = _key(robot - first, thing)
            at = np.searchsorted(keys[:found], key)
            if at < found and keys[at] == key:
                continue
            for k in range(found, at, -1):
                keys[k] = keys[k - 1]
            keys[at] = key
            found += 1
    for k in range(found):
        at = np.searchsorted(before[:earlier], keys[k])
        if at == earlier or before[at] != keys[k]:
            counts[keys[k] // _FACTOR] += 1
    return found


@compiled
def _involving(contacts: Any, ids: Any, things: Any, wanted: Any) -> Any:
    """The contacts of the things wanted (r,)."""
    bodies = np.empty(len(ids), dtype=np.int64)
    found = 0
    for k in range(len(things)):
        for one in wanted:
            if things[k] == one:
                bodies[found] = ids[k]
                found += 1
                break
    rows = np.empty(len(contacts), dtype=np.int64)
    count = 0
    for row in range(len(contacts)):
        one, two = np.int64(contacts[row, 0]), np.int64(contacts[row, 1])
        for k in range(found):
            if bodies[k] in (one, two):
                rows[count] = row
                count += 1
                break
    return contacts[rows[:count]]


@compiled
def _locate(contacts: Any, ids: Any, things: Any, first: int, touching: Any, unfelt: Any) -> Any:
    """The points and the stretches of the tick's touching pairs, both sorted.

    touching (p,): the pairs' keys, ascending. A pair's points are those of the last substep in
    which it touched. unfelt (u,) ascending: things of which there are no stretches.
    """
    rows = np.empty(2 * len(contacts), dtype=np.int64)
    pairs = np.empty(2 * len(contacts), dtype=np.int64)
    sides = np.empty(2 * len(contacts), dtype=np.int64)
    last = np.zeros(len(touching))
    found = 0
    for row in range(len(contacts)):
        if contacts[row, 2] == 0:
            continue
        one = things[np.searchsorted(ids, np.int64(contacts[row, 0]))]
        two = things[np.searchsorted(ids, np.int64(contacts[row, 1]))]
        for side in range(2):
            robot, thing = (one, two) if side == 0 else (two, one)
            if robot < first:
                continue
            pair = np.searchsorted(touching, _key(robot - first, thing))
            rows[found], pairs[found], sides[found] = row, pair, side
            last[pair] = max(last[pair], contacts[row, 11])
            found += 1
    places = np.empty((2 * found, 3))
    stretches = np.empty((found, 5))
    shown, touched = 0, 0
    for k in range(found):
        contact, key = contacts[rows[k]], touching[pairs[k]]
        if contact[11] < last[pairs[k]]:
            continue
        robot, other = key // _FACTOR, 1 if contact[2] > 1 else 0
        for c in range(other + 1):
            places[shown, 0] = robot
            for axis in range(2):
                at = 3 + 4 * c + axis
                places[shown, 1 + axis] = (contact[at] + contact[at + 2]) / 2.0
            shown += 1
        if len(unfelt) > 0:
            thing = key % _FACTOR - _HALF
            at = np.searchsorted(unfelt, thing)
            if at < len(unfelt) and unfelt[at] == thing:
                continue
        begin, end = 3 + 2 * sides[k], 3 + 4 * other + 2 * sides[k]
        start, stop = contact[begin : begin + 2], contact[end : end + 2]
        if stop[0] < start[0] or (stop[0] == start[0] and stop[1] < start[1]):
            start, stop = stop, start
        stretches[touched, 0] = robot
        stretches[touched, 1:3] = start
        stretches[touched, 3:5] = stop
        touched += 1
    places, stretches = _sorted(places[:shown]), _sorted(stretches[:touched])
    return (
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
