"""The floor that sprayers paint: a layer of square cells, who painted them, and how often."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sim.stage import sweep

if TYPE_CHECKING:
    from sim.stage.layout import Layout

Floats = NDArray[np.float64]


class FloorPaint:
    """The paint layer of a world.

    `owner` (rows, columns) int16: 0 for bare floor, r + 1 for what robot r painted last; row 0
    lies lowest. `visits` (rows, columns) counts how often a sprayer came over a cell. Only
    cells whose centre lies in the region and in no wall or obstacle count; the others are never
    painted. `resolution` is the cells' width in metres.
    """

    def __init__(self, layout: Layout, resolution: float) -> None:
        width, height = layout.size
        columns = max(1, math.ceil(width / resolution - 1e-9))
        rows = max(1, math.ceil(height / resolution - 1e-9))
        self.resolution = resolution
        self._layout = layout
        self._shape = (rows, columns)
        self._before: dict[int, Floats] = {}
        self._painted = 0
        self._visits = 0
        self._ready = False

    def _prepare(self) -> None:
        """Make the arrays when they are first needed: most worlds have no sprayer."""
        if self._ready:
            return
        rows, columns = self._shape
        x = (np.arange(columns) + 0.5) * self.resolution + self._layout.low[0]
        y = (np.arange(rows) + 0.5) * self.resolution + self._layout.low[1]
        centres = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        self._counts = self._layout.inside(centres).reshape(rows, columns)
        self._cells = int(self._counts.sum())
        self._owner = np.zeros((rows, columns), np.int16)
        self._visited = np.zeros((rows, columns), np.uint16)
        self._ready = True

    @property
    def owner(self) -> NDArray[np.int16]:
        """(rows, columns) 0, or 1 + the robot that painted the cell last."""
        self._prepare()
        return self._owner

    @property
    def visits(self) -> NDArray[np.uint16]:
        """(rows, columns) how often a sprayer came over each cell."""
        self._prepare()
        return self._visited

    @property
    def counted(self) -> NDArray[np.bool_]:
        """(rows, columns) whether a cell belongs to the floor that is to be painted."""
        self._prepare()
        return self._counts

    @property
    def coverage(self) -> float:
        """Painted cells over cells, 0 to 1."""
        return self._painted / self._cells if self._painted else 0.0

    @property
    def painted_area(self) -> float:
        """Square metres that are painted."""
        return self._painted * self.resolution**2

    @property
    def passes(self) -> float:
        """How often a painted cell was come over on average; 0 where nothing is painted."""
        return self._visits / self._painted if self._painted else 0.0

    def spray(
        self,
        sprayers: NDArray[np.int64],
        robots: NDArray[np.int64],
        ways: Floats,
        sizes: Floats,
        offsets: Floats,
    ) -> None:
        """Paint what sprayers swept on their robots' way through a tick, turns and all.

        Args:
            sprayers: (k,) a number of its own for each sprayer that is on, in increasing order.
            robots: (k,) the robots that carry them.
            ways: (k, m, 3) where those were: x, y, yaw at the beginning of the tick and after
                each substep of it, in which they moved and turned evenly. Yaw is not wrapped: it
                says how far they turned.
            sizes: (k, 2) each rectangle's length (along the robot) and width in metres.
            offsets: (k, 2) its centre in the robot's frame.

        A sprayer that is not among them is off, and forgets where it was. One that was carried
        to another place between two ticks paints nothing on that way.
        """
        if not len(sprayers) and not self._before:
            return
        self._prepare()
        ways = ways - (*self._layout.low, 0.0)
        before = np.full((len(sprayers), 3), np.nan)
        for k, sprayer in enumerate(sprayers.tolist()):
            before[k] = self._before.get(sprayer, np.nan)
        painted, visits = sweep.sweep(
            self._owner, self._visited, self._counts, self.resolution, robots, before,
            np.ascontiguousarray(ways, dtype=np.float64), np.asarray(sizes, dtype=np.float64),
            np.asarray(offsets, dtype=np.float64),
        )  # fmt: skip
        self._painted += painted
        self._visits += visits
        self._before = dict(zip(sprayers.tolist(), ways[:, -1].copy(), strict=True))
