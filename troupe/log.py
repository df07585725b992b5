"""`troupe.Log`: a run that was kept, as arrays over ticks and robots, read when asked for."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.log import contents
from sim.log.errors import LogError
from sim.log.reader import LogReader
from troupe.usage import UsageError

if TYPE_CHECKING:
    import pandas as pd

    from sim.build import LoadedWorld

__all__ = ["Log", "LogError"]

Floats = NDArray[np.float64]
LATEST = 2.0**62
"""Nanoseconds that no log comes to."""


class Said(NamedTuple):
    """What a robot said, when (s)."""

    time: float
    robot: str
    text: str


class Reported(NamedTuple):
    """A property that a robot set on itself, when (s)."""

    time: float
    robot: str
    key: str
    value: Any


class Touch(NamedTuple):
    """A robot began to touch something: when (s), and at which point (x, y) in m."""

    time: float
    robot: str
    point: tuple[float, float]


class Line(NamedTuple):
    """A line for people, a controller's output among them: when (s), who, and what."""

    time: float
    who: str
    text: str


class Driven(NamedTuple):
    """A controller's state has changed: when (s), whose, to what, and why."""

    time: float
    robot: str
    state: str
    exit_code: int | None
    error: str | None


@dataclass(frozen=True)
class Scans:
    """Readings of one sensor: times (k,) in s, ranges (k, samples) in m, bearings (samples,)."""

    times: Floats
    ranges: NDArray[np.float32]
    bearings: Floats


class Log:
    """A log of a run: `troupe.Log("run.mcap")`.

    `log[10.0:20.0]` is the part of it from 10 s until before 20 s of simulated time. Arrays are
    over the ticks of that part and over all robots of the log, in the order in which they entered;
    NaN, or 0, stands where a robot has not entered yet. Each is read when it is asked for. Metres,
    seconds, radians, as everywhere.

    Raises:
        LogError: the file is no log, was cut off, or is of a later version of Troupe.
    """

    def __init__(self, path: str | Path) -> None:
        self._reader = LogReader(Path(path))
        self._span: contents.Span = contents.ALL
        self._whole = self

    def __getitem__(self, seconds: slice) -> Log:
        if not isinstance(seconds, slice) or seconds.step is not None:
            raise TypeError("a part of a log is log[from:until], in seconds")
        part = object.__new__(Log)
        part._reader = self._reader
        part._whole = self._whole
        part._span = (
            later(self._span[0], nanoseconds(seconds.start)),
            earlier(self._span[1], nanoseconds(seconds.stop)),
        )
        return part

    def __len__(self) -> int:
        """Ticks in this part."""
        return len(self.ticks)

    # --- what ran

    @property
    def path(self) -> Path:
        """The file."""
        return self._reader.path

    @property
    def about(self) -> dict[str, str]:
        """What ran: world, title, seed, duration, interval, settings, versions, machine."""
        return dict(self._reader.about)

    @property
    def seed(self) -> int:
        """The seed of the run."""
        return self._reader.whole("seed")

    @property
    def interval(self) -> float:
        """Seconds of a tick."""
        return self._reader.number("interval")

    @cached_property
    def result(self) -> dict[str, Any] | None:
        """The result as `troupe run --json` prints it; None where the run was killed before."""
        data = self._reader.attachment("result.json")
        return None if data is None else json.loads(data)

    @cached_property
    def world(self) -> LoadedWorld:
        """The world, loaded again from the log, without its programs."""
        from sim.log.world import loaded_again  # noqa: PLC0415

        return loaded_again(self._reader.attachments(), self.path)

    @cached_property
    def entries(self) -> list[contents.Entry]:
        """Of every robot: when it entered, its name, model and pose."""
        if self._whole is not self:
            return self._whole.entries  # which are read once for all parts
        return contents.entries(self._reader)

    @property
    def robots(self) -> list[str]:
        """The robots' names."""
        return [entry.name for entry in self.entries]

    # --- over ticks

    @cached_property
    def _ticks(self) -> tuple[NDArray[np.int64], Floats]:
        return contents.ticks_and_times(self._reader, self._span, self.interval)

    @property
    def ticks(self) -> NDArray[np.int64]:
        """(t,) the ticks, from 1."""
        return self._ticks[0]

    @property
    def times(self) -> Floats:
        """(t,) simulated seconds at the ends of the ticks."""
        return self._ticks[1]

    @property
    def poses(self) -> Floats:
        """(t, n, 3) x, y, yaw, exactly as the run had them."""
        return self._over_robots("poses", 3, np.nan, float)

    @property
    def velocities(self) -> NDArray[np.float32]:
        """(t, n, 3) vx, vy, wz in the robots' frames, rounded to a millionth."""
        return self._over_robots("velocities", 3, np.nan, np.float32)

    @property
    def stalls(self) -> NDArray[np.bool_]:
        """(t, n) whether each was kept from what it wanted to do."""
        return self._over_robots("stalls", 1, False, bool)

    @property
    def contacts(self) -> NDArray[np.int64]:
        """(t, n) how often each had begun to touch another body or a wall."""
        return self._over_robots("contacts", 1, 0, np.int64)

    @property
    def colors(self) -> NDArray[np.int64]:
        """(t, n) 0xRRGGBB."""
        return self._over_robots("colors", 1, 0, np.int64)

    @property
    def coverage(self) -> Floats:
        """(t,) the painted share of the floor; NaN where nothing was painted yet."""
        return contents.over_ticks(self._reader, "coverage", self._span)

    @property
    def movable_poses(self) -> Floats:
        """(t, m, 3) x, y, yaw of the obstacles that can be pushed."""
        return contents.movables(self._reader, self._span)

    def _over_robots(self, field: str, width: int, fill: Any, dtype: Any) -> NDArray[Any]:
        robots = len(self.entries)
        return contents.over_robots(self._reader, field, width, robots, self._span, fill, dtype)

    # --- what happened

    @property
    def said(self) -> list[Said]:
        """What robots said, in the order of time."""
        found = [Said(m["time"], m["name"], m["text"]) for m in self._messages("/troupe/said")]
        return sorted(found, key=lambda one: one.time)

    @property
    def properties(self) -> list[Reported]:
        """What robots reported about themselves, each time that it changed."""
        return [
            Reported(seconds(m), m["name"], m["key"], json.loads(m["value"]))
            for m in self._messages("/troupe/properties")
        ]

    @property
    def controllers(self) -> list[Driven]:
        """The states of controllers, each time that they changed."""
        return [
            Driven(
                seconds(m), m["name"], m["state"],
                m["exit_code"] if m["has_exit_code"] else None, m["error"] or None,
            )
            for m in self._messages("/troupe/controllers")
        ]  # fmt: skip

    @property
    def lines(self) -> list[Line]:
        """What was printed for people: controllers' output, and what went wrong with them."""
        return [Line(seconds(m), m["name"], m["msg"]) for m in self._messages("/rosout")]

    @property
    def touches(self) -> list[Touch]:
        """When and where robots began to touch something."""
        names = self.robots
        return [
            Touch(seconds(m), names[robot], (x, y))
            for m in self._messages("/troupe/contacts")
            for robot, (x, y) in zip(
                m["robots"].tolist(), m["points"].reshape(-1, 2).tolist(), strict=True
            )
        ]

    @property
    def commands(self) -> NDArray[Any]:
        """(k,) records of commands as they were carried out, where they changed.

        Fields: tick, time, robot (index), mode (0 twist, 1 steering, 2 pose, 3 heading), motors,
        vx, vy, wz, curvature, goal_x, goal_y, goal_yaw, speed_limit, turn_limit.
        """
        return contents.sent(self._reader, self._span)

    def floor(self, time: float | None = None) -> NDArray[np.int16] | None:
        """(rows, columns) who painted each cell last by a time: 1 + robot, 0 for nobody.

        Row 0 lies at y = 0. None where nobody had painted; the end unless a time is given.
        """
        until = None if time is None else (nanoseconds(time) or 0) + 1
        return contents.floor(self._reader, until)

    @property
    def painted(self) -> NDArray[Any]:
        """(k,) records of cells that somebody painted who was not the last to do so, by ticks.

        Fields: tick, robot (index), row, column.
        """
        return contents.painted(self._reader, self._span)

    def scans(self, robot: str | int, index: int = 0) -> Scans:
        """The scans of a robot's laser (or ranger that scans) of an index among its scanners.

        Raises KeyError where the log has none: they are kept with `--log-sensors`.
        """
        topic = self._topic(robot, "scan", index)
        times, ranges, first = contents.scan_arrays(self._reader, topic, "ranges", self._span)
        samples = ranges.shape[1]
        first = {"angle_min": 0.0, "angle_max": 0.0} if first is None else first
        bearings = np.linspace(float(first["angle_min"]), float(first["angle_max"]), samples)
        return Scans(times, ranges, bearings)

    @cached_property
    def scanners(self) -> list[tuple[str, int]]:
        """The robots and indexes whose scans are kept, as `scans` takes them."""
        numbers = {entry.topic: number for number, entry in enumerate(self.entries)}
        found = []
        for topic in self._reader.topics:
            robot, _, noun = topic[1:].partition("/")
            scan, _, index = noun.partition("_")
            if robot in numbers and scan == "scan":
                found.append((numbers[robot], int(index or 0)))
        return [(self.entries[robot].name, index) for robot, index in sorted(found)]

    def spans(self, time: float) -> bool:
        """Whether a moment (s) lies in this part."""
        start, end = self._span
        at = nanoseconds(time) or 0
        return (start is None or at >= start) and (end is None or at < end)

    def blobs(self, robot: str | int, index: int = 0) -> list[tuple[float, list[dict[str, Any]]]]:
        """What a robot's blobfinder saw: times (s), and each one's blobs; see Blob.msg."""
        topic = self._topic(robot, "blobs", index)
        return [(stamp_seconds(m["header"]["stamp"]), m["blobs"]) for m in self._messages(topic)]

    def _topic(self, robot: str | int, noun: str, index: int) -> str:
        if isinstance(robot, str):
            if robot not in self.robots:
                raise KeyError(f"there is no robot {robot!r} in the log")
            robot = self.robots.index(robot)
        topic = f"/{self.entries[robot].topic}/{noun}" + (f"_{index}" if index else "")
        if topic not in self._reader.topics:
            raise KeyError(f"there is no {topic} in the log: --log-sensors keeps readings")
        return topic

    def _messages(self, topic: str) -> list[dict[str, Any]]:
        return [message for _, message in self._reader.messages(topic, *self._span)]

    def to_dataframe(self, table: str = "poses") -> pd.DataFrame:
        """A table as a pandas frame: `poses`, `commands`, `scans` or `events`.

        Raises MissingExtra where pandas is not installed.
        """
        from troupe.tables import frame  # noqa: PLC0415

        return frame(self, table)


def nanoseconds(time: float | None) -> int | None:
    """Simulated seconds as a log's times; raises UsageError for what is no number."""
    if time is None:
        return None
    if math.isnan(time):
        raise UsageError("a time in a log is a number of simulated seconds (given: nan)")
    return round(min(max(0.0, time * 1e9), LATEST))


def later(a: int | None, b: int | None) -> int | None:
    return b if a is None else a if b is None else max(a, b)


def earlier(a: int | None, b: int | None) -> int | None:
    return b if a is None else a if b is None else min(a, b)


def seconds(message: dict[str, Any]) -> float:
    """When a message was stamped."""
    return stamp_seconds(message["stamp"])


def stamp_seconds(stamp: dict[str, int]) -> float:
    return stamp["sec"] + stamp["nanosec"] / 1e9
