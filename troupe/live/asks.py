"""What a page may ask for: one JSON object a message, checked before anybody obeys it."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

FARTHEST = 1e6
"""Metres, radians, and either per second: more is no sensible number."""
FASTEST, SLOWEST = 1000.0, 0.01
"""Simulated seconds per second that a page may ask for."""
MOST_STEPS = 1000
MOST_SELECTED = 8
"""Robots whose sensors and cards one page gets."""
DOINGS = frozenset(
    {"pause", "go", "step", "pace", "again", "put", "put_thing", "drive", "take", "give", "seek",
     "world"}
)  # fmt: skip
"""What reaches into the run, or into its file; a viewer that may only look on is refused it."""


class Malformed(ValueError):
    """What came is not what a page sends."""


@dataclass(frozen=True)
class Ask:
    """One wish. Which fields count depends on `do`."""

    do: str
    robot: int = -1
    """Index of a robot, or of a thing that can be pushed."""
    numbers: tuple[float, ...] = ()
    """A pose x, y, yaw; a twist vx, vy, wz; a factor of the pace (empty: flat out); a time."""
    count: int = 1
    seed: int | None = None
    robots: tuple[int, ...] = ()

    @property
    def key(self) -> object:
        """Later asks of the same key take the place of earlier ones that nobody has obeyed yet."""
        return (self.do, self.robot) if self.do != "step" else object()


def parse_ask(text: str | bytes) -> Ask:
    """One message of a page; raises Malformed."""
    if not isinstance(text, str):
        raise Malformed("bytes where text is expected")
    try:
        told = json.loads(text)
    except (ValueError, RecursionError):
        raise Malformed("not JSON") from None
    if not isinstance(told, dict):
        raise Malformed("not an object")
    match told.get("do"):
        case "seen" | "pause" | "go" | "world" as do:
            return Ask(do)
        case "step":
            return Ask("step", count=_whole(told.get("ticks", 1), 1, MOST_STEPS))
        case "pace":
            factor = told.get("factor")
            if factor is None:
                return Ask("pace")
            return Ask("pace", numbers=(min(max(_number(factor), SLOWEST), FASTEST),))
        case "again":
            seed = told.get("seed")
            return Ask("again", seed=None if seed is None else _whole(seed, 0, (1 << 53) - 1))
        case "seek":
            return Ask("seek", numbers=(_number(told.get("time")),))
        case "put" | "put_thing" as do:
            numbers = _three(told.get("pose"))
            return Ask(do, _whole(told.get("robot"), 0, 1 << 31), numbers)
        case "take" | "give" as do:
            return Ask(do, _whole(told.get("robot"), 0, 1 << 31))
        case "drive":
            numbers = _three(told.get("twist"))
            return Ask("drive", _whole(told.get("robot"), 0, 1 << 31), numbers)
        case "select":
            robots = told.get("robots")
            if not isinstance(robots, list):
                raise Malformed("robots is no list")
            which = [_whole(robot, 0, 1 << 31) for robot in robots[:MOST_SELECTED]]
            return Ask("select", robots=tuple(which))
    raise Malformed("nothing that can be done")


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Malformed("no number")
    if not (math.isfinite(value) and abs(value) <= FARTHEST):
        raise Malformed("no sensible number")
    return float(value)


def _whole(value: Any, least: int, most: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise Malformed("no whole number in range")
    return value


def _three(value: Any) -> tuple[float, ...]:
    if not isinstance(value, list) or len(value) != 3:
        raise Malformed("not three numbers")
    return tuple(map(_number, value))
