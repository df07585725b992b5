"""The floor that sprayers paint: a layer of square cells, who painted them, and how often."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sim.stage.compiled import compiled

if TYPE_CHECKING:
    from sim.stage.layout import Layout

Floats = NDArray[np.float64]
EDGE = 1e-9
"""Metres: a cell whose centre lies on a sprayer's edge, but for rounding, is painted."""


class FloorPaint:
    """The paint layer of a world.

    `owner` (rows, columns) int16: 0 for bare floor, r + 1 for what robot r painted last; row 0
    lies at y = 0. `visits` (rows, columns) counts how often a sprayer came over a cell. Only
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
        x = (np.arange(columns) + 0.5) * self.resolution
        y = (np.arange(rows) + 0.5) * self.resolution
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
        poses: Floats,
        sizes: Floats,
        offsets: Floats,
    ) -> None:
        """Paint what lies under sprayers, on the way from where each was a tick ago.

        Args:
            sprayers: (k,) a number of its own for each sprayer that is on, in increasing order.
            robots: (k,) the robots that carry them.
            poses: (k, 3) the robots' x, y, yaw.
            sizes: (k, 2) each rectangle's length (along the robot) and width in metres.
            offsets: (k, 2) its centre in the robot's frame.

        A sprayer that is not among them is off, and forgets where it was.
        """
        if not len(sprayers) and not self._before:
            return
        self._prepare()
        start = np.full((len(sprayers), 3), np.nan)
        for k, sprayer in enumerate(sprayers.tolist()):
            start[k] = self._before.get(sprayer, np.nan)
        end = np.empty((len(sprayers), 3))
        cosine, sine = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        end[:, 0] = poses[:, 0] + cosine * offsets[:, 0] - sine * offsets[:, 1]
        end[:, 1] = poses[:, 1] + sine * offsets[:, 0] + cosine * offsets[:, 1]
        end[:, 2] = poses[:, 2]
        painted, visits = _spray(
            self._owner, self._visited, self._counts, self.resolution, robots, start, end,
            np.asarray(sizes, dtype=np.float64),
        )  # fmt: skip
        self._painted += painted
        self._visits += visits
        self._before = dict(zip(sprayers.tolist(), end, strict=True))


@compiled
def _spray(
    owner: Any,
    visited: Any,
    counts: Any,
    resolution: float,
    robots: Any,
    start: Any,
    end: Any,
    sizes: Any,
) -> tuple[int, int]:
    """Paint under sprayers (k,) on their way from `start` to `end` (k, 3).

    A sprayer that moves by more than half of its lesser side is stamped in between too. One
    whose start is not a number was off. Returns newly painted cells, and visits.
    """
    painted, visits = 0, 0
    for k in range(len(robots)):
        half_length, half_width = sizes[k, 0] / 2.0 + EDGE, sizes[k, 1] / 2.0 + EDGE
        was_on = not math.isnan(start[k, 0])
        last, stamps, turn = end[k], 1, 0.0
        if was_on:
            last = start[k]
            way = math.hypot(end[k, 0] - last[0], end[k, 1] - last[1])
            stamps = max(1, math.ceil(way / min(half_length, half_width)))
            turn = math.pi - (math.pi - end[k, 2] + last[2]) % (2.0 * math.pi)
        for stamp in range(1, stamps + 1):
            pose = end[k].copy()
            if stamp < stamps:
                part = stamp / stamps
                pose[:2] = start[k, :2] + part * (end[k, :2] - start[k, :2])
                pose[2] = start[k, 2] + part * turn
            fresh, came = _stamp(
                owner, visited, counts, resolution, robots[k] + 1, pose, last, was_on,
                half_length, half_width,
            )  # fmt: skip
            painted += fresh
            visits += came
            last, was_on = pose, True
    return painted, visits


@compiled
def _stamp(
    owner: Any,
    visited: Any,
    counts: Any,
    resolution: float,
    mark: int,
    pose: Any,
    last: Any,
    was_on: bool,
    half_length: float,
    half_width: float,
) -> tuple[int, int]:
    """Paint one rectangle; newly painted cells, and cells that were not under it before."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    cos_last, sin_last = math.cos(last[2]), math.sin(last[2])
    reach_x = abs(cos) * half_length + abs(sin) * half_width
    reach_y = abs(sin) * half_length + abs(cos) * half_width
    rows, columns = owner.shape
    first_row = max(0, math.floor((pose[1] - reach_y) / resolution))
    last_row = min(rows - 1, math.floor((pose[1] + reach_y) / resolution))
    first_column = max(0, math.floor((pose[0] - reach_x) / resolution))
    last_column = min(columns - 1, math.floor((pose[0] + reach_x) / resolution))
    painted = 0
    visits = 0
    for row in range(first_row, last_row + 1):
        y = (row + 0.5) * resolution
        for column in range(first_column, last_column + 1):
            if not counts[row, column]:
                continue
            x = (column + 0.5) * resolution
            dx, dy = x - pose[0], y - pose[1]
            if abs(cos * dx + sin * dy) > half_length or abs(cos * dy - sin * dx) > half_width:
                continue
            if owner[row, column] == 0:
                painted += 1
            owner[row, column] = mark
            dx, dy = x - last[0], y - last[1]
            if was_on and (
                abs(cos_last * dx + sin_last * dy) <= half_length
                and abs(cos_last * dy - sin_last * dx) <= half_width
            ):
                continue
            visits += 1
            if visited[row, column] < 65535:
                visited[row, column] += 1
    return painted, visits
