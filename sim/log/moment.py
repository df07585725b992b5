"""What a log is told of a run besides its ticks: values that nobody changes afterwards."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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


class Read(NamedTuple):
    """Some sensors of a group: those that are read, and what their arrays are called in rows."""

    group: SensorGroup
    rows: Sequence[int]
    """(k,) which of the group's."""
    sources: Mapping[str, object]
    """By the field of the readings: the name of the source."""


class Painted(NamedTuple):
    """Windows of the floor that may have been painted in a tick."""

    tick: int
    time: float
    windows: Sequence[tuple[int, int, NDArray[np.int16]]]
    """First row, first column, owners."""


class Touched(NamedTuple):
    """Where robots touch something that have begun to touch something in a tick."""

    tick: int
    time: float
    robots: NDArray[np.int64]
    """(k,) for each point: a robot may have several."""
    points: Floats
    """(k, 2)"""


@dataclass(frozen=True)
class Floor:
    """The cells of the painted floor."""

    rows: int
    columns: int
    resolution: float
    low: tuple[float, float] = (0.0, 0.0)
    """x, y in metres of the lower left corner."""
