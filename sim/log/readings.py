"""What was sensed, as ROS 2's messages: scans, ranges, blobs, odometry."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from sim.log.blobs import cameras, write_blobs
from sim.log.container import Channels
from sim.log.forms import BYTES, COS, FLOATS, SIN, Form
from sim.log.frames import base
from sim.log.layouts import layout
from sim.log.memory import SINGLE
from sim.log.moment import Read
from sim.log.page import Page
from sim.log.stretches import Stretch
from sim.log.tape import Sheet

INFRARED = 1
"""sensor_msgs/Range's kind of what measures in a narrow cone."""
ROW = 24
"""Bytes of a robot's pose or velocity."""

Writer = Callable[[Page, Stretch], None]
"""Adds the messages of a stretch of rows to a page."""


def writer_of(form: Form) -> Writer:
    """The writer of messages of one size."""
    return lambda page, part: form.write(page, part.rows, part.ticks)


def by_lengths(
    texts: Sequence[Sequence[str]],
) -> Iterator[tuple[list[int], list[np.ndarray[Any, np.dtype[np.uint8]]]]]:
    """Members whose texts are of equal lengths: their numbers, and each text (members, length)."""
    groups: dict[tuple[int, ...], list[int]] = {}
    split = [[text.encode() for text in own] for own in texts]
    for number, own in enumerate(split):
        groups.setdefault(tuple(map(len, own)), []).append(number)
    for members in groups.values():
        yield (
            members,
            [
                np.array([list(split[one][place]) for one in members], np.uint8)
                for place in range(len(split[members[0]]))
            ],
        )


def odometry_forms(channels: Channels, sheet: Sheet) -> Iterator[Form]:
    """/NAME/odom of all robots: what each believes of its pose, and how fast it is."""
    names = sheet.names
    for members, (frames, children) in by_lengths([(f"{name}/odom", base(name)) for name in names]):
        like = {
            "header": {"frame_id": "x" * frames.shape[1]},
            "child_frame_id": "x" * children.shape[1],
        }
        topics = [f"/{names[one]}/odom" for one in members]
        numbers = [channels.channel(topic, "nav_msgs/Odometry") for topic in topics]
        form = Form(layout("nav_msgs/Odometry", like), numbers, members)
        form.stamp("header.stamp")
        form.text("header.frame_id", frames).text("child_frame_id", children)
        pose, speed = sheet.at["odometry"], sheet.at["velocities"]
        form.paste(FLOATS, "pose.pose.position.x", pose, stride=ROW)
        form.paste(FLOATS, "pose.pose.position.y", pose + 8, stride=ROW)
        form.paste(SIN, "pose.pose.orientation.z", pose + 16, stride=ROW)
        form.paste(COS, "pose.pose.orientation.w", pose + 16, stride=ROW)
        form.paste(FLOATS, "twist.twist.linear.x", speed, stride=ROW)
        form.paste(FLOATS, "twist.twist.linear.y", speed + 8, stride=ROW)
        form.paste(FLOATS, "twist.twist.angular.z", speed + 16, stride=ROW)
        yield form


def scan_writers(channels: Channels, sheet: Sheet, read: Read) -> Iterator[Writer]:
    """sensor_msgs/LaserScan; with what came back along the rays, where that is measured."""
    group, samples = read.group, read.group.samples
    own = [group.members[row] for row in read.rows]
    for members, (frames,) in by_lengths([(frame,) for _, frame in own]):
        like = {
            "header": {"frame_id": "x" * frames.shape[1]},
            "angle_min": -0.5 * group.fov if samples > 1 else 0.0,
            "angle_max": 0.5 * group.fov if samples > 1 else 0.0,
            "angle_increment": group.fov / max(samples - 1, 1),
            "range_min": group.min_range,
            "range_max": group.max_range,
            **{field: np.zeros(samples) for field in read.sources},
        }
        numbers = [channels.channel(own[one][0], "sensor_msgs/LaserScan") for one in members]
        form = Form(layout("sensor_msgs/LaserScan", like), numbers, members)
        form.stamp("header.stamp").text("header.frame_id", frames)
        for field, source in read.sources.items():
            at = sheet.at[source]
            form.paste(BYTES, field, at, step=SINGLE, stride=SINGLE * samples)
        yield writer_of(form)


def range_writers(channels: Channels, sheet: Sheet, read: Read) -> Iterator[Writer]:
    """sensor_msgs/Range: a message for each element of a ring."""
    group = read.group
    own = [
        (group.members[row][0], f"{group.members[row][1]}_{element}")
        for row in read.rows
        for element in range(group.samples)
    ]
    for members, (frames,) in by_lengths([(frame,) for _, frame in own]):
        like = {
            "header": {"frame_id": "x" * frames.shape[1]},
            "radiation_type": INFRARED,
            "field_of_view": group.fov,
            "min_range": group.min_range,
            "max_range": group.max_range,
        }
        numbers = [channels.channel(own[one][0], "sensor_msgs/Range") for one in members]
        form = Form(layout("sensor_msgs/Range", like), numbers, members)
        form.stamp("header.stamp").text("header.frame_id", frames)
        at = sheet.at[read.sources["ranges"]]
        form.paste(BYTES, "range", at, step=SINGLE, stride=SINGLE)
        yield writer_of(form)


def blob_writers(channels: Channels, sheet: Sheet, read: Read) -> Iterator[Writer]:
    """troupe_msgs/Blobs: as many as each camera sees."""
    own = [read.group.members[row] for row in read.rows]
    numbers = [channels.channel(topic, "troupe_msgs/Blobs") for topic, _ in own]
    seen_by = cameras(numbers, [frame for _, frame in own], *read.group.size)
    at = sheet.at[read.sources["blobs"]]
    yield lambda page, part: write_blobs(page, part, seen_by, at)


WRITERS: dict[str, Callable[[Channels, Sheet, Read], Iterator[Writer]]] = {
    "scan": scan_writers,
    "intensities": scan_writers,
    "elements": range_writers,
    "blobs": blob_writers,
}
"""What can be written of readings, by their kind."""
