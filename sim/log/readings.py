"""What was sensed, as ROS 2's messages: scans, ranges, blobs, odometry."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sensors.readings import BLOB
from sim.log.blocks import Block
from sim.log.container import Channels
from sim.log.frames import base
from sim.log.layouts import Layout, Values, layout
from sim.log.moment import Fans, SensorGroup, TickState

BLOB_FIELDS = ("id", "color", "area", "x", "y", "left", "right", "top", "bottom", "range")
INFRARED = 1
"""sensor_msgs/Range's kind of what measures in a narrow cone."""


class Stamps(NamedTuple):
    """When messages were: arrays (t,)."""

    ticks: NDArray[np.uint64]
    ns: NDArray[np.uint64]
    """Simulated time; as whole seconds and the rest of it below."""
    seconds: NDArray[np.uint64]
    rest: NDArray[np.uint64]

    def at(self, which: NDArray[np.intp]) -> Stamps:
        """Some of them."""
        return Stamps(*(array[which] for array in self))


def stamps_of(ticks: Sequence[TickState]) -> Stamps:
    """The stamps of ticks."""
    numbers = np.array([state.tick for state in ticks], np.uint64)
    ns = np.rint(np.array([state.time for state in ticks]) * 1e9).astype(np.uint64)
    return Stamps(numbers, ns, ns // 10**9, ns % 10**9)


@dataclass(frozen=True)
class SameLayout:
    """Messages of one layout that differ in texts and numbers, each on a channel of its own."""

    members: slice | list[int]
    layout: Layout
    texts: dict[str, NDArray[np.uint8]]
    """By path: (k, length) bytes."""
    channels: NDArray[np.uint16]


Memo = dict[Hashable, list[SameLayout]]
MOST_KEPT = 64


def by_layout(
    channels: Channels,
    memo: Memo,
    key: Hashable,
    kind: str,
    messages: Callable[[], tuple[Sequence[dict[str, Any]], Sequence[str]]],
    paths: Sequence[str],
) -> list[SameLayout]:
    """Messages and their topics in groups of equal layout, which are laid out once for each key.

    messages() gives what all messages are like, and their topics; paths are of what differs.
    """
    if key in memo:
        return memo[key]
    values, topics = messages()
    split = [[text_at(value, path).encode() for path in paths] for value in values]
    groups: dict[tuple[int, ...], list[int]] = {}
    for index, found in enumerate(split):
        groups.setdefault(tuple(map(len, found)), []).append(index)
    if len(memo) >= MOST_KEPT:
        memo.clear()
    memo[key] = [
        SameLayout(
            slice(members[0], members[-1] + 1)
            if members[-1] - members[0] + 1 == len(members)
            else members,
            layout(kind, values[members[0]]),
            {
                path: np.array([list(split[one][place]) for one in members], np.uint8)
                for place, path in enumerate(paths)
            },
            np.array([channels.channel(topics[one], kind) for one in members], np.uint16),
        )
        for members in groups.values()
    ]
    return memo[key]


def text_at(value: dict[str, Any], path: str) -> str:
    for key in path.split("."):
        value = value[key]
    return str(value)


def spread(alike: SameLayout, when: Stamps, values: Mapping[str, Values]) -> Block:
    """One message for each stamp and member, in this order; values of (t, k, ...)."""
    filled = {
        "header.stamp.sec": when.seconds[:, None, None],
        "header.stamp.nanosec": when.rest[:, None, None],
        **alike.texts,
        **values,
    }
    shape = len(when.ns), len(alike.channels)
    return Block(alike.layout, shape, alike.channels, when.ns[:, None], filled)


def odometry_blocks(
    channels: Channels,
    memo: Memo,
    names: Sequence[str],
    ticks: Sequence[TickState],
    when: Stamps,
) -> list[Block]:
    """/NAME/odom of all robots: what each believes of its pose, and how fast it is."""

    def messages() -> tuple[list[dict[str, Any]], list[str]]:
        return [
            {"header": {"frame_id": f"{name}/odom"}, "child_frame_id": base(name)} for name in names
        ], [f"/{name}/odom" for name in names]

    poses = np.stack([state.odometry for state in ticks if state.odometry is not None])
    speeds = np.frombuffer(b"".join([state.velocities for state in ticks])).reshape(poses.shape)
    half = 0.5 * poses[..., 2]
    fields = {
        "pose.pose.position.x": poses[..., 0],
        "pose.pose.position.y": poses[..., 1],
        "pose.pose.orientation.z": np.sin(half),
        "pose.pose.orientation.w": np.cos(half),
        "twist.twist.linear.x": speeds[..., 0],
        "twist.twist.linear.y": speeds[..., 1],
        "twist.twist.angular.z": speeds[..., 2],
    }
    paths = ("header.frame_id", "child_frame_id")
    return [
        spread(alike, when, {path: all_[:, alike.members, None] for path, all_ in fields.items()})
        for alike in by_layout(channels, memo, len(names), "nav_msgs/Odometry", messages, paths)
    ]


def reading_blocks(channels: Channels, ticks: Sequence[TickState]) -> list[Block]:
    """The readings of all sensors that were sensed in these ticks."""
    together: dict[tuple[int, bytes], list[tuple[TickState, Fans]]] = {}
    for state in ticks:
        for fans in state.fans:
            key = id(fans.source), fans.rows.tobytes()
            together.setdefault(key, []).append((state, fans))
    found: list[Block] = []
    for same in together.values():
        source, rows = same[0][1].source, same[0][1].rows
        if len(rows):
            found += WRITERS[source.kind](channels, source, rows, same)
    return found


def scan_blocks(
    channels: Channels, source: SensorGroup, rows: NDArray[np.int64], same: Any
) -> Iterator[Block]:
    """sensor_msgs/LaserScan; with what came back along the rays, where that is measured."""
    samples = source.samples
    intense = same[0][1].intensities is not None

    def messages() -> tuple[list[dict[str, Any]], list[str]]:
        values = [
            {
                "header": {"frame_id": source.members[row][1]},
                "angle_min": -0.5 * source.fov if samples > 1 else 0.0,
                "angle_max": 0.5 * source.fov if samples > 1 else 0.0,
                "angle_increment": source.fov / max(samples - 1, 1),
                "range_min": source.min_range,
                "range_max": source.max_range,
                "ranges": np.zeros(samples),
                "intensities": np.zeros(samples if intense else 0),
            }
            for row in rows.tolist()
        ]
        return values, [source.members[row][0] for row in rows.tolist()]

    kind, path = "sensor_msgs/LaserScan", ("header.frame_id",)
    when = stamps_of([state for state, _ in same])
    for alike in by_layout(channels, source.memo, rows.tobytes(), kind, messages, path):
        values = {"ranges": [fans.ranges[alike.members] for _, fans in same]}
        if intense:
            values["intensities"] = [fans.intensities[alike.members] for _, fans in same]
        yield spread(alike, when, values)


def range_blocks(
    channels: Channels, source: SensorGroup, rows: NDArray[np.int64], same: Any
) -> Iterator[Block]:
    """sensor_msgs/Range: a message for each element of a ring."""

    def messages() -> tuple[list[dict[str, Any]], list[str]]:
        values = [
            {
                "header": {"frame_id": f"{source.members[row][1]}_{element}"},
                "radiation_type": INFRARED,
                "field_of_view": source.fov,
                "min_range": source.min_range,
                "max_range": source.max_range,
            }
            for row in rows.tolist()
            for element in range(source.samples)
        ]
        return values, [source.members[row][0] for row in rows for _ in range(source.samples)]

    ranges = np.stack([fans.ranges for _, fans in same]).reshape(len(same), -1)
    kind, path = "sensor_msgs/Range", ("header.frame_id",)
    when = stamps_of([state for state, _ in same])
    for alike in by_layout(channels, source.memo, rows.tobytes(), kind, messages, path):
        yield spread(alike, when, {"range": ranges[:, alike.members, None]})


def blob_blocks(
    channels: Channels, source: SensorGroup, rows: NDArray[np.int64], same: Any
) -> Iterator[Block]:
    """troupe_msgs/Blobs: cameras that see equally many blobs have messages of one size."""
    kind, path = "troupe_msgs/Blobs", ("header.frame_id",)
    when = stamps_of([state for state, _ in same])
    width, height = source.size

    def messages() -> tuple[list[dict[str, Any]], list[str]]:
        values = [
            {"header": {"frame_id": source.members[row][1]}, "width": width, "height": height}
            for row in rows.tolist()
        ]
        return values, [source.members[row][0] for row in rows.tolist()]

    counts = np.stack([fans.counts for _, fans in same])
    blobs = np.frombuffer(b"".join([fans.blobs for _, fans in same]), BLOB)
    firsts = (np.cumsum(counts) - counts.reshape(-1)).reshape(counts.shape)
    for alike in by_layout(channels, source.memo, rows.tobytes(), kind, messages, path):
        own, own_firsts = counts[:, alike.members], firsts[:, alike.members]
        frame = alike.texts[path[0]]
        for count in np.unique(own).tolist():
            ticks, which = np.nonzero(own == count)
            part = when.at(ticks)
            head = {"frame_id": "x" * frame.shape[1]}
            like = {"header": head, "width": width, "height": height, "blobs": [{}] * count}
            values: dict[str, Values] = {
                "header.stamp.sec": part.seconds[:, None],
                "header.stamp.nanosec": part.rest[:, None],
                "header.frame_id": frame[which],
            }
            if count:
                these = blobs.take(own_firsts[ticks, which, None] + np.arange(count))
                values |= {f"blobs.{name}": these[name] for name in BLOB_FIELDS}
            one = blob_layout(source, count, like)
            yield Block(one, (len(ticks),), alike.channels[which], part.ns, values)


def blob_layout(source: SensorGroup, count: int, like: dict[str, Any]) -> Layout:
    """The layout of messages of so many blobs, made once."""
    key = count, len(like["header"]["frame_id"])
    if key not in source.layouts:
        source.layouts[key] = layout("troupe_msgs/Blobs", like)
    found: Layout = source.layouts[key]
    return found


WRITERS = {
    "scan": scan_blocks,
    "intensities": scan_blocks,
    "elements": range_blocks,
    "blobs": blob_blocks,
}
"""What can be written of readings, by their kind."""
