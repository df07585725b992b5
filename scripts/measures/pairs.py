"""What something costs a run, by pairs of runs: what else the machine does is alike for both."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

Found = TypeVar("Found")


def pairs(
    number: int, without: Callable[[], Found], with_it: Callable[[], Found]
) -> list[tuple[Found, Found]]:
    """What so many pairs of runs gave, without it and with it, which go first in turn.

    One of each goes before that does not count: what is made once is made there.
    """
    without(), with_it()
    found = []
    for turn in range(number):
        if turn % 2:
            later = with_it()
            found.append((without(), later))
        else:
            found.append((without(), with_it()))
    return found
