"""Names of robots: Stage's, where our world files can hold them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from troupe.importers.stage.notes import Notes
from troupe.importers.stage.things import Thing

LONGEST = 60


def robot_names(things: Sequence[Thing], notes: Notes) -> list[str]:
    """Our name of each thing, in their order; what had to change is noted.

    Stage takes two models of one name without a word; the second gets a number here.
    """
    names: list[str] = []
    taken: set[str] = set()
    for thing in things:
        wanted = re.sub(r"[^A-Za-z0-9_.-]", "_", thing.name)
        if not re.match(r"[A-Za-z_]", wanted):
            wanted = f"_{wanted}"
        name, number = wanted[:LONGEST], 2
        while name in taken:
            name, number = f"{wanted[: LONGEST - 6]}_{number}", number + 1
        taken.add(name)
        names.append(name)
        if name != thing.name and "name" in thing.entity.properties:
            notes.differs(thing.entity.place, f"robot {thing.name} is called {name} here")
    return names
