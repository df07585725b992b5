"""One moment of a run as those see it who watch: plain arrays, copied, so that it may be kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.video.snapshot import Backdrop

SETTLED, STALLED, TOUCHING, AWAITED = 1, 2, 4, 8
"""Bits of a robot's state: nobody drives it any more; it is kept from what it wants to do; it
touches something; the world has been waiting for its controller for a while."""

Pose = tuple[float, float, float]
"""x, y, yaw in the world: metres and radians."""
Floats = NDArray[np.float32]
Solid = tuple[NDArray[np.float64], int]
"""Vertices (k, 2) in the world and 0xRRGGBB."""


class Fan(NamedTuple):
    """A scan. `ranges` (k,) in metres, counter-clockwise from the right, over `fov` radians."""

    robot: int
    sensor: int
    pose: Pose
    fov: float
    ranges: Floats


class Cones(NamedTuple):
    """A ring of sonars. `elements` (k, 4): x, y, heading in the world, and the range."""

    robot: int
    sensor: int
    fov: float
    elements: Floats


class Sight(NamedTuple):
    """A blobfinder's image of `width` x `height` pixels over `fov` radians.

    `blobs` (k, 6): 0xRRGGBB, left, right, top, bottom in pixels, and the range in millimetres.
    """

    robot: int
    sensor: int
    pose: Pose
    fov: float
    width: int
    height: int
    blobs: NDArray[np.uint32]


class Marks(NamedTuple):
    """Fiducials in sight. `seen` (k, 4): the id, and x, y, yaw in the sensor's frame."""

    robot: int
    sensor: int
    pose: Pose
    seen: Floats


class Switches(NamedTuple):
    """A bumper's parts. `parts` (k, 3): 1 if closed, and from which bearing to which it lies."""

    robot: int
    sensor: int
    pose: Pose
    parts: Floats


Line = tuple[int, float, str]
"""Robot, time in seconds, and words."""


class Robot(NamedTuple):
    """A robot that has entered: its name, and its model's."""

    name: str
    model: str


@dataclass(frozen=True)
class Scene:
    """All that does not move by itself in a run. `about` is what JSON can hold (see `frames`)."""

    about: Mapping[str, Any]
    solids: Sequence[Solid] = ()
    """Walls, map blocks, standing obstacles."""


@dataclass(frozen=True)
class Moment:
    """What shows at one time. Robots keep the index at which they entered."""

    time: float
    """Simulated seconds."""
    tick: int
    poses: Floats
    """(n, 3) x, y, yaw."""
    colors: NDArray[np.uint32]
    """(n,) 0xRRGGBB of the bodies."""
    states: NDArray[np.uint8]
    """(n,) bits: SETTLED, STALLED, TOUCHING, AWAITED."""
    robots: Sequence[Robot] = ()
    """(n,)"""
    things: Floats = field(default_factory=lambda: np.empty((0, 3), np.float32))
    """(m, 3) x, y, yaw of what can be pushed, and then of what stands and may be put elsewhere."""
    fans: Sequence[Fan] = ()
    cones: Sequence[Cones] = ()
    sights: Sequence[Sight] = ()
    marks: Sequence[Marks] = ()
    switches: Sequence[Switches] = ()
    paint: NDArray[np.int16] | None = None
    """(rows, columns) 0 = bare, r + 1 = painted last by robot r; row 0 lies at y = 0."""
    said: Sequence[Line] = ()
    """The latest of each robot that has said anything."""
    drawn: Sequence[Mapping[str, Any]] = ()
    """What programs have drawn: robot, kind, points in its frame, color, fill (or None)."""
    status: Mapping[str, Any] = field(default_factory=dict)
    """Of the whole run: paused, pace, waiting, coverage, outcome ..."""
    cards: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)
    """What is known of the robots that somebody has selected."""
    jumps: int = 0
    """How often time has jumped, in a log that is played."""
    ways: Floats | None = None
    """(k, n, 3) where robots had been on the way to where time jumped to; NaN: not there yet."""
    backdrop: Backdrop | None = None
    """What stands, where hands have moved something; None: as in the scene."""
