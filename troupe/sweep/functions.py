"""A function in a world's place: of parameters and a seed, named as MODULE:NAME or FILE.py:NAME.

What it returns is its run's row: a mapping of columns, one value, or a result as `troupe.run` and
`troupe.Simulation` give it.
"""

from __future__ import annotations

import inspect
import os
import re
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import BaseModel, TypeAdapter, ValidationError

from sim.result import Result
from sim.worldfile.mistakes import Mistake, WorldError, listed, suggestion
from sim.worldfile.wording import mistakes_in
from troupe.sweep.fingerprint import Fingerprint, Stamp, digest_of, hash_of, holds, stamp
from troupe.sweep.results import Each, columns_of, first_place
from troupe.sweep.versions import ROOT, all_versions

NAMED = re.compile(r"(.+\.py|[A-Za-z_][\w.]*):[A-Za-z_]\w*")
OUTCOME = re.compile(r"[a-z_]+")
PACKAGES = ("troupe", "gridworld", "sim", "sensors", "player", "controllers")

Found = tuple[dict[str, Any], str, str | None]
"""Of a run: what its record has besides, its outcome, and why it is none that is complete."""


def is_function(name: str) -> bool:
    """Whether a function stands where a world may."""
    return NAMED.fullmatch(name) is not None and not Path(name).exists()


@dataclass(frozen=True)
class Function(Each):
    """A function that is run, named as `--each` names its own, and the folder it is run in."""

    def __str__(self) -> str:
        return self.name


class Ready(NamedTuple):
    """A function that has been loaded, and what its file was then."""

    call: Callable[..., Any]
    types: Mapping[str, TypeAdapter[Any] | None] | None  # by parameter; None: it takes any
    needed: tuple[str, ...]
    digest: str
    stamps: tuple[Stamp, ...]


loaded: dict[Function, Ready] = {}
"""Those of this process: a file is run once for all combinations."""


def ready(function: Function) -> Ready:
    """The function as its file has it now; raises UsageError, and WorldError for its parameters.

    A file that is changed has another digest; what has been loaded of it is kept.
    """
    known = loaded.get(function)
    if known is not None and holds(known.stamps):
        return known
    digest, stamps = told_apart(function)
    if known is None:
        call = function.load()
        types, needed = parameters_of(function, call)
    else:
        call, types, needed = known.call, known.types, known.needed
    loaded[function] = Ready(call, types, needed, digest, stamps)
    return loaded[function]


def told_apart(function: Function) -> tuple[str, tuple[Stamp, ...]]:
    """A digest of a function's file, with the modules beside it that it imports, and their stamps.

    What is installed is told by its version, and Troupe's own packages by all their sources.
    """
    source = function.source
    if source is None:
        return "", ()
    files: set[Path] = set()
    source = source.resolve()
    digest = digest_of(source, Path(function.folder).resolve(), files, leave=is_installed)
    return digest, tuple(stamp(path) for path in sorted(files))


def is_installed(path: Path) -> bool:
    """Whether a module is Troupe's or somebody's package rather than the user's own file."""
    if {"site-packages", "dist-packages"} & set(path.parts):
        return True
    return any(path.is_relative_to(ROOT / name) for name in PACKAGES)


def parameters_of(
    function: Function, call: Callable[..., Any]
) -> tuple[Mapping[str, TypeAdapter[Any] | None] | None, tuple[str, ...]]:
    """The parameters with what checks their values, and those that need one.

    Raises WorldError for a function that cannot be called by names, or that takes no seed.
    """
    try:
        found = inspect.signature(call).parameters.values()
    except (TypeError, ValueError):  # a function in C
        return None, ()
    try:
        hints = typing.get_type_hints(call, include_extras=True)
    except Exception:  # names of types that are there for a checker only
        hints = {}
    by_name = [one for one in found if one.kind in (one.POSITIONAL_OR_KEYWORD, one.KEYWORD_ONLY)]
    any_name = any(one.kind == one.VAR_KEYWORD for one in found)
    mistakes = [
        Mistake((one.name,), "cannot be given by its name: there is a `/` behind it")
        for one in found
        if one.kind == one.POSITIONAL_ONLY and one.default is one.empty
    ]
    if not any_name and all(one.name != "seed" for one in by_name):
        mistakes.append(Mistake((), "has no parameter `seed`", None, "def f(seed, ...)"))
    if mistakes:
        raise WorldError([at(function, one) for one in mistakes])
    needed = [one.name for one in by_name if one.default is one.empty and one.name != "seed"]
    names = [one.name for one in by_name if one.name != "seed"]
    return None if any_name else {name: checker(hints.get(name)) for name in names}, tuple(needed)


def checker(hint: Any) -> TypeAdapter[Any] | None:
    """What checks and converts a value for a parameter with an annotation; None: any will do."""
    if hint is None:
        return None
    try:
        return TypeAdapter(hint)
    except Exception:  # a type that no text stands for
        return None


def at(function: Function, mistake: Mistake) -> Mistake:
    return Mistake(mistake.where, mistake.what, mistake.given, mistake.allowed, function.name)


def arguments(function: Function, settings: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments that settings are; raises WorldError with all that is wrong with them."""
    _, types, needed, *_ = ready(function)
    missing = [name for name in needed if name not in settings]
    mistakes = [
        Mistake((name,), "has no value", None, f"--set {name}=VALUE, or a column of --table")
        for name in missing
    ]
    if types is None:
        given = dict(settings)
    else:
        given = {}
        for name, value in settings.items():
            if name not in types:
                what = f"is no parameter of it{suggestion(name, missing or types)}"
                mistakes.append(Mistake((name,), what, None, listed(list(types))))
                continue
            check = types[name]
            try:
                given[name] = value if check is None else check.validate_python(value)
            except ValidationError as error:
                for one, _ in mistakes_in(error, value, BaseModel):
                    mistakes.append(Mistake((name, *one.where), one.what, one.given, one.allowed))
    if mistakes:
        raise WorldError([at(function, one) for one in mistakes])
    return given


def function_mark(function: Function, settings: Mapping[str, Any]) -> Fingerprint:
    """The name of a function's runs: its file's, its parameters', and what it is run with.

    In place of a value that names a file stands what is in the file. Raises as `ready` does.
    """
    found = ready(function)
    files: set[Path] = set()
    folder = Path(function.folder)

    def contents(value: Any) -> Any:
        if not isinstance(value, str) or not value or not os.path.isfile(folder / value):
            return value
        return {"file": digest_of((folder / value).resolve(), folder, files, leave=is_installed)}

    told = {
        "function": [function.name.rpartition(":")[2], found.digest],
        "parameters": {key: contents(value) for key, value in settings.items()},
        "versions": all_versions(),
    }
    stamps = (*found.stamps, *(stamp(path) for path in sorted(files)))
    return Fingerprint(hash_of(told), stamps)


def call(function: Function, settings: Mapping[str, Any], seed: int) -> Found:
    """Call a function in its folder; what it raises comes out."""
    given = arguments(function, settings)
    os.chdir(function.folder)
    with first_place(function.folder):  # for what it imports only now
        return found_of(function, ready(function).call(seed=seed, **given))


def found_of(function: Function, value: Any) -> Found:
    """What a function returned, for its run's record; raises ValueError for what is no row."""
    if isinstance(value, Result):
        from troupe.sweep.task import reason_of  # noqa: PLC0415 - which knows us

        if value.outcome == "interrupted":  # by the function, which has seen enough
            return value.as_json(), "completed", None
        return value.as_json(), value.outcome, reason_of(value)
    columns = {} if value is None else columns_of(function, value)
    outcome = columns.pop("outcome", "completed")
    reason = columns.pop("reason", None)
    if not isinstance(outcome, str) or OUTCOME.fullmatch(outcome) is None:
        raise ValueError(f"the outcome is {outcome!r}: it must be a word in small letters")
    if outcome == "completed":
        reason = None
    else:
        reason = outcome.replace("_", " ") if reason is None else str(reason)
    return {"columns": columns}, outcome, reason
