"""Readings and states of many robots, encoded together: bytes per group of equal sensors.

Rule: a message is encoded at most once a round of perceiving, when the first client of any robot
gets it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from player import layouts
from player.codes import Interface
from sensors.readings import BLOB, Blobs, Elements, Intensities, Scans
from sensors.suite import Group
from sim.devices.batch import Batch
from sim.devices.kernels import write_blobs, write_ranges

STATE = layouts.data(Interface.POSITION2D)
SCAN = layouts.data(Interface.LASER)
RANGES, INTENSITIES = layouts.data(Interface.RANGER, 1), layouts.data(Interface.RANGER, 3)
SONAR = layouts.data(Interface.SONAR)
BLOBS = layouts.data(Interface.BLOBFINDER)
NOTHING = Batch(np.zeros(0, np.uint32), np.zeros(1, np.int64))


Encode = Callable[[Group], Batch]
"""Encodes a group's wanted rows: a message each."""


class GroupEncoder:
    """One kind of message of a group's wanted rows, encoded when the first of a tick asks."""

    def __init__(self, group: Group, encode: Encode) -> None:
        self.group = group
        self.encode = encode
        self.round = -1
        self.messages: Batch = NOTHING
        self.rows: NDArray[Any] = np.zeros(0, np.int64)
        self.places: dict[int, int] = {}  # of rows among those that are wanted

    def batch(self, round: int) -> Batch:
        """The messages of all that are wanted."""
        if round != self.round:
            self.messages = self.encode(self.group)
            if self.rows is not self.group.rows:
                self.rows = self.group.rows  # another array where they are others: see Suite
                self.places = {row: k for k, row in enumerate(self.rows.tolist())}
            self.round = round
        return self.messages

    def place(self, row: int) -> int:
        """Which of them is that of one row of the group."""
        return self.places[row]

    def payload(self, row: int, round: int) -> bytes:
        """The message of one row of the group."""
        return self.batch(round)[self.places[row]]


class StateEncoder:
    """The state messages of all robots, encoded together when the first of a tick asks."""

    def __init__(self) -> None:
        self.rows = STATE.rows(0)
        self.messages: Batch = NOTHING
        self.told: tuple[NDArray[Any], ...] | None = None

    def update(
        self,
        poses: NDArray[np.float64],
        velocities: NDArray[np.float64],
        stalls: NDArray[np.bool_],
    ) -> None:
        """Take odometry poses (n, 3), velocities in the robots' frames (n, 3), stalls (n,)."""
        self.told = poses.copy(), velocities.copy(), stalls.copy()  # as they are now

    def batch(self, round: int) -> Batch:
        """The messages of all robots."""
        if self.told is not None:
            poses, velocities, stalls = self.told
            if len(self.rows) != len(poses):
                self.rows = STATE.rows(len(poses))
                self.messages = Batch.of_rows(self.rows)
            self.rows["pos"] = poses
            self.rows["vel"] = velocities
            self.rows["stall"] = stalls
            self.told = None
        return self.messages

    def place(self, robot: int) -> int:
        """Which of them is a robot's."""
        return robot

    def payload(self, robot: int) -> bytes:
        """Robot's message."""
        return self.batch(0)[robot]


Encoder = GroupEncoder | StateEncoder


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
        self.messages = NOTHING
        self.words = np.zeros((0, 0), np.uint32)
        self.farthest = 0.0

    def __call__(self, group: Group) -> Batch:
        scans: Any = group.readings
        if len(self.messages) != len(group.rows):
            self.make(len(group.rows), scans)
        ranges = np.ascontiguousarray(scans.ranges, np.float64)  # of a sensor of one's own
        hits = np.ascontiguousarray(scans.hits, np.int32)
        write_ranges(ranges, hits, group.rows, self.farthest, self.words, SCAN.head.size // 4)
        return self.messages

    def make(self, number: int, scans: Any) -> None:
        """All that never changes."""
        rows = SCAN.rows(number, ranges=scans.ranges.shape[1], intensity=0)
        rows["min_angle"] = -scans.fov / 2
        rows["max_angle"] = scans.fov / 2
        rows["resolution"] = scans.resolution
        rows["max_range"] = scans.max_range
        self.messages = Batch.of_rows(rows)
        self.words = self.messages.words.reshape(number, rows.itemsize // 4)
        self.farthest = last_before(scans.max_range, "f4")


class BlobRows:
    """blobfinder BLOBS (subtype 1) of a group's rows."""

    def __init__(self) -> None:
        self.messages = NOTHING

    def __call__(self, group: Group) -> Batch:
        readings = group.readings
        assert isinstance(readings, Blobs)
        blobs = np.ascontiguousarray(readings.blobs.T, BLOB)
        counts = np.ascontiguousarray(readings.counts, np.int64)
        size = readings.width, readings.height
        messages = self.messages
        if len(messages) != len(group.rows):
            messages = self.make(len(group.rows), len(messages.words))
        needed = write_blobs(blobs, counts, group.rows, *size, messages.words, messages.starts)
        if needed > len(messages.words):
            messages = self.make(len(group.rows), 2 * needed)
            write_blobs(blobs, counts, group.rows, *size, messages.words, messages.starts)
        return messages

    def make(self, number: int, words: int) -> Batch:
        """Room for so many messages of so many words in all."""
        self.messages = Batch(np.zeros(words, np.uint32), np.zeros(number + 1, np.int64))
        return self.messages


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

    def encode(group: Group) -> Batch:
        found = values(group)
        rows = form.rows(len(found), **{name: found.shape[1]})
        rows[name] = found
        return Batch.of_rows(rows)

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


ENCODERS: dict[str, Callable[[], Encode]] = {
    "scans": ScanRows,
    "ranges": lambda: plain(RANGES, ranges),
    "intensities": lambda: plain(INTENSITIES, intensities),
    "sonar": lambda: plain(SONAR, sonar),
    "blobs": BlobRows,
}
