"""Times that divide others: whether one does, and one that does for whoever gave another."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil

MOST_STEPS = 10_000
"""Of physics in an interval of the clock."""


def divides(part: float, whole: float) -> bool:
    """Whether a time goes a whole number of times, once or more, into another."""
    count = whole / part
    return round(count) >= 1 and abs(count - round(count)) <= 1e-9 * count


def shown(number: float, fits: Callable[[float], bool]) -> str:
    """A number that fits, with as few digits as still do: from 6 on, and all where none do."""
    texts = (f"{number:.{digits}g}" for digits in range(6, 17))
    return next((text for text in texts if fits(float(text))), repr(number))


def step_within(interval: float, longest: float) -> str:
    """The longest step of physics up to `longest` that divides an interval; all in seconds."""
    count = max(1, ceil(interval / longest))
    count += interval / count > longest  # by a rounding
    return shown(interval / count, lambda told: divides(told, interval) and told <= longest)


def clock_within(interval: float, longest: float) -> str:
    """A clock whose steps are no longer than `longest`, in a world file's words.

    It keeps the interval unless that would have more steps than it may.
    """
    if interval / longest <= MOST_STEPS:
        return f"physics_step: {step_within(interval, longest)}"
    parts = 1
    while interval / parts / longest > MOST_STEPS:
        parts *= 10
    short = shown(interval / parts, lambda told: divides(told, interval))
    return f"physics_step: {step_within(float(short), longest)}, interval: {short}"
