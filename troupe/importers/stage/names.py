"""Names of robots and obstacles: Stage's, where our world files can hold them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from troupe.importers.stage.notes import Notes
from troupe.importers.stage.things import Thing
from troupe.importers.stage.tokens import Place

LONGEST = 60


def robot_names(things: Sequence[Thing], notes: Notes) -> list[str]:
    """Our name of each thing, in their order; what had to change is noted.

    Stage takes two models of one name without a word; the second gets a number here.
    """
    names: list[str] = []
    taken: set[str] = set()
    for thing in things:
        name = own_name(thing.name, taken)
        names.append(name)
        if name != thing.name and "name" in thing.entity.properties:
            notes.differs(thing.entity.place, f"robot {thing.name} is called {name} here")
    return names


def own_name(wanted: str, taken: set[str]) -> str:
    """A name as our world files hold it, which is not taken; it is from now on."""
    stem = re.sub(r"[^A-Za-z0-9_.-]", "_", wanted)
    if not re.match(r"[A-Za-z_]", stem):
        stem = f"_{stem}"
    name, number = stem[:LONGEST], 2
    while name in taken:
        name, number = f"{stem[: LONGEST - 6]}_{number}", number + 1
    taken.add(name)
    return name


def name_obstacles(
    obstacles: Sequence[tuple[dict[str, Any], Place]], robots: Sequence[str], notes: Notes
) -> list[tuple[dict[str, Any], Place]]:
    """The obstacles with the names that Stage's models have, as ours; none is a robot's."""
    taken, found = set(robots), []
    for data, place in obstacles:
        wanted = data.get("name")
        name = own_name(wanted, taken) if wanted is not None else None
        if name != wanted:
            notes.differs(place, f"model {wanted} is called {name} here")
        found.append((data if name is None else {**data, "name": name}, place))
    return found
