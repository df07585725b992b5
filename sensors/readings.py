"""The kinds of readings, each for n robots at once: what sensors write and the simulator encodes.

Row k of every array belongs to the k-th robot of a batch. All arrays may be read at any time;
what was not wanted in a tick keeps what it was. `row(k)` is one robot's reading, as views.
Angles are radians, in the sensor's own frame: x ahead, y to the left, counter-clockwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple, Protocol, Self

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

BLOB = np.dtype(
    [
        *((name, np.uint32) for name in ("id", "color", "area", "x", "y")),
        *((name, np.uint32) for name in ("left", "right", "top", "bottom")),
        ("range", np.float64),
    ]
)
"""One blob: pixels from the image's left and top, colour 0xRRGGBB, range in metres."""

FIDUCIAL = np.dtype([("id", np.int32), ("x", float), ("y", float), ("yaw", float)])
"""One fiducial: its id and its pose relative to the sensor, metres and radians."""


class Fan(NamedTuple):
    """Rays of n sensors from -fov/2 to +fov/2, as many as there are columns, and what they hit."""

    fov: float
    """radians"""
    max_range: float
    """metres"""
    ranges: Floats
    """(n, samples) metres, max_range where nothing is hit; written."""
    hits: npt.NDArray[np.int32]
    """(n, samples) the entity that was hit, or -1; written."""


class Readings(Protocol):
    """What every kind of readings offers."""

    kind: ClassVar[str]

    def resized(self, n: int) -> Self:
        """The same for n robots; the first rows keep their content."""

    def row(self, k: int) -> Self:
        """One robot's reading: the same kind with n = 1, as views into the arrays."""


def _grown(array: npt.NDArray[Any], n: int, fill: Any) -> npt.NDArray[Any]:
    """`array` with n rows: its own first, then rows full of `fill`."""
    kept = min(n, len(array))
    new = np.zeros((n, *array.shape[1:]), array.dtype)  # costs no memory where nothing is written
    if fill:
        new[kept:] = fill
    new[:kept] = array[:kept]
    return new


@dataclass
class Scans:
    """Ranges from one origin: a fan of rays from the right (-fov/2) to the left (+fov/2)."""

    kind: ClassVar[str] = "scan"
    ranges: Floats
    """(n, samples) metres; max_range where nothing is hit."""
    hits: npt.NDArray[np.int32]
    """(n, samples) the entity that was hit, or -1: for the simulator, no robot can know it."""
    fov: float
    max_range: float

    @classmethod
    def empty(cls, n: int, samples: int, fov: float, max_range: float) -> Scans:
        """Scans of n robots that have seen nothing yet; fov in radians, max_range in metres."""
        hits = np.full((n, samples), -1, np.int32)
        return cls(np.full((n, samples), max_range), hits, fov, max_range)

    @property
    def bearings(self) -> Floats:
        """(samples,) the rays' bearings in the sensor's frame."""
        samples = int(self.ranges.shape[1])
        half = 0.5 * self.fov
        return np.linspace(-half, half, samples) if samples > 1 else np.zeros(1)

    @property
    def resolution(self) -> float:
        """The angle between two rays."""
        return self.fov / max(int(self.ranges.shape[1]) - 1, 1)

    def resized(self, n: int) -> Scans:
        ranges = _grown(self.ranges, n, self.max_range)
        return Scans(ranges, _grown(self.hits, n, -1), self.fov, self.max_range)

    def row(self, k: int) -> Scans:
        view = slice(k, k + 1)
        return Scans(self.ranges[view], self.hits[view], self.fov, self.max_range)


@dataclass
class Elements:
    """Ranges from several origins, one per element: a ring of sonars."""

    kind: ClassVar[str] = "elements"
    ranges: Floats
    """(n, elements) metres; max_range where nothing is hit."""
    poses: Floats
    """(elements, 3) the elements' x, y, heading in the sensor's frame."""
    fov: float
    max_range: float

    @classmethod
    def empty(cls, n: int, poses: npt.ArrayLike, fov: float, max_range: float) -> Elements:
        """Ranges of n robots that have seen nothing yet."""
        at = np.array(poses, np.float64).reshape(-1, 3)
        return cls(np.full((n, len(at)), max_range), at, fov, max_range)

    def resized(self, n: int) -> Elements:
        ranges = _grown(self.ranges, n, self.max_range)
        return Elements(ranges, self.poses, self.fov, self.max_range)

    def row(self, k: int) -> Elements:
        return Elements(self.ranges[k : k + 1], self.poses, self.fov, self.max_range)


@dataclass
class Intensities:
    """Ranges and what came back along each ray, from one origin, as with `Scans`."""

    kind: ClassVar[str] = "intensities"
    ranges: Floats
    """(n, samples) metres."""
    intensities: Floats
    """(n, samples) in the sensor's own unit."""
    fov: float
    max_range: float

    @classmethod
    def empty(cls, n: int, samples: int, fov: float, max_range: float) -> Intensities:
        """Intensities of n robots that have seen nothing yet."""
        return cls(np.full((n, samples), max_range), np.zeros((n, samples)), fov, max_range)

    def resized(self, n: int) -> Intensities:
        ranges = _grown(self.ranges, n, self.max_range)
        return Intensities(ranges, _grown(self.intensities, n, 0.0), self.fov, self.max_range)

    def row(self, k: int) -> Intensities:
        view = slice(k, k + 1)
        return Intensities(self.ranges[view], self.intensities[view], self.fov, self.max_range)


@dataclass
class Blobs:
    """Runs of one colour in an image."""

    kind: ClassVar[str] = "blobs"
    blobs: npt.NDArray[np.void]
    """(n, capacity) of dtype BLOB; the first `counts` of each row hold, from right to left.

    The first blobs of all robots lie side by side, then the second ones, and so on: what nobody
    sees takes no memory.
    """
    counts: npt.NDArray[np.int64]
    """(n,) blobs per robot."""
    width: int
    height: int
    columns: Floats | None = field(default=None, repr=False)
    """(n, width) range of each column in metres, from the right; for drawing."""
    hits: npt.NDArray[np.int32] | None = field(default=None, repr=False)
    """(n, width) the entity in each column, or -1; for drawing."""

    @classmethod
    def empty(cls, n: int, width: int, height: int) -> Blobs:
        """Images of n robots that have seen nothing yet."""
        hits = np.full((n, width), -1, np.int32)
        blobs = np.zeros((width, n), BLOB).T
        return cls(blobs, np.zeros(n, np.int64), width, height, np.zeros((n, width)), hits)

    def seen(self, k: int) -> npt.NDArray[np.void]:
        """The blobs of row k: (count,) of dtype BLOB."""
        return self.blobs[k, : self.counts[k]]

    def resized(self, n: int) -> Blobs:
        columns = None if self.columns is None else _grown(self.columns, n, 0.0)
        hits = None if self.hits is None else _grown(self.hits, n, -1)
        counts = _grown(self.counts, n, 0)
        blobs = np.zeros((self.blobs.shape[1], n), BLOB).T
        kept, most = min(n, len(self.counts)), self.counts.max(initial=0)
        blobs[:kept, :most] = self.blobs[:kept, :most]
        return Blobs(blobs, counts, self.width, self.height, columns, hits)

    def row(self, k: int) -> Blobs:
        view = slice(k, k + 1)
        columns = None if self.columns is None else self.columns[view]
        hits = None if self.hits is None else self.hits[view]
        blobs, counts = self.blobs[view], self.counts[view]
        return Blobs(blobs, counts, self.width, self.height, columns, hits)


@dataclass
class Fiducials:
    """Marked things that are in sight, with their ids and relative poses."""

    kind: ClassVar[str] = "fiducials"
    fiducials: npt.NDArray[np.void]
    """(n, capacity) of dtype FIDUCIAL; the first `counts` of each row hold, nearest first."""
    counts: npt.NDArray[np.int64]
    """(n,) fiducials per robot."""
    fov: float
    max_range: float

    @classmethod
    def empty(cls, n: int, fov: float, max_range: float) -> Fiducials:
        """Fiducials of n robots that have seen nothing yet."""
        return cls(np.zeros((n, 8), FIDUCIAL), np.zeros(n, np.int64), fov, max_range)

    def seen(self, k: int) -> npt.NDArray[np.void]:
        """The fiducials of row k: (count,) of dtype FIDUCIAL."""
        return self.fiducials[k, : self.counts[k]]

    def reserve(self, capacity: int) -> None:
        """Make room for `capacity` fiducials in each row."""
        n, old = self.fiducials.shape
        if capacity > old:
            wider = np.zeros((n, max(capacity, 2 * old)), FIDUCIAL)
            wider[:, :old] = self.fiducials
            self.fiducials = wider

    def resized(self, n: int) -> Fiducials:
        fiducials, counts = _grown(self.fiducials, n, 0), _grown(self.counts, n, 0)
        return Fiducials(fiducials, counts, self.fov, self.max_range)

    def row(self, k: int) -> Fiducials:
        view = slice(k, k + 1)
        return Fiducials(self.fiducials[view], self.counts[view], self.fov, self.max_range)


@dataclass
class Bits:
    """Switches that are on or off: bumpers, for instance."""

    kind: ClassVar[str] = "bits"
    bits: npt.NDArray[np.bool_]
    """(n, k) whether each switch is on."""
    arcs: Floats | None = None
    """(k, 2) the bearings from which to which (counter-clockwise) each one lies, if it does."""

    @classmethod
    def empty(cls, n: int, k: int, arcs: npt.ArrayLike | None = None) -> Bits:
        """Switches of n robots, all off."""
        spans = None if arcs is None else np.array(arcs, np.float64).reshape(k, 2)
        return cls(np.zeros((n, k), np.bool_), spans)

    def resized(self, n: int) -> Bits:
        return Bits(_grown(self.bits, n, False), self.arcs)

    def row(self, k: int) -> Bits:
        return Bits(self.bits[k : k + 1], self.arcs)


@dataclass
class Scalars:
    """Plain numbers, each with a name and a unit."""

    kind: ClassVar[str] = "scalars"
    values: Floats
    """(n, k) the numbers."""
    names: tuple[str, ...]
    units: tuple[str, ...]

    @classmethod
    def empty(cls, n: int, names: Sequence[str], units: Sequence[str]) -> Scalars:
        """Numbers of n robots, all 0."""
        if len(names) != len(units):
            raise ValueError(f"{len(names)} names and {len(units)} units: one unit for each name")
        return cls(np.zeros((n, len(names))), tuple(names), tuple(units))

    def resized(self, n: int) -> Scalars:
        return Scalars(_grown(self.values, n, 0.0), self.names, self.units)

    def row(self, k: int) -> Scalars:
        return Scalars(self.values[k : k + 1], self.names, self.units)


def too_near(ranges: Floats, rows: npt.NDArray[np.int64], min_range: float) -> None:
    """Of the wanted rows, have what is nearer than `min_range` read 0.

    So do real range finders whose echo comes before they listen: something is there, and nobody can
    say where. A robot that turns away from what is near still does.
    """
    if min_range > 0.0:
        measured = ranges[rows]
        ranges[rows] = np.where(measured < min_range, 0.0, measured)


KINDS: dict[str, type] = {
    kind.kind: kind for kind in (Scans, Elements, Intensities, Blobs, Fiducials, Bits, Scalars)
}
"""Every kind of readings, by its name."""
