"""Which bodies share a height, and so can touch: a bit for every stack of them.

Bodies reach from `z` to `z + height`, and meet only where these ranges overlap. Ranges that all
share one height form a clique of the graph of overlaps, and two ranges overlap if and only if they
are in one such clique together. So with a bit for each largest clique two bodies can touch if they
have a bit in common: what Chipmunk asks of a pair before anything else.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

EVERY_LEVEL = 0xFFFFFFFF
"""What reaches as high as anything does."""
MOST_LEVELS = 32
"""Bits that Chipmunk has for it."""

Range = tuple[float, float]


class TooManyLevels(Exception):
    """There are more storeys than bits."""


class Levels:
    """The bits of the bodies of a world."""

    def __init__(self, ranges: Iterable[Range]) -> None:
        """ranges: (lower end, upper end) in metres of all that there is.

        Raises TooManyLevels.
        """
        known = sorted(set(ranges))
        stacks = _cliques(known)
        if len(stacks) > MOST_LEVELS:
            raise TooManyLevels
        self._bits = {
            one: sum(1 << bit for bit, stack in enumerate(stacks) if one in stack) for one in known
        }
        self._one = len(stacks) <= 1  # all share a height

    def of(self, body: Any) -> int:
        """The bits of a body of the schema; none for what is not solid."""
        return self.between(*range_of(body)) if body.solid else 0

    def between(self, bottom: float, top: float) -> int:
        """The bits of one of the ranges."""
        return EVERY_LEVEL if self._one else self._bits[bottom, top]


def range_of(body: Any) -> Range:
    """From which height to which a body of the schema reaches, in metres."""
    return body.z, body.z + body.height


def _cliques(ranges: list[Range]) -> list[set[Range]]:
    """The largest sets of ranges, sorted by their lower ends, that share a height.

    Going up, a set is complete when one of it ends after another has joined.
    """
    found: list[set[Range]] = []
    now: set[Range] = set()
    for one in ranges:
        staying = {other for other in now if other[1] > one[0]}
        if staying != now and not any(now <= stack for stack in found):
            found.append(now)
        now = staying | {one}
    if now and not any(now <= stack for stack in found):
        found.append(now)
    return found
