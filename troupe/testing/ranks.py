"""Whether robots keep their order along an axis."""

from __future__ import annotations

from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from troupe.log import Log
from troupe.testing.evidence import Evidence
from troupe.testing.outlines import Floats


class Passing(NamedTuple):
    """From a time to a time (s), the one that began behind stood before the other, so far (m)."""

    time: float
    until: float
    behind: str
    before: str
    by: float

    def __str__(self) -> str:
        return (
            f"{self.behind} is past {self.before} by {self.by:.4f} m, "
            f"{self.time:.1f} to {self.until:.1f} s"
        )


def passings(
    source: Evidence | Log | str | Path,
    *,
    along: Literal["x", "y"] = "y",
    level: float = 0.0,
    give: float = 0.0,
) -> list[Passing]:
    """The times that neighbours in the order of their starts along an axis changed it.

    Starts that differ by less than `level` m along the axis are level: the other axis decides
    between them, and they may pass each other by up to `give` m.
    """
    seen = Evidence.of(source)
    axis = "xy".index(along)
    order, same = ranked(seen.starts, axis, level)
    found = []
    for k, is_level in enumerate(same.tolist()):
        one, other = int(order[k]), int(order[k + 1])
        by = seen.poses[:, one, axis] - seen.poses[:, other, axis]
        (late,) = np.nonzero(by > (give if is_level else 0.0))
        for run in np.split(late, np.flatnonzero(np.diff(late) > 1) + 1) if len(late) else []:
            times = seen.times[run]
            first, last, most = float(times[0]), float(times[-1]), float(by[run].max())
            found.append(Passing(first, last, seen.names[one], seen.names[other], most))
    return sorted(found)


def ranked(
    starts: Floats, axis: int = 1, level: float = 0.0
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """The order (n,) of starts (n, 3) along an axis, and who is level with the next (n - 1,)."""
    in_order = np.argsort(starts[:, axis], kind="stable")
    same = np.diff(starts[in_order, axis]) < level
    row = np.concatenate([[0], np.cumsum(~same)])
    return in_order[np.lexsort((starts[in_order, 1 - axis], row))], same
