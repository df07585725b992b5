"""Which sighting is of which robot: the pairing that makes the fewest robots of all sightings."""

from __future__ import annotations

from collections.abc import Sequence


def paired(options: Sequence[Sequence[int]], certain: Sequence[bool]) -> dict[int, int]:
    """Sighting to robot, so that as many certain sightings as possible are paired.

    `options` are the robots that each sighting may be of, the likeliest first. A sighting that is
    not certain takes one that is left.
    """
    owner: dict[int, int] = {}

    def place(j: int, tried: set[int]) -> bool:
        for i in options[j]:
            if i not in tried:
                tried.add(i)
                if i not in owner or place(owner[i], tried):
                    owner[i] = j
                    return True
        return False

    for j in sorted((j for j in range(len(options)) if certain[j]), key=lambda j: len(options[j])):
        place(j, set())
    for j in range(len(options)):
        free = [] if certain[j] else [i for i in options[j] if i not in owner]
        if free:
            owner[free[0]] = j
    return {j: i for i, j in owner.items()}


def swapped(robot: int, options: Sequence[Sequence[int]], pairs: dict[int, int]) -> set[int]:
    """The paired robots that may be the ones unseen, if `robot`, unpaired, was seen instead.

    Those are the robots on the alternating paths that begin at it.
    """
    found: set[int] = set()
    open_ = [robot]
    while open_:
        one = open_.pop()
        for j, i in pairs.items():
            if one in options[j] and i != robot and i not in found:
                found.add(i)
                open_.append(i)
    return found
