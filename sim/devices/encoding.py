"""Readings and states of many robots, encoded together: bytes per group of equal sensors.

Rule: a message is encoded at most once a round of perceiving, when the first client of any robot
gets it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from player import layouts
from player.codes import Interface
from sensors.readings import Blobs, Elements, Intensities, Scans
from sensors.suite import Group

STATE = layouts.data(Interface.POSITION2D)
SCAN = layouts.data(Interface.LASER)
RANGES, INTENSITIES = layouts.data(Interface.RANGER, 1), layouts.data(Interface.RANGER, 3)
SONAR = layouts.data(Interface.SONAR)
BLOBS = layouts.data(Interface.BLOBFINDER)

Encode = Callable[[Group], tuple[Sequence[int], bytes]]
"""Encodes a group's wanted rows: where each one's message ends, and all of them in a row."""


class GroupEncoder:
    """One kind of message of a group's wanted rows, encoded when the first of a tick asks."""

    def __init__(self, group: Group, encode: Encode) -> None:
        self.group = group
        self.encode = encode
        self.round = -1
        self.ends: Sequence[int] = ()
        self.data = b""
        self.rows: NDArray[Any] = np.zeros(0, np.int64)
        self.places: dict[int, int] = {}  # of rows among those that are wanted

    def payload(self, row: int, round: int) -> bytes:
        """The message of one row of the group."""
        if round != self.round:
            self.ends, self.data = self.encode(self.group)
            if not np.array_equal(self.rows, self.group.rows):
                self.rows = self.group.rows.copy()
                self.places = {row: k for k, row in enumerate(self.rows.tolist())}
            self.round = round
        place = self.places[row]
        return self.data[self.ends[place - 1] if place else 0 : self.ends[place]]


class StateEncoder:
    """The state messages of all robots, encoded together once per tick."""

    def __init__(self) -> None:
        self.rows = STATE.rows(0)
        self.size = self.rows.itemsize
        self.data = b""

    def update(
        self,
        poses: NDArray[np.float64],
        velocities: NDArray[np.float64],
        stalls: NDArray[np.bool_],
    ) -> None:
        """Take odometry poses (n, 3), velocities in the robots' frames (n, 3), stalls (n,)."""
        if len(self.rows) != len(poses):
            self.rows = STATE.rows(len(poses))
        self.rows["pos"] = poses
        self.rows["vel"] = velocities
        self.rows["stall"] = stalls
        self.data = self.rows.tobytes()

    def payload(self, robot: int) -> bytes:
        """Robot's message."""
        return self.data[robot * self.size : (robot + 1) * self.size]


class Encodings:
    """All that is encoded in batches: the robots' states, and readings by group and message."""

    def __init__(self) -> None:
        self.states = StateEncoder()
        self.round = 0  # of perceiving: what is encoded belongs to one
        self.groups: dict[tuple[int, str], GroupEncoder] = {}

    def payload(self, group: Group, message: str, row: int) -> bytes:
        """One of the messages below, of one row of a group, as of this round."""
        encoder = self.groups.get((id(group), message))
        if encoder is None:
            encoder = GroupEncoder(group, ENCODE[message])
            self.groups[id(group), message] = encoder
        return encoder.payload(row, self.round)


def encode_scans(group: Group) -> NDArray[Any]:
    """laser SCAN (subtype 1)."""
    scans: Any = group.readings
    rows = SCAN.rows(len(group.rows), ranges=scans.ranges.shape[1], intensity=0)
    rows["min_angle"] = -scans.fov / 2
    rows["max_angle"] = scans.fov / 2
    rows["resolution"] = scans.resolution
    rows["max_range"] = scans.max_range
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


def encode_array(form: layouts.Form, values: NDArray[np.float64]) -> NDArray[Any]:
    """Messages of one array and nothing else, a row of values each."""
    [name] = form.arrays
    rows = form.rows(len(values), **{name: values.shape[1]})
    rows[name] = values
    return rows


def encode_ranges(group: Group) -> NDArray[Any]:
    """ranger RANGE (subtype 1)."""
    readings = group.readings
    assert isinstance(readings, Scans | Elements | Intensities)
    ranges = wanted(group, readings.ranges)
    if isinstance(readings, Scans):
        hit = wanted(group, readings.hits) >= 0
        ranges = told(ranges, hit, readings.max_range, "f8")
    return encode_array(RANGES, ranges)


def encode_intensities(group: Group) -> NDArray[Any]:
    """ranger INTNS (subtype 3): a scan's are 1 where it has hit something, 0 elsewhere."""
    readings = group.readings
    assert isinstance(readings, Scans | Intensities)
    if isinstance(readings, Scans):
        return encode_array(INTENSITIES, (readings.hits[group.rows] >= 0).astype(np.float64))
    return encode_array(INTENSITIES, readings.intensities[group.rows])


def encode_sonar(group: Group) -> NDArray[Any]:
    """sonar RANGES (subtype 1)."""
    assert isinstance(group.readings, Elements)
    return encode_array(SONAR, group.readings.ranges[group.rows])


def encode_blobs(group: Group) -> tuple[list[int], bytes]:
    """blobfinder BLOBS (subtype 1)."""
    readings = group.readings
    assert isinstance(readings, Blobs)
    counts = readings.counts[group.rows]
    most = int(counts.max(initial=0))
    held = np.arange(most) < counts[:, None]
    blobs = readings.blobs[group.rows, :most][held].astype(BLOBS.element).tobytes()
    head, size = BLOBS.head, BLOBS.element.itemsize
    parts, start = [], 0
    for count in counts.tolist():
        end = start + count * size
        parts += [head.pack(readings.width, readings.height, count, count), blobs[start:end]]
        start = end
    return np.cumsum(head.size + counts * size).tolist(), b"".join(parts)


def alike(encode: Callable[[Group], NDArray[Any]]) -> Encode:
    """Messages that are all of one length."""

    def encoded(group: Group) -> tuple[Sequence[int], bytes]:
        rows = encode(group)
        size = rows.dtype.itemsize
        return range(size, size * len(rows) + 1, size), rows.tobytes()

    return encoded


ENCODE: dict[str, Encode] = {
    "scans": alike(encode_scans),
    "ranges": alike(encode_ranges),
    "intensities": alike(encode_intensities),
    "sonar": alike(encode_sonar),
    "blobs": encode_blobs,
}
