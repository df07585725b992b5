"""Messages that are pasted together by numpy are those that are encoded field by field."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.log.blocks import Block, message_indexes
from sim.log.cdr import decode, encode
from sim.log.layouts import layout

NAMES = st.lists(st.text("abcdefghij", min_size=1, max_size=9), min_size=1, max_size=6)
BEFORE = 31
"""Bytes of a record in front of its message."""


def records(block: Block) -> list[bytes]:
    """The messages that a block writes, with CDR's head."""
    out = np.zeros(block.count * block.record, np.uint8)
    block.write(out)
    return [row[BEFORE:].tobytes() for row in out.reshape(-1, block.record)]


@given(names=NAMES, ticks=st.integers(1, 4), seed=st.integers(0, 99))
@settings(max_examples=40, deadline=None)
def test_transforms_of_robots_with_names_of_any_length_are_as_encoded(
    names: list[str], ticks: int, seed: int
) -> None:
    x = np.random.default_rng(seed).normal(size=(ticks, len(names)))
    like = {"transforms": [{"header": {"frame_id": "map"}, "child_frame_id": n} for n in names]}
    one = layout("tf2_msgs/TFMessage", like)
    values = {
        "transforms.header.stamp.sec": np.arange(ticks)[:, None],
        "transforms.transform.rotation.w": x,
    }
    stamps = np.zeros(ticks, np.uint64)
    written = records(Block(one, (ticks,), np.array(1, np.uint16), stamps, values))
    for tick, message in enumerate(written):
        entries = [
            {
                "header": {"stamp": {"sec": tick}, "frame_id": "map"},
                "child_frame_id": name,
                "transform": {"rotation": {"w": float(turn)}},
            }
            for name, turn in zip(names, x[tick], strict=True)
        ]
        assert message == encode("tf2_msgs/TFMessage", {"transforms": entries})
    rows = np.array([list(message) for message in written], np.uint8)
    assert one.read(rows, "transforms.transform.rotation.w").tobytes() == x.tobytes()


@given(count=st.integers(0, 5), frame=st.text("xyz", min_size=1, max_size=9))
@settings(max_examples=30, deadline=None)
def test_blobs_behind_a_frame_of_any_length_are_as_encoded(count: int, frame: str) -> None:
    like = {"header": {"frame_id": frame}, "width": 9, "blobs": [{}] * count}
    values = {
        "blobs.id": np.arange(count)[None] + 5,
        "blobs.range": np.arange(count)[None] / 7.0,
    }
    one = layout("troupe_msgs/Blobs", like)
    block = Block(
        one, (1,), np.array(1, np.uint16), np.zeros(1, np.uint64), values if count else {}
    )
    seen = [{"id": k + 5, "range": k / 7.0} for k in range(count)]
    (message,) = records(block)
    assert message == encode("troupe_msgs/Blobs", {**like, "blobs": seen})
    assert [blob["id"] for blob in decode("troupe_msgs/Blobs", message)["blobs"]] == [
        one["id"] for one in seen
    ]


def test_values_of_many_members_are_given_for_each_or_for_all() -> None:
    one = layout("geometry_msgs/Twist", {})
    ticks, members = 2, 3
    values = {
        "linear.x": np.arange(6.0).reshape(ticks, members, 1),
        "linear.y": [np.full((members, 1), 7.0), np.full((members, 1), 8.0)],
        "angular.z": np.array([[[9.0]]]),
    }
    shape, stamps = (ticks, members), np.array([[5], [6]], np.uint64)
    written = records(Block(one, shape, np.array([1, 2, 3], np.uint16), stamps, values))
    told = [decode("geometry_msgs/Twist", message) for message in written]
    assert [one["linear"]["x"] for one in told] == [0, 1, 2, 3, 4, 5]
    assert [one["linear"]["y"] for one in told] == [7, 7, 7, 8, 8, 8]
    assert {one["angular"]["z"] for one in told} == {9}


@given(channels=st.lists(st.integers(1, 9), min_size=1, max_size=40), seed=st.integers(0, 9))
def test_an_index_has_each_message_once_at_its_channel_in_the_order_of_time(
    channels: list[int], seed: int
) -> None:
    times = np.random.default_rng(seed).integers(0, 20, len(channels)).astype(np.uint64)
    offsets = np.arange(len(channels), dtype=np.uint64) * 100
    found = message_indexes(np.array(channels, np.uint16), times, offsets)
    assert dict(zip(found.places["channel"].tolist(), found.counts.tolist(), strict=True)) == {
        one: channels.count(one) for one in set(channels)
    }
    told = []
    for channel, at in found.places.tolist():
        size = int.from_bytes(found.records[at + 1 : at + 9], "little")
        own = np.frombuffer(found.records, "<u8", (size - 6) // 8, at + 15).reshape(-1, 2)
        assert int.from_bytes(found.records[at + 9 : at + 11], "little") == channel
        assert (np.diff(own[:, 0].astype(int)) >= 0).all()
        told += [(channel, *entry) for entry in own.tolist()]
    assert sorted(told) == sorted(zip(channels, times.tolist(), offsets.tolist(), strict=True))
