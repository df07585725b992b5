"""What happened in a log and when: the marks on the page's time line, and what its cards tell."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

if TYPE_CHECKING:
    from sim.log.playback import Playback
    from troupe.log import Driven, Log, Touch

MOST_MARKS = 2000
"""Of one kind on the time line; of more every so-manieth is left out."""
MOST_POINTS = 400
"""Of a measure's curve."""
LONGEST = 200
"""Characters of a text that stands on the time line."""
MODES = ("velocity", "speed and curvature", "pose", "speed and heading")
"""What the modes of commands are called."""

Thing = TypeVar("Thing")


class History(Generic[Thing]):
    """What became of somebody, in the order of time, by key."""

    def __init__(
        self, things: Iterable[Thing], key: Callable[[Thing], Any], time: Callable[[Thing], float]
    ) -> None:
        self.by_key: dict[Any, tuple[list[float], list[Thing]]] = {}
        for thing in things:
            times, found = self.by_key.setdefault(key(thing), ([], []))
            times.append(time(thing))
            found.append(thing)

    def until(self, key: Any, time: float) -> Sequence[Thing]:
        """All up to a time."""
        times, found = self.by_key.get(key, ([], []))
        return found[: bisect_right(times, time + 1e-9)]


class Timeline:
    """What is known of the robots besides where they are. `about`: what a page gets of it."""

    def __init__(self, log: Log, about: dict[str, Any]) -> None:
        self.about = about
        self._names = log.robots
        self._said = History(log.said, lambda one: one.robot, lambda one: one.time)
        self._lines = History(log.lines, lambda one: one.who, lambda one: one.time)
        self._drivers = History(log.controllers, lambda one: one.robot, lambda one: one.time)
        self._reports = History(log.properties, lambda one: one.robot, lambda one: one.time)
        self._touches = History(log.touches, lambda one: one.robot, lambda one: one.time)
        self._log = log
        self._sent = log.commands
        self._order = np.argsort(self._sent["robot"], kind="stable")
        self._of = self._sent["robot"][self._order]

    def said_by(self, name: str, time: float) -> list[list[Any]]:
        """When and what a robot has said."""
        return [[one.time, one.text] for one in self._said.until(name, time)]

    def printed_by(self, name: str, time: float) -> list[str]:
        """The lines of its controller."""
        return [one.text for one in self._lines.until(name, time)]

    def driver(self, robot: int, time: float) -> Driven | None:
        """The last change of its controller's state; None: there was none yet."""
        found = self._drivers.until(self._names[robot], time)
        return found[-1] if found else None

    def properties_of(self, name: str, time: float) -> dict[str, Any]:
        """What it has reported."""
        return {one.key: one.value for one in self._reports.until(name, time)}

    def touch(self, robot: int, time: float) -> Touch | None:
        """When and where it began to touch something last; None: never so far."""
        found = self._touches.until(self._names[robot], time)
        return found[-1] if found else None

    def odometry(self, robot: int, time: float) -> list[float] | None:
        """The pose that it believed to have, x, y, yaw; None where the log has not kept that."""
        reader, topic = self._log._reader, f"/{self._log.entries[robot].topic}/odom"
        if topic not in reader.topics:
            return None
        end, half = round(time * 1e9), round(0.5e9 * self._log.interval)
        found = [one["pose"]["pose"] for _, one in reader.messages(topic, end - half, end + half)]
        if not found:
            return None
        at, turned = found[-1]["position"], found[-1]["orientation"]
        return [at["x"], at["y"], 2.0 * math.atan2(turned["z"], turned["w"])]

    def command(self, robot: int, time: float) -> list[Any]:
        """What it was told last, as the live card has it: kind and numbers."""
        first, last = np.searchsorted(self._of, [robot, robot + 1])
        rows = self._sent[self._order[first:last]]
        upto = int(np.searchsorted(rows["time"], time + 1e-9, side="right"))
        if not upto:
            return ["none", []]
        row = rows[upto - 1]
        mode = int(row["mode"])
        names = {
            1: ("vx", "curvature"),
            2: ("goal_x", "goal_y", "goal_yaw"),
            3: ("vx", "goal_yaw"),
        }.get(mode, ("vx", "vy", "wz"))
        return [MODES[mode] if mode < len(MODES) else "?", [float(row[name]) for name in names]]


def timeline_of(log: Log, playback: Playback) -> Timeline:
    """The time line of a log."""
    numbers = {name: robot for robot, name in enumerate(playback.names)}
    times = playback.states.times
    covered = log.coverage
    some = np.flatnonzero(~np.isnan(covered))
    some = some[:: max(1, len(some) // MOST_POINTS)]
    result, end = log.result, float(times[-1])
    touches, ends = once(log.touches), [one for one in log.controllers if one.state != "running"]
    about = {
        "from": float(times[0]),
        "until": end,
        "outcome": None if result is None else result.get("outcome"),
        "said": thinned(  # what is said between two ticks shows with the second one
            [
                [min(one.time + log.interval, end), numbers.get(one.robot, -1), one.text[:LONGEST]]
                for one in log.said
            ]
        ),
        "touches": thinned([[one.time, numbers.get(one.robot, -1), *one.point] for one in touches]),
        "ends": thinned(
            [
                [one.time, numbers.get(one.robot, -1), one.state, (one.error or "")[:LONGEST]]
                for one in ends
            ]
        ),
        "measures": {
            "coverage": [[float(times[k]), round(float(covered[k]), 5)] for k in some.tolist()],
            "contacts": counted([one.time for one in touches], end),
            "ended": counted([one.time for one in ends], end),
        },
    }
    return Timeline(log, about)


def counted(times: list[float], end: float) -> list[list[float]]:
    """How many there were so far, as points (time, number) of a curve; none: no curve."""
    if not times:
        return []
    some = list(enumerate(times, 1))[:: max(1, len(times) // MOST_POINTS)]
    return [[0.0, 0], *([time, number] for number, time in some), [end, len(times)]]


def once(touches: Iterable[Any]) -> list[Any]:
    """One touch of each robot in a tick: a contact may have several points."""
    return list({(one.time, one.robot): one for one in touches}.values())


def thinned(marks: list[Any]) -> list[Any]:
    """Not more than a time line can show."""
    return marks[:: max(1, -(-len(marks) // MOST_MARKS))]
