"""Readings of many robots encoded together: one array of bytes per group of equal sensors."""

from __future__ import annotations

import struct
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sensors.readings import Blobs, Elements, Intensities, Scans
from sensors.suite import Group

BLOBS = struct.Struct(">IIII")
BLOB = np.dtype(
    [(name, ">u4") for name in ["id", "color", "area", "x", "y", "left", "right", "top", "bottom"]]
    + [("range", ">f4")]
)


class Encoder:
    """Encodes a group's wanted rows once per tick, when the first of them is asked for."""

    def __init__(self, group: Group, encode: Callable[[Group], NDArray[Any]]) -> None:
        self.group = group
        self.encode = encode
        self.tick = -1
        self.size = 0
        self.data = b""
        self.rows: NDArray[Any] = np.zeros(0, np.int64)
        self.place: dict[int, int] = {}

    def payload(self, row: int, tick: int) -> bytes:
        """The message of one row of the group."""
        if tick != self.tick:
            rows = self.encode(self.group)
            self.size = rows.dtype.itemsize
            self.data = rows.tobytes()
            if not np.array_equal(self.rows, self.group.rows):
                self.rows = self.group.rows.copy()
                self.place = {row: k for k, row in enumerate(self.rows.tolist())}
            self.tick = tick
        at = self.place[row] * self.size
        return self.data[at : at + self.size]


class BlobEncoder:
    """Encodes the blobs of a group's wanted rows once per tick: blobfinder BLOBS (subtype 1)."""

    def __init__(self, group: Group) -> None:
        self.group = group
        self.tick = -1
        self.counts: list[int] = []
        self.ends: list[int] = []
        self.data = b""
        self.rows: NDArray[Any] = np.zeros(0, np.int64)
        self.place: dict[int, int] = {}

    def payload(self, row: int, tick: int) -> bytes:
        """The message of one row of the group."""
        readings = self.group.readings
        assert isinstance(readings, Blobs)
        if tick != self.tick:
            self.encode(readings)
            self.tick = tick
        at = self.place[row]
        count, end = self.counts[at], self.ends[at]
        head = BLOBS.pack(readings.width, readings.height, count, count)
        return head + self.data[end - count * BLOB.itemsize : end]

    def encode(self, readings: Blobs) -> None:
        """All rows' blobs, one behind the other."""
        rows = self.group.rows
        counts = readings.counts[rows]
        most = int(counts.max(initial=0))
        held = np.arange(most) < counts[:, None]
        self.data = readings.blobs[rows, :most][held].astype(BLOB).tobytes()
        self.counts = counts.tolist()
        self.ends = (np.cumsum(counts) * BLOB.itemsize).tolist()
        if not np.array_equal(self.rows, rows):
            self.rows = rows.copy()
            self.place = {row: k for k, row in enumerate(rows.tolist())}


class Encoders:
    """The encoders of a run, by group and message."""

    def __init__(self) -> None:
        self.known: dict[tuple[int, str], Encoder] = {}
        self.blobs: dict[int, BlobEncoder] = {}
        self.tick = 0

    def blobs_of(self, group: Group) -> BlobEncoder:
        """The encoder of a group of blobfinders."""
        if id(group) not in self.blobs:
            self.blobs[id(group)] = BlobEncoder(group)
        return self.blobs[id(group)]

    def get(self, group: Group, name: str) -> Encoder:
        """The encoder of a group for one kind of message."""
        key = (id(group), name)
        if key not in self.known:
            self.known[key] = Encoder(group, ENCODE[name])
        return self.known[key]


def encode_scans(group: Group) -> NDArray[Any]:
    """laser SCAN (subtype 1)."""
    scans: Any = group.readings
    n = scans.ranges.shape[1]
    rows = np.zeros(len(group.rows), scan_type(n))
    rows["min_angle"] = -scans.fov / 2
    rows["max_angle"] = scans.fov / 2
    rows["resolution"] = scans.resolution
    rows["max_range"] = scans.max_range
    rows["counts"] = n
    hit = wanted(group, scans.hits) >= 0
    rows["ranges"] = told(wanted(group, scans.ranges), hit, scans.max_range)
    return rows


def wanted(group: Group, array: NDArray[Any]) -> NDArray[Any]:
    """The wanted rows of one of a group's arrays, in their order; not to be written to."""
    return array if len(group.rows) == len(array) else array[group.rows]


def told(
    ranges: NDArray[np.float64],
    hit: NDArray[np.bool_],
    max_range: float,
    kind: str = "f4",
) -> NDArray[np.float64]:
    """Ranges as they are to travel: nothing that is hit reads `max_range`.

    What is hit at the end of the range, or is there by noise or by the rounding to the wire's
    `kind` of number, reads the next smaller number of that kind. So clients can tell it from
    where nothing is hit.
    """
    farthest = last_before(max_range, kind)
    late = ranges > farthest
    late &= hit
    return np.where(late, farthest, ranges) if late.any() else ranges


@cache
def last_before(max_range: float, kind: str) -> float:
    """The number of a kind before the one that `max_range` becomes on the wire."""
    with np.errstate(over="ignore"):
        end = np.array(max_range, kind)
        return float(np.nextafter(end, np.zeros((), kind)))


@cache
def scan_type(n: int) -> np.dtype[Any]:
    """The layout of a SCAN of n rays without intensities."""
    return np.dtype(
        [
            ("min_angle", ">f4"),
            ("max_angle", ">f4"),
            ("resolution", ">f4"),
            ("max_range", ">f4"),
            ("counts", ">u4", 2),
            ("ranges", ">f4", n),
            ("intensities", ">u4", 2),
            ("id", ">u4"),
        ]
    )


def encode_array(values: NDArray[np.float64], kind: str) -> NDArray[Any]:
    """Dynamic arrays, one per row: count, count, values."""
    n = values.shape[1]
    rows = np.zeros(len(values), np.dtype([("counts", ">u4", 2), ("values", kind, n)]))
    rows["counts"] = n
    rows["values"] = values
    return rows


def encode_ranges(group: Group) -> NDArray[Any]:
    """ranger RANGE (subtype 1)."""
    readings = group.readings
    assert isinstance(readings, Scans | Elements | Intensities)
    ranges = wanted(group, readings.ranges)
    if isinstance(readings, Scans):
        hit = wanted(group, readings.hits) >= 0
        ranges = told(ranges, hit, readings.max_range, "f8")
    return encode_array(ranges, ">f8")


def encode_intensities(group: Group) -> NDArray[Any]:
    """ranger INTNS (subtype 3): a scan's are 1 where it has hit something, 0 elsewhere."""
    readings = group.readings
    assert isinstance(readings, Scans | Intensities)
    if isinstance(readings, Scans):
        return encode_array((readings.hits[group.rows] >= 0).astype(np.float64), ">f8")
    return encode_array(readings.intensities[group.rows], ">f8")


def encode_sonar(group: Group) -> NDArray[Any]:
    """sonar RANGES (subtype 1)."""
    assert isinstance(group.readings, Elements)
    return encode_array(group.readings.ranges[group.rows], ">f4")


ENCODE: dict[str, Callable[[Group], NDArray[Any]]] = {
    "scans": encode_scans,
    "ranges": encode_ranges,
    "intensities": encode_intensities,
    "sonar": encode_sonar,
}
