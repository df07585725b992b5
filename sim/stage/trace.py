"""Where some bodies were after each piece of a tick's physics: their ways, for what they swept."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.stage.batch import BodyTable
from sim.stage.geometry import Floats

NOBODY: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
"""No robot's way is asked for."""
NO_WAYS: Floats = np.zeros((0, 1, 3))


class Trace:
    """Notes the poses of some movers, by their numbers (k,): at first, and at each `note`.

    Their rows in the table may change within a tick, when bodies get or lose their joints.
    """

    def __init__(self, table: BodyTable, movers: NDArray[Any], numbers: NDArray[np.int64]) -> None:
        self._table, self._movers, self._numbers = table, movers, numbers
        self._poses: list[Floats] = []
        self.note()

    def note(self) -> None:
        """Note the poses that the table has now."""
        self._poses.append(self._table.state[self._movers["row"][self._numbers], :3])

    def ways(self) -> Floats:
        """(k, m, 3) x, y, yaw of each body at each note; yaw as Chipmunk counts it, unwrapped."""
        return np.stack(self._poses, axis=1)
