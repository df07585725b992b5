"""What was sensed, as ROS 2's messages: scans, ranges, blobs, odometry."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log.blocks import Block, block
from sim.log.cdr import Template, template
from sim.log.container import Channels
from sim.log.frames import base
from sim.log.moment import Fans, SensorGroup, TickState

BLOB_FIELDS = ("id", "color", "area", "x", "y", "left", "right", "top", "bottom", "range")
INFRARED = 1
"""sensor_msgs/Range's kind of what measures in a narrow cone."""

Stamps = tuple[NDArray[np.uint32], NDArray[np.uint64], NDArray[np.uint64], NDArray[np.uint64]]


@dataclass(frozen=True)
class SameLayout:
    """Messages of one layout that differ in texts and numbers, each on a channel of its own."""

    members: list[int]
    layout: Template
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
            members,
            template(kind, values[members[0]]),
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


def spread(alike: SameLayout, stamps: Stamps, values: dict[str, NDArray[Any]]) -> Block:
    """A block of one message for each tick and member, in this order; values (ticks * k, ...)."""
    numbers, nanoseconds, seconds, rest = stamps
    k, count = len(alike.members), len(numbers)
    filled = {
        "header.stamp.sec": np.repeat(seconds, k),
        "header.stamp.nanosec": np.repeat(rest, k),
        **{path: np.tile(text, (count, 1)) for path, text in alike.texts.items()},
        **values,
    }
    return block(
        alike.layout.filled(count * k, filled),
        np.tile(alike.channels, count),
        np.repeat(numbers, k),
        np.repeat(nanoseconds, k),
    )


def odometry_blocks(
    channels: Channels,
    memo: Memo,
    names: Sequence[str],
    ticks: Sequence[TickState],
    stamps: Stamps,
) -> list[Block]:
    """/NAME/odom of all robots: what each believes of its pose, and how fast it is."""

    def messages() -> tuple[list[dict[str, Any]], list[str]]:
        return [
            {"header": {"frame_id": f"{name}/odom"}, "child_frame_id": base(name)} for name in names
        ], [f"/{name}/odom" for name in names]

    poses = np.stack([state.odometry for state in ticks if state.odometry is not None])
    speeds = np.frombuffer(b"".join([state.velocities for state in ticks])).reshape(poses.shape)
    found = []
    paths = ("header.frame_id", "child_frame_id")
    for alike in by_layout(channels, memo, len(names), "nav_msgs/Odometry", messages, paths):
        pose = poses[:, alike.members].reshape(-1, 3)
        speed = speeds[:, alike.members].reshape(-1, 3)
        values = {
            "pose.pose.position.x": pose[:, 0],
            "pose.pose.position.y": pose[:, 1],
            "pose.pose.orientation.z": np.sin(0.5 * pose[:, 2]),
            "pose.pose.orientation.w": np.cos(0.5 * pose[:, 2]),
            "twist.twist.linear.x": speed[:, 0],
            "twist.twist.linear.y": speed[:, 1],
            "twist.twist.angular.z": speed[:, 2],
        }
        found.append(spread(alike, stamps, values))
    return found


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

    ranges = np.stack([fans.ranges for _, fans in same])
    back = np.stack([fans.intensities for _, fans in same]) if intense else ranges
    kind, path, stamps = "sensor_msgs/LaserScan", ("header.frame_id",), stamps_of(same)
    for alike in by_layout(channels, source.memo, rows.tobytes(), kind, messages, path):
        values = {"ranges": ranges[:, alike.members].reshape(-1, samples)}
        if intense:
            values["intensities"] = back[:, alike.members].reshape(-1, samples)
        yield spread(alike, stamps, values)


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
    kind, path, stamps = "sensor_msgs/Range", ("header.frame_id",), stamps_of(same)
    for alike in by_layout(channels, source.memo, rows.tobytes(), kind, messages, path):
        yield spread(alike, stamps, {"range": ranges[:, alike.members].reshape(-1)})


def blob_blocks(
    channels: Channels, source: SensorGroup, rows: NDArray[np.int64], same: Any
) -> Iterator[Block]:
    """troupe_msgs/Blobs: cameras that see equally many blobs have messages of one size."""
    kind, path, stamps = "troupe_msgs/Blobs", ("header.frame_id",), stamps_of(same)
    width, height = source.size

    def messages() -> tuple[list[dict[str, Any]], list[str]]:
        values = [
            {"header": {"frame_id": source.members[row][1]}, "width": width, "height": height}
            for row in rows.tolist()
        ]
        return values, [source.members[row][0] for row in rows.tolist()]

    counts = np.stack([fans.counts for _, fans in same])
    wide = max(fans.blobs.shape[1] for _, fans in same)
    blobs = np.zeros((len(same), len(rows), wide), same[0][1].blobs.dtype)
    for index, (_, fans) in enumerate(same):
        blobs[index, :, : fans.blobs.shape[1]] = fans.blobs
    for alike in by_layout(channels, source.memo, rows.tobytes(), kind, messages, path):
        members = np.array(alike.members)
        for count in np.unique(counts[:, members]).tolist():
            ticks, which = np.nonzero(counts[:, members] == count)
            frame = alike.texts[path[0]]
            head = {"frame_id": "x" * frame.shape[1]}
            like = {"header": head, "width": width, "height": height, "blobs": [{}] * count}
            values = {
                "header.stamp.sec": stamps[2][ticks],
                "header.stamp.nanosec": stamps[3][ticks],
                "header.frame_id": frame[which],
            }
            if count:
                seen = blobs[ticks, members[which], :count]
                values |= {f"blobs.{name}": seen[name] for name in BLOB_FIELDS}
            filled = blob_layout(source, count, like).filled(len(ticks), values)
            yield block(filled, alike.channels[which], stamps[0][ticks], stamps[1][ticks])


def blob_layout(source: SensorGroup, count: int, like: dict[str, Any]) -> Template:
    """The layout of messages of so many blobs, made once."""
    key = count, len(like["header"]["frame_id"])
    if key not in source.layouts:
        source.layouts[key] = template("troupe_msgs/Blobs", like)
    found: Template = source.layouts[key]
    return found


def stamps_of(same: Any) -> Stamps:
    """Ticks, and times as ns and as seconds and ns, of readings."""
    numbers = np.array([state.tick for state, _ in same], np.uint32)
    nanoseconds = np.rint(np.array([state.time for state, _ in same]) * 1e9).astype(np.uint64)
    return numbers, nanoseconds, nanoseconds // 10**9, nanoseconds % 10**9


WRITERS = {
    "scan": scan_blocks,
    "intensities": scan_blocks,
    "elements": range_blocks,
    "blobs": blob_blocks,
}
"""What can be written of readings, by their kind."""
