"""All mistakes of a world at once: what is wrong is taken out and the rest is looked at again.

A validation stops early in places: a part with a wrong value is not checked as a whole, and
a world with a wrong part not at all. So the culprits are taken out (a value falls back to its
default, an entry of a list goes) until the rest holds; what depends on something that was taken
out is not reported. A body of an unknown shape is looked at as if it were of the likeliest one.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from pydantic import ValidationError

from sim.worldfile.mistakes import Mistake
from sim.worldfile.nodes import Path
from sim.worldfile.schema import World
from sim.worldfile.wording import mistakes_in

_OF_SHAPES = {"box": "size", "circle": "radius", "polygon": "points", "compound": "parts"}
"""The key that only bodies of a shape have."""

_LISTS_OF_PARTS = frozenset({"robots", "doors", "obstacles", "sensors", "actuators"})


@dataclass
class ValidPart:
    """What is left of a world, and what was taken out of it."""

    world: World | None
    mistakes: list[Mistake]
    removed: set[Path] = field(
        default_factory=set
    )  # values; unknown keys and bad names are no loss
    kept: dict[Path, list[int]] = field(default_factory=dict)  # list -> indices that are left

    def index(self, where: Path, position: int) -> int:
        """The index in the file of what stands at `position` in the list that is left."""
        return self.kept[where][position] if where in self.kept else position

    def lost(self, *where: str | int) -> bool:
        """Whether the part at `where` or anything in it was taken out."""
        return any(path[: len(where)] == where for path in self.removed)


def valid_part(data: Mapping[str, Any], mistakes: list[Mistake], removed: set[Path]) -> ValidPart:
    """Validates a world without what was already found to be wrong (`removed`)."""
    found = ValidPart(None, list(mistakes), set(removed))
    unknown: set[Path] = set()
    told: set[tuple[Path, str]] = set()
    guessed: dict[Path, str] = {}  # bodies of a shape that there is not
    while True:  # ends: each round takes something out that is there
        kept: dict[Path, list[int]] = {}
        rest = _without(data, found.removed | unknown, (), kept, guessed)
        if ("size",) in found.removed:
            rest["size"] = (1.0, 1.0)  # so that the rest can be looked at
        try:
            world = World.model_validate(rest)
        except ValidationError as error:
            earlier = frozenset(found.removed)
            before = len(earlier) + len(unknown)
            looked_closer = False
            for mistake, rests_on in mistakes_in(error, rest, World):
                where = _in_file(mistake.where, kept) if kept else mistake.where
                if where != mistake.where:
                    mistake = replace(mistake, where=where)  # noqa: PLW2901
                if _is_shape(where) and where[:-1] not in {*guessed, *earlier}:
                    found.mistakes.append(mistake)
                    guessed[where[:-1]] = _likeliest(data, where[:-1])
                    looked_closer = True
                    continue
                doubtful = any(_in_file(path, kept) in earlier for path in rests_on)
                if (
                    not doubtful
                    and not _due_to_guess(mistake, guessed)
                    and not _follows(where, earlier)
                    and (where, mistake.what) not in told
                ):
                    told.add((where, mistake.what))
                    found.mistakes.append(mistake)
                if mistake.at_key:
                    unknown.add(where)
                else:
                    found.removed.add(_culprit(data, where, earlier) or ("size",))
            if len(found.removed) + len(unknown) == before and not looked_closer:
                return found
        else:
            if not guessed.keys() - found.removed:
                found.world, found.kept = world, kept
                return found
            found.removed |= guessed.keys()  # what it is like is not known: it goes after all
            guessed.clear()


def _likeliest(data: Any, where: Path) -> str:
    """The shape that was meant by a body with another one, or none."""
    for key in where:
        data = data[key]
    near = difflib.get_close_matches(str(data.get("shape")), _OF_SHAPES, 1)
    return (near + [shape for shape, key in _OF_SHAPES.items() if key in data] + ["box"])[0]


def _is_shape(where: Path) -> bool:
    """Whether a place is that of the shape of a model's body or of an obstacle."""
    if where[-1:] != ("shape",):
        return False
    return where[-2] == "body" if where[0] == "models" else where[0] == "obstacles"


def _due_to_guess(mistake: Mistake, guessed: Mapping[Path, str]) -> bool:
    """Whether a body lacks a key, or has one too many, because of the shape that it is given."""
    where = mistake.where
    amiss = mistake.at_key or mistake.what == "is missing"
    return amiss and where[:-1] in guessed and where[-1] in _OF_SHAPES.values()


def _without(
    data: Any,
    out: set[Path],
    here: Path,
    kept: dict[Path, list[int]],
    shapes: Mapping[Path, str],
) -> Any:
    """A copy of the data without the paths in `out`, and with the `shapes` of bodies put in.

    `kept` gets the indices left in lists.
    """
    if isinstance(data, Mapping):
        copy = {
            key: _without(value, out, (*here, key), kept, shapes)
            for key, value in data.items()
            if (*here, key) not in out
        }
        return {**copy, "shape": shapes[here]} if here in shapes else copy
    if isinstance(data, tuple) and here and here[-1] in _LISTS_OF_PARTS:
        kept[here] = [index for index in range(len(data)) if (*here, index) not in out]
        return tuple(
            [_without(data[index], out, (*here, index), kept, shapes) for index in kept[here]]
        )
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
