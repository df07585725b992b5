"""What one moment shows, as plain arrays: the still backdrop and the snapshot of one moment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Shape = NDArray[np.float64] | float
"""A body's outline: vertices (k, 2) in metres in the body's frame, or a circle's radius."""

DrawingKind = Literal["points", "polyline", "multiline", "polygon"]


MOST_SCANS = 32
"""Fans in one frame, the first ones of a snapshot: more would hide each other and the robots."""


class Scan(NamedTuple):
    """One range reading to be drawn as a fan."""

    robot: int
    pose: NDArray[np.float64] | Sequence[float]
    """The sensor's x, y, yaw in the world (m, rad)."""
    fov: float
    """Radians from the first ray to the last."""
    ranges: NDArray[np.float64]
    """(k,) metres, counter-clockwise from the right."""


class Sighting(NamedTuple):
    """What one blobfinder sees: runs of one colour."""

    robot: int
    pose: NDArray[np.float64] | Sequence[float]
    """The sensor's x, y, yaw in the world (m, rad)."""
    bearings: NDArray[np.float64]
    """(k, 2) where each run ends on the right and on the left: radians, in the sensor's frame."""
    colors: NDArray[np.integer]
    """(k,) 0xRRGGBB."""


@dataclass(frozen=True)
class Drawing:
    """One figure of Player's graphics2d interface, in world coordinates.

    `points` are dots, a `polyline` joins them all, a `multiline` joins the 1st with the 2nd,
    the 3rd with the 4th and so on, a `polygon` is closed.
    """

    kind: DrawingKind
    points: NDArray[np.float64]
    """(k, 2) metres."""
    color: int = 0x000000
    """0xRRGGBB of points, lines and a polygon's edge."""
    filled: bool = False
    fill_color: int | None = None
    """0xRRGGBB of a filled polygon's inside; None: `color`."""


@dataclass(frozen=True)
class Backdrop:
    """All that does not move by itself. The origin is the lower-left corner of `size`."""

    size: tuple[float, float]
    """Width and height of the world in metres."""
    solids: Sequence[tuple[NDArray[np.float64], int]] = ()
    """Vertices (k, 2) in the world and 0xRRGGBB: walls, map blocks, standing obstacles."""
    low: tuple[float, float] = (0.0, 0.0)
    """x, y in metres of the lower left corner: where coordinates count from lies at (0, 0)."""
    marks: Sequence[tuple[NDArray[np.float64], int]] = ()
    """The same of what robots can drive over or under; shown below all else."""
    doors: Sequence[NDArray[np.float64]] = ()
    """Outlines (k, 2) of the cells at which robots enter."""
    title: str = ""
    """Stands in the status line."""


@dataclass
class Snapshot:
    """One moment of a run: it follows from the world and the seed alone.

    Arrays are read at once and never kept or changed.
    """

    time: float
    """Simulated seconds."""
    poses: NDArray[np.float64]
    """(n, 3) x, y, yaw of every robot in the order in which they were added."""
    colors: NDArray[np.integer] | Sequence[int]
    """(n,) 0xRRGGBB of the bodies."""
    coverage: float | None = None
    """Painted share of the floor, 0 to 1; None where nothing paints."""
    said: Sequence[str] = ()
    """(n,) what each robot said last, "" for nothing."""
    said_at: Sequence[float] = ()
    """(n,) when it said that, in simulated seconds; empty: now."""
    settled: Sequence[bool] | NDArray[np.bool_] = ()
    """(n,) whether nobody drives the robot any more, as its controller has ended; empty: none."""
    scans: Sequence[Scan | tuple[int, Sequence[float], float, NDArray[np.float64]]] = ()
    """Only the first MOST_SCANS show."""
    sightings: Sequence[Sighting] = ()
    """What blobfinders see."""
    floor: NDArray[np.int16] | None = None
    """(rows, cols) 0 = bare, r + 1 = painted last by robot r; row 0 lies at y = 0."""
    resolution: float = 0.05
    """Metres per cell of `floor`."""
    movables: Sequence[tuple[Shape, int]] = ()
    """Shape and 0xRRGGBB of every thing that can be pushed."""
    movable_poses: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 3)))
    """(m, 3) x, y, yaw of `movables`."""
    drawings: Sequence[Drawing] = ()
    backdrop: Backdrop | None = None
    """What stands, where hands have moved something; None: as at the start."""
