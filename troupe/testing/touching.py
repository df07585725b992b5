"""Which bodies have overlapped, and how deep: from the poses, not from what the physics counted."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from troupe.log import Log
from troupe.testing.evidence import Evidence
from troupe.testing.nearness import other_pairs, robot_pairs
from troupe.testing.outlines import Floats


class Contact(NamedTuple):
    """A robot and another, or what stands, overlapped from a time to a time (s), so deep (m)."""

    time: float
    until: float
    robot: str
    other: str
    depth: float

    def __str__(self) -> str:
        return (
            f"{self.robot} and {self.other} overlap by {self.depth:.4f} m, "
            f"{self.time:.1f} to {self.until:.1f} s"
        )


def contacts(source: Evidence | Log | str | Path, *, deeper_than: float = 1e-9) -> list[Contact]:
    """The times that a robot overlapped another body or a wall by more than so many metres.

    One for each time that two were together without a break, in the order in which they began.
    Bodies that press against each other overlap a little in any physics: allow 0.01 m where
    robots may push.
    """
    seen = Evidence.of(source)
    found: list[Contact] = []
    for i, j, where, gaps in robot_pairs(seen, 0.0):
        found += episodes(seen, where, gaps, deeper_than, seen.names[i], seen.names[j])
    together: dict[tuple[int, str], Floats] = {}  # the blocks of a map are one thing
    for i, name, where, gaps in other_pairs(seen, 0.0):
        known = together.setdefault((i, name), np.full(len(seen.times), np.inf))
        known[where] = np.minimum(known[where], gaps)
    for (i, name), gaps in together.items():
        every = np.arange(len(gaps))
        found += episodes(seen, every, gaps, deeper_than, seen.names[i], name)
    return sorted(found)


def episodes(
    seen: Evidence, where: NDArray[np.intp], gaps: Floats, deeper: float, robot: str, other: str
) -> list[Contact]:
    """The contacts of two whose gaps (k,) in ticks (k,) are known."""
    deep = where[gaps < -deeper]
    if not len(deep):
        return []
    depth = dict(zip(where.tolist(), (-gaps).tolist(), strict=True))
    found = []
    for run in np.split(deep, np.flatnonzero(np.diff(deep) > 1) + 1):
        first, last = seen.times[run[0]], seen.times[run[-1]]
        deepest = max(depth[tick] for tick in run.tolist())
        found.append(Contact(float(first), float(last), robot, other, deepest))
    return found
