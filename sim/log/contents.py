"""What is in a log, as arrays over ticks and robots, and as lists of what happened."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log import commands
from sim.log.cdr import decode
from sim.log.floor import rebuilt
from sim.log.layouts import Layout, layout
from sim.log.reader import LogReader
from sim.log.tick_messages import STATE, state_layout

STATES, SENT = "/troupe/state", "/troupe/commands"
COMMAND = np.dtype(
    [("tick", np.int64), ("time", float), ("robot", np.int64), ("mode", np.int64),
     ("motors", bool), *((name, float) for name in commands.NUMBERS)]
)  # fmt: skip
"""One command as carried out: see Commands.msg."""
PAINTED = np.dtype([(name, np.int64) for name in ("tick", "robot", "row", "column")])
"""A cell of the floor that a robot has painted; row 0 lies at y = 0, column 0 at x = 0."""
Span = tuple[int | None, int | None]
"""From and until when, ns of simulated time; None: from the start, to the end."""
ALL: Span = (None, None)


@dataclass(frozen=True)
class Entry:
    """A robot's entry: its tick and time (s), its pose x, y (m), yaw (rad), its name for ROS."""

    tick: int
    time: float
    robot: int
    name: str
    model: str
    pose: tuple[float, float, float]
    topic: str


def ticks_and_times(reader: LogReader, span: Span, interval: float) -> tuple[Any, Any]:
    """The ticks (t,) and their simulated times (t,) in s; only indexes are read."""
    parts = [entries["time"] for _, entries in reader.entries(STATES)]
    stamps = np.concatenate([np.zeros(0, np.uint64), *parts])
    if span[0] is not None:
        stamps = stamps[stamps >= span[0]]
    if span[1] is not None:
        stamps = stamps[stamps < span[1]]
    ticks = np.rint(stamps / (interval * 1e9)).astype(np.int64)
    return ticks, ticks * interval


def states(reader: LogReader, span: Span = ALL) -> Iterator[tuple[Layout, NDArray[np.uint8], int]]:
    """Runs of states that are alike: their layout, their bytes (k, size), how many robots."""
    for run in reader.runs(STATES, *span):
        first = decode(STATE, run.messages[0].tobytes())
        n, m = len(first["colors"]), len(first["movable_poses"]) // 3
        alike = state_layout(n, m)
        if alike.size != run.messages.shape[1]:
            raise reader.damaged("a state is not as it should be")
        yield alike, run.messages, n


def over_robots(
    reader: LogReader, field: str, width: int, robots: int, span: Span, fill: Any, dtype: Any
) -> NDArray[Any]:
    """A field of the states as (t, robots) or, where it has more numbers, (t, robots, width).

    `fill` stands where a robot has not entered yet.
    """
    parts = []
    for alike, messages, n in states(reader, span):
        part = np.full((len(messages), robots, width), fill, dtype)
        if n:
            part[:, :n] = alike.read(messages, field).reshape(len(messages), n, width)
        parts.append(part)
    found = np.concatenate([np.zeros((0, robots, width), dtype), *parts])
    return found[:, :, 0] if width == 1 else found


def over_ticks(reader: LogReader, field: str, span: Span) -> NDArray[Any]:
    """A field of the states that has one number for all: (t,)."""
    parts = [alike.read(messages, field)[:, 0] for alike, messages, _ in states(reader, span)]
    return np.concatenate([np.zeros(0), *parts])


def movables(reader: LogReader, span: Span) -> NDArray[np.float64]:
    """(t, m, 3) the poses of what can be pushed."""
    parts = []
    for alike, messages, _ in states(reader, span):
        if "movable_poses" in alike.places:
            parts.append(alike.read(messages, "movable_poses").reshape(len(messages), -1, 3))
        else:
            parts.append(np.zeros((len(messages), 0, 3)))
    return np.concatenate(parts) if parts else np.zeros((0, 0, 3))


def entries(reader: LogReader) -> list[Entry]:
    """All robots in the order in which they entered."""
    from sim.log.frames import ros_name  # noqa: PLC0415

    found: list[Entry] = []
    taken: list[str] = []
    for time, one in reader.messages("/troupe/entries"):
        x, y, yaw = one["pose"].tolist()
        taken.append(ros_name(one["name"], taken))
        found.append(
            Entry(
                one["tick"],
                time / 1e9,
                one["robot"],
                one["name"],
                one["model"],
                (x, y, yaw),
                taken[-1],
            )
        )
    return found


def sent(reader: LogReader, span: Span = ALL) -> NDArray[Any]:
    """(k,) of dtype COMMAND: the commands in the order in which they were carried out."""
    kind = reader.topics[SENT][1] if SENT in reader.topics else ""
    if kind == "troupe_msgs/Commands":
        return sent_tick_by_tick(reader, span)
    start, end = span
    interval = reader.number("interval")
    parts = [np.zeros(0, COMMAND)]
    # a message tells of a second: some of the one before may lie in the span
    for _, one in reader.messages(SENT, None if start is None else max(0, start - 10**9), end):
        rows = np.zeros(len(one["robots"]), COMMAND)
        rows["tick"], rows["time"] = one["ticks"], one["ticks"] * interval
        rows["robot"], rows["mode"], rows["motors"] = one["robots"], one["modes"], one["motors"]
        for name in commands.NUMBERS:
            if len(one[name]):
                rows[name] = one[name]
        stamps = np.rint(rows["time"] * 1e9)
        within = np.ones(len(rows), bool) if start is None else stamps >= start
        parts.append(rows[within if end is None else within & (stamps < end)])
    return np.concatenate(parts)


def sent_tick_by_tick(reader: LogReader, span: Span) -> NDArray[Any]:
    """The same of a log of format 1, which has a message for each tick with commands."""
    parts = [np.zeros(0, COMMAND)]
    for time, one in reader.messages(SENT, *span):
        rows = np.zeros(len(one["robots"]), COMMAND)
        rows["tick"], rows["time"] = one["tick"], time / 1e9
        rows["robot"], rows["mode"], rows["motors"] = one["robots"], one["modes"], one["motors"]
        values = one["values"].reshape(-1, len(commands.NUMBERS))
        for index, name in enumerate(commands.NUMBERS):
            rows[name] = values[:, index]
        parts.append(rows)
    return np.concatenate(parts)


def floor(reader: LogReader, until: int | None = None) -> NDArray[np.int16] | None:
    """(rows, columns) who painted each cell last, 1 + robot, before `until` (ns); None: nobody."""
    return rebuilt(one for _, one in reader.messages("/troupe/paint", None, until))


def painted(reader: LogReader, span: Span = ALL) -> NDArray[Any]:
    """(k,) of dtype PAINTED: which cells were painted by whom, where that changed."""
    parts = [np.zeros(0, PAINTED)]
    for _, one in reader.messages("/troupe/paint", *span):
        rows = np.zeros(len(one["cells"]), PAINTED)
        rows["tick"], rows["robot"] = one["tick"], one["owners"].astype(np.int64) - 1
        rows["row"], rows["column"] = np.divmod(one["cells"].astype(np.int64), one["columns"])
        parts.append(rows)
    return np.concatenate(parts)


def scan_arrays(
    reader: LogReader, topic: str, field: str, span: Span
) -> tuple[NDArray[np.float64], NDArray[np.float32], dict[str, Any] | None]:
    """Times (k,) in s and an array (k, samples) of a topic's messages, and the first of them."""
    times, rows, first = [], [], None
    for run in reader.runs(topic, *span):
        kind = reader.topics[topic][1]
        one = decode(kind, run.messages[0].tobytes())
        first = one if first is None else first
        as_first = layout(kind, one)
        if as_first.size != run.messages.shape[1]:
            raise reader.damaged("a reading is not as it should be")
        times.append(run.times / 1e9)
        rows.append(as_first.read(run.messages, field))
    if not rows:
        return np.zeros(0), np.zeros((0, 0), np.float32), None
    return np.concatenate(times), np.concatenate(rows), first
