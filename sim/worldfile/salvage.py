"""All mistakes of a world at once: what is wrong is taken out and the rest is looked at again.

A validation stops early in places: a part with a wrong value is not checked as a whole, and
a world with a wrong part not at all. So the culprits are taken out (a value falls back to its
default, an entry of a list goes) until the rest holds; what depends on something that was taken
out is not reported.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from pydantic import ValidationError

from sim.worldfile.mistakes import Mistake
from sim.worldfile.nodes import Path
from sim.worldfile.schema import World
from sim.worldfile.wording import mistakes_in

_LISTS_OF_PARTS = frozenset({"robots", "doors", "obstacles", "sensors", "actuators"})


@dataclass
class Salvaged:
    """What is left of a world, and what was taken out of it."""

    world: World | None
    mistakes: list[Mistake]
    removed: set[Path] = field(
        default_factory=set
    )  # values; unknown keys and bad names are no loss
    kept: dict[Path, list[int]] = field(default_factory=dict)  # list -> indices that are left

    def index(self, where: Path, position: int) -> int:
        """The index in the file of what stands at `position` in the salvaged list."""
        return self.kept[where][position] if where in self.kept else position

    def lost(self, *where: str | int) -> bool:
        """Whether the part at `where` or anything in it was taken out."""
        return any(path[: len(where)] == where for path in self.removed)


def salvage(data: Mapping[str, Any], mistakes: list[Mistake], removed: set[Path]) -> Salvaged:
    """Validates a world without what was already found to be wrong (`removed`)."""
    found = Salvaged(None, list(mistakes), set(removed))
    unknown: set[Path] = set()
    told: set[tuple[Path, str]] = set()
    while True:  # ends: each round takes something out that is there
        kept: dict[Path, list[int]] = {}
        rest = _without(data, found.removed | unknown, (), kept)
        if ("size",) in found.removed:
            rest["size"] = (1.0, 1.0)  # so that the rest can be looked at
        try:
            found.world, found.kept = World.model_validate(rest), kept
            return found
        except ValidationError as error:
            earlier = frozenset(found.removed)
            before = len(earlier) + len(unknown)
            for mistake, rests_on in mistakes_in(error, rest, World):
                where = _in_file(mistake.where, kept)
                doubtful = any(_in_file(path, kept) in earlier for path in rests_on)
                if (
                    not doubtful
                    and not _follows(where, earlier)
                    and (where, mistake.what) not in told
                ):
                    told.add((where, mistake.what))
                    found.mistakes.append(replace(mistake, where=where))
                if mistake.at_key:
                    unknown.add(where)
                else:
                    found.removed.add(_culprit(data, where, earlier) or ("size",))
            if len(found.removed) + len(unknown) == before:
                return found


def _without(data: Any, out: set[Path], here: Path, kept: dict[Path, list[int]]) -> Any:
    """A copy of the data without the paths in `out`; `kept` gets the indices left in lists."""
    if isinstance(data, Mapping):
        return {
            key: _without(value, out, (*here, key), kept)
            for key, value in data.items()
            if (*here, key) not in out
        }
    if isinstance(data, tuple) and here and here[-1] in _LISTS_OF_PARTS:
        kept[here] = [index for index in range(len(data)) if (*here, index) not in out]
        return tuple([_without(data[index], out, (*here, index), kept) for index in kept[here]])
    return data


def _in_file(where: Path, kept: dict[Path, list[int]]) -> Path:
    path: Path = ()
    for key in where:
        if isinstance(key, int) and path in kept and key < len(kept[path]):
            path = (*path, kept[path][key])
        else:
            path = (*path, key)
    return path


def _culprit(data: Any, where: Path, removed: frozenset[Path]) -> Path:
    """What to take out for a mistake at `where`: the key, or the part that lacks it (by now)."""
    path: Path = ()
    for key in where:
        inside = data.get(key, ...) if isinstance(data, Mapping) else ...
        if isinstance(data, tuple) and path and path[-1] in _LISTS_OF_PARTS:
            inside = data[key] if isinstance(key, int) and key < len(data) else ...
        if inside is ... or (*path, key) in removed:
            return path
        path, data = (*path, key), inside
    return path


def _follows(where: Path, removed: frozenset[Path]) -> bool:
    """Whether a mistake may be due to something that was taken out there, below or above."""
    return any(path[: len(where)] == where or where[: len(path)] == path for path in removed)
