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
from sensors.readings import BLOB, Blobs, Elements, Intensities, Scans
from sensors.suite import Group
from sim.devices.kernels import blob_words, write_ranges

STATE = layouts.data(Interface.POSITION2D)
SCAN = layouts.data(Interface.LASER)
RANGES, INTENSITIES = layouts.data(Interface.RANGER, 1), layouts.data(Interface.RANGER, 3)
SONAR = layouts.data(Interface.SONAR)
BLOBS = layouts.data(Interface.BLOBFINDER)


Encode = Callable[[Group], Sequence[bytes]]
"""Encodes a group's wanted rows: a message each."""


class GroupEncoder:
    """One kind of message of a group's wanted rows, encoded when the first of a tick asks."""

    def __init__(self, group: Group, encode: Encode) -> None:
        self.group = group
        self.encode = encode
        self.round = -1
        self.messages: Sequence[bytes] = ()
        self.rows: NDArray[Any] = np.zeros(0, np.int64)
        self.places: dict[int, int] = {}  # of rows among those that are wanted

    def payload(self, row: int, round: int) -> bytes:
        """The message of one row of the group."""
        if round != self.round:
            self.messages = self.encode(self.group)
            if self.rows is not self.group.rows:
                self.rows = self.group.rows  # another array where they are others: see Suite
                self.places = {row: k for k, row in enumerate(self.rows.tolist())}
            self.round = round
        return self.messages[self.places[row]]


class StateEncoder:
    """The state messages of all robots, encoded together when the first of a tick asks."""

    def __init__(self) -> None:
        self.rows = STATE.rows(0)
        self.size = self.rows.itemsize
        self.data: bytes | None = b""
        self.told: tuple[NDArray[Any], ...] = ()

    def update(
        self,
        poses: NDArray[np.float64],
        velocities: NDArray[np.float64],
        stalls: NDArray[np.bool_],
    ) -> None:
        """Take odometry poses (n, 3), velocities in the robots' frames (n, 3), stalls (n,)."""
        self.told = poses.copy(), velocities.copy(), stalls.copy()  # as they are now
        self.data = None

    def payload(self, robot: int) -> bytes:
        """Robot's message."""
        if self.data is None:
            poses, velocities, stalls = self.told
            if len(self.rows) != len(poses):
                self.rows = STATE.rows(len(poses))
            self.rows["pos"] = poses
            self.rows["vel"] = velocities
            self.rows["stall"] = stalls
            self.data = self.rows.tobytes()
        return self.data[robot * self.size : (robot + 1) * self.size]


class Encodings:
    """All that is encoded in batches: the robots' states, and readings by group and message."""

    def __init__(self) -> None:
        self.states = StateEncoder()
        self.round = 0  # of perceiving: what is encoded belongs to one
        self.groups: dict[tuple[int, str], GroupEncoder] = {}

    def encoder(self, group: Group, message: str) -> GroupEncoder:
        """What encodes one of the messages below, of a group's rows."""
        encoder = self.groups.get((id(group), message))
        if encoder is None:
            encoder = GroupEncoder(group, ENCODERS[message]())
            self.groups[id(group), message] = encoder
        return encoder


class ScanRows:
    """laser SCAN (subtype 1) of a group's rows: they lie ready, and their ranges are written."""

    def __init__(self) -> None:
        self.rows = SCAN.rows(0, ranges=0, intensity=0)
        self.words = np.zeros((0, 0), np.uint32)
        self.farthest = 0.0

    def __call__(self, group: Group) -> Sequence[bytes]:
        scans: Any = group.readings
        if len(self.rows) != len(group.rows):
            self.make(len(group.rows), scans)
        ranges = np.ascontiguousarray(scans.ranges, np.float64)  # of a sensor of one's own
        hits = np.ascontiguousarray(scans.hits, np.int32)
        write_ranges(ranges, hits, group.rows, self.farthest, self.words, SCAN.head.size // 4)
        return pieces(self.rows)

    def make(self, number: int, scans: Any) -> None:
        """All that never changes."""
        self.rows = rows = SCAN.rows(number, ranges=scans.ranges.shape[1], intensity=0)
        rows["min_angle"] = -scans.fov / 2
        rows["max_angle"] = scans.fov / 2
        rows["resolution"] = scans.resolution
        rows["max_range"] = scans.max_range
        self.words = rows.view(np.uint32).reshape(number, rows.itemsize // 4)
        self.farthest = last_before(scans.max_range, "f4")


def pieces(rows: NDArray[Any]) -> list[bytes]:
    """Each row's bytes."""
    size, data = rows.itemsize, rows.tobytes()
    return [data[start : start + size] for start in range(0, len(data), size)]


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


def plain(form: layouts.Form, values: Callable[[Group], NDArray[np.float64]]) -> Encode:
    """Encodes messages of one array and nothing else: a row of values each."""
    [name] = form.arrays

    def encode(group: Group) -> Sequence[bytes]:
        found = values(group)
        rows = form.rows(len(found), **{name: found.shape[1]})
        rows[name] = found
        return pieces(rows)

    return encode


def ranges(group: Group) -> NDArray[np.float64]:
    """What ranger RANGE (subtype 1) tells."""
    readings = group.readings
    assert isinstance(readings, Scans | Elements | Intensities)
    measured = wanted(group, readings.ranges)
    if isinstance(readings, Scans):
        hit = wanted(group, readings.hits) >= 0
        return told(measured, hit, readings.max_range, "f8")
    return measured


def intensities(group: Group) -> NDArray[np.float64]:
    """What ranger INTNS (subtype 3) tells: of a scan, 1 where it has hit something, 0 elsewhere."""
    readings = group.readings
    assert isinstance(readings, Scans | Intensities)
    if isinstance(readings, Scans):
        return (wanted(group, readings.hits) >= 0).astype(np.float64)
    return wanted(group, readings.intensities)


def sonar(group: Group) -> NDArray[np.float64]:
    """What sonar RANGES (subtype 1) tells."""
    assert isinstance(group.readings, Elements)
    return wanted(group, group.readings.ranges)


def encode_blobs(group: Group) -> Sequence[bytes]:
    """blobfinder BLOBS (subtype 1)."""
    readings = group.readings
    assert isinstance(readings, Blobs)
    blobs = np.ascontiguousarray(readings.blobs.T, BLOB)
    counts = np.ascontiguousarray(readings.counts, np.int64)
    data = blob_words(blobs, counts, group.rows).tobytes()
    head, size = BLOBS.head, BLOBS.element.itemsize
    messages, start = [], 0
    for count in wanted(group, counts).tolist():
        end = start + count * size
        messages.append(head.pack(readings.width, readings.height, count, count) + data[start:end])
        start = end
    return messages


ENCODERS: dict[str, Callable[[], Encode]] = {
    "scans": ScanRows,
    "ranges": lambda: plain(RANGES, ranges),
    "intensities": lambda: plain(INTENSITIES, intensities),
    "sonar": lambda: plain(SONAR, sonar),
    "blobs": lambda: encode_blobs,
}
