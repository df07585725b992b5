"""What a log is told of a run: plain arrays and values, which nobody changes afterwards."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Event:
    """Something that happened: a message on a topic, of a type, at simulated seconds."""

    time: float
    topic: str
    type: str
    values: Mapping[str, Any]


class Fans(NamedTuple):
    """Readings of the sensors of equal settings in one tick, all that were sensed."""

    source: SensorGroup
    rows: NDArray[np.int64]
    """(k,) which of the group's."""
    ranges: NDArray[np.float32]
    """(k, samples) metres, of whatever has ranges; else empty."""
    intensities: NDArray[np.float32] | None = None
    blobs: bytes = b""
    """(sum of counts,) of the readings' dtype BLOB, one sensor's after the other's."""
    counts: NDArray[np.int64] | None = None
    """(k,) how many blobs each has."""


@dataclass
class SensorGroup:
    """What does not change about sensors of equal settings."""

    kind: str
    """scan, elements, intensities or blobs."""
    noun: str
    """How their topics end: scan, range, blobs."""
    fov: float
    """Radians."""
    max_range: float
    min_range: float
    samples: int
    size: tuple[int, int] = (0, 0)
    """Pixels of an image."""
    members: list[tuple[str, str]] = field(default_factory=list)
    """By row: topic and frame."""
    memo: dict[Hashable, Any] = field(default_factory=dict)
    """How their messages are laid out, as far as it is known."""
    layouts: dict[Hashable, Any] = field(default_factory=dict)


class TickState(NamedTuple):
    """All that moves, at the end of one tick.

    What stands for n robots is the bytes of an array, which are copied in no time; its type is
    given for each.
    """

    tick: int
    time: float
    coverage: float
    robots: int
    """n"""
    colors: bytes
    """(n,) uint32"""
    poses: bytes
    """(n, 3) float64"""
    velocities: bytes
    """(n, 3) float64"""
    stalls: bytes
    """(n,) bool"""
    contacts: bytes
    """(n,) int64"""
    movers: bytes
    """(n,) MOVER: the stage's records, of which the commands count; empty: as they were."""
    movables: bytes
    """(m, 3) float64"""
    odometry: Floats | None = None
    """(n, 3) where it is logged."""
    fans: Sequence[Fans] = ()
    events: Sequence[Event] = ()
    painted: Sequence[tuple[int, int, NDArray[np.int16]]] = ()
    """Windows of the floor that may have changed: first row, first column, owners."""
    touched: tuple[NDArray[np.int64], Floats] | None = None
    """Robots and points of this tick's contacts."""


@dataclass(frozen=True)
class Floor:
    """The cells of the painted floor."""

    rows: int
    columns: int
    resolution: float
    low: tuple[float, float] = (0.0, 0.0)
    """x, y in metres of the lower left corner."""
