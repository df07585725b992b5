"""Messages that are pasted together in compiled code are those that are encoded field by field."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from sensors.readings import BLOB
from sim.log import commands
from sim.log.blobs import cameras, write_blobs
from sim.log.cdr import decode, encode
from sim.log.forms import FLOATS, Form
from sim.log.layouts import layout
from sim.log.page import Page, message_indexes
from sim.log.stretches import stretch, write_clock
from sim.log.tape import BLOBS, Sheet, Source, Tape
from sim.log.tellings import commanded, write_commands, write_twists
from sim.stage.records import MOVER

NAMES = st.lists(st.text("abcdefghij", min_size=1, max_size=9), min_size=1, max_size=6)
BEFORE = 31
"""Bytes of a record in front of its message."""
ROOM = 1 << 20
TWIST = "geometry_msgs/Twist"


def messages(page: Page) -> list[tuple[int, int, bytes]]:
    """Channel, log time and data of each record of a page, which has them one after the other."""
    found, at = [], 0
    data = page.memory[: page.size].tobytes()
    for time, offset, channel in page.notes[: page.count].tolist():
        assert offset == at
        size = int.from_bytes(data[at + 1 : at + 9], "little")
        assert data[at] == 5
        assert int.from_bytes(data[at + 9 : at + 11], "little") == channel
        for place in (15, 23):
            assert int.from_bytes(data[at + place : at + place + 8], "little") == time
        found.append((channel, time, data[at + BEFORE : at + 9 + size]))
        at += 9 + size
    assert at == page.size
    return found


def noted(sheet: Sheet, ticks: int, change: Any) -> Tape:
    """A tape with so many rows; change(tick) sets the arrays before each. A tick takes 0.3 s."""
    tape = Tape(sheet, np.zeros(ROOM, np.uint8))
    for tick in range(1, ticks + 1):
        change(tick)
        assert tape.note(tick, tick * 0.3, 0.0, True) >= 0
    return tape


def stamp(tick: int) -> dict[str, int]:
    ns = round(tick * 0.3 * 1e9)
    return {"sec": ns // 10**9, "nanosec": ns % 10**9}


@given(names=NAMES, ticks=st.integers(1, 4), seed=st.integers(0, 99))
@settings(max_examples=40, deadline=None)
def test_transforms_of_robots_with_names_of_any_length_are_as_encoded(
    names: list[str], ticks: int, seed: int
) -> None:
    x = np.random.default_rng(seed).normal(size=(ticks, len(names)))
    like = {"transforms": [{"header": {"frame_id": "map"}, "child_frame_id": n} for n in names]}
    array = np.zeros(len(names))
    sheet = Sheet(names, [Source("x", array)], np.zeros(0, MOVER), commands.fresh(0))

    def change(tick: int) -> None:
        array[:] = x[tick - 1]

    tape = noted(sheet, ticks, change)
    form = Form(layout("tf2_msgs/TFMessage", like), [7])
    form.stamp("transforms.header.stamp")
    form.paste(FLOATS, "transforms.transform.rotation.w", sheet.at["x"])
    page, part = Page(), stretch(tape.base, 0, tape.end)
    form.write(page, part.rows, part.ticks)
    written = messages(page)
    for tick, (channel, _, message) in enumerate(written, 1):
        entries = [
            {
                "header": {"stamp": stamp(tick), "frame_id": "map"},
                "child_frame_id": name,
                "transform": {"rotation": {"w": float(turn)}},
            }
            for name, turn in zip(names, x[tick - 1], strict=True)
        ]
        assert (channel, message) == (7, encode("tf2_msgs/TFMessage", {"transforms": entries}))
    rows = np.array([list(message) for _, _, message in written], np.uint8)
    read = form.layout.read(rows, "transforms.transform.rotation.w")
    assert read.tobytes() == x.tobytes()


@given(
    counts=st.lists(st.lists(st.integers(0, 5), min_size=2, max_size=2), min_size=1, max_size=4),
    frames=st.lists(st.text("xyz", min_size=1, max_size=9), min_size=2, max_size=2),
)
@settings(max_examples=40, deadline=None)
def test_blobs_of_any_number_behind_frames_of_any_length_are_as_encoded(
    counts: list[list[int]], frames: list[str]
) -> None:
    blobs, seen = np.zeros((2, 6), BLOB), np.zeros(2, np.int64)
    blobs["id"], blobs["range"] = 5 + np.arange(6), np.arange(12).reshape(2, 6) / 7.0
    source = Source("blobs", np.ascontiguousarray(blobs.T), BLOBS, None, seen)
    sheet = Sheet([], [source], np.zeros(0, MOVER), commands.fresh(0))

    def change(tick: int) -> None:
        seen[:] = counts[tick - 1]

    tape = noted(sheet, len(counts), change)
    page, part = Page(), stretch(tape.base, 0, tape.end)
    write_blobs(page, part, cameras([3, 4], frames, 160, 120), sheet.at["blobs"])
    expected = [
        (
            3 + k,
            encode(
                "troupe_msgs/Blobs",
                {
                    "header": {"stamp": stamp(tick), "frame_id": frames[k]},
                    "width": 160,
                    "height": 120,
                    "blobs": [
                        {"id": 5 + j, "range": (6 * k + j) / 7.0}
                        for j in range(counts[tick - 1][k])
                    ],
                },
            ),
        )
        for tick in range(1, len(counts) + 1)
        for k in range(2)
    ]
    assert [(channel, message) for channel, _, message in messages(page)] == expected


Told = list[list[tuple[int, float, float]]]


@given(
    told=st.lists(
        st.lists(
            st.tuples(
                st.integers(0, 2),
                st.sampled_from([0.0, 0.5, 1.0]),
                st.sampled_from([0.0, -0.0, 0.3]),
            ),
            max_size=3,
        ),
        min_size=1,
        max_size=12,
    )
)
@settings(max_examples=60, deadline=None)
def test_commands_of_a_second_are_one_message_and_as_encoded(told: Told) -> None:
    movers = np.zeros(3, MOVER)
    movers["motors"] = True
    sheet = Sheet(["a", "b", "c"], [], movers, commands.fresh(3))
    known = [(0.0, 0.0)] * 3
    expected: dict[int, list[tuple[int, int, float, float]]] = {}

    def change(tick: int) -> None:
        for robot, vx, wz in told[tick - 1]:
            movers["vx"][robot], movers["wz"][robot] = vx, wz
        for robot in range(3):
            now = float(movers["vx"][robot]), float(movers["wz"][robot])
            if now != known[robot]:
                known[robot] = now
                second = stamp(tick)["sec"]
                expected.setdefault(second, []).append((tick, robot, *now))

    tape = noted(sheet, len(told), change)
    page, part = Page(), stretch(tape.base, 0, tape.end)
    write_commands(page, part, 5)
    found = messages(page)
    assert part.commands == sum(map(len, expected.values()))
    assert len(found) == part.seconds == len(expected)
    for (_, time, message), rows in zip(found, expected.values(), strict=True):
        ticks, robots, vx, wz = (list(column) for column in zip(*rows, strict=True))
        values: dict[str, Any] = {"ticks": ticks, "robots": robots, "modes": [0] * len(rows)}
        for name, column in (("vx", vx), ("wz", wz)):
            if np.array(column).tobytes().strip(b"\0"):
                values[name] = column
        values |= {"stamp": stamp(ticks[0]), "motors": [True] * len(rows)}
        assert time == round(ticks[0] * 0.3 * 1e9)
        assert message == encode("troupe_msgs/CommandColumns", values)
    twists = Page()
    write_twists(twists, part, np.array([11, 12, 13]))
    all_ = [row for rows in expected.values() for row in rows]
    assert [(channel, decode(TWIST, message)) for channel, _, message in messages(twists)] == [
        (
            11 + robot,
            {
                "linear": {"x": vx, "y": 0.0, "z": 0.0},
                "angular": {"x": 0.0, "y": 0.0, "z": wz},
            },
        )
        for _, robot, vx, wz in all_
    ]
    assert commanded(part, 3).tolist() == sorted({robot for _, robot, _, _ in all_})


def test_the_clock_tells_of_the_first_tick_of_every_second() -> None:
    sheet = Sheet([], [], np.zeros(0, MOVER), commands.fresh(0))
    tape = noted(sheet, 8, lambda tick: None)
    page = Page()
    middle = 3 * (tape.end // 8)
    second = write_clock(page, stretch(tape.base, 0, middle), 1, -1)
    second = write_clock(page, stretch(tape.base, middle, tape.end), 1, second)
    assert second == 2
    told = [decode("rosgraph_msgs/Clock", message)["clock"] for _, _, message in messages(page)]
    assert [(one["sec"], one["nanosec"]) for one in told] == [
        (0, 300_000_000), (1, 200_000_000), (2, 100_000_000),
    ]  # fmt: skip


@given(channels=st.lists(st.integers(1, 9), min_size=1, max_size=40), seed=st.integers(0, 9))
def test_an_index_has_each_message_once_at_its_channel_in_the_order_of_time(
    channels: list[int], seed: int
) -> None:
    times: NDArray[np.int64] = np.random.default_rng(seed).integers(0, 20, len(channels))
    offsets = np.arange(len(channels)) * 100
    found = message_indexes(np.array(channels, np.uint16), times, offsets)
    assert dict(zip(found.places["channel"].tolist(), found.counts.tolist(), strict=True)) == {
        one: channels.count(one) for one in set(channels)
    }
    assert (found.start, found.end) == (times.min(), times.max())
    told = []
    records = found.records.tobytes()
    for channel, at in found.places.tolist():
        size = int.from_bytes(records[at + 1 : at + 9], "little")
        own = np.frombuffer(records, "<u8", (size - 6) // 8, at + 15).reshape(-1, 2)
        assert int.from_bytes(records[at + 9 : at + 11], "little") == channel
        assert (np.diff(own[:, 0].astype(int)) >= 0).all()
        told += [(channel, *entry) for entry in own.tolist()]
    assert sorted(told) == sorted(zip(channels, times.tolist(), offsets.tolist(), strict=True))
