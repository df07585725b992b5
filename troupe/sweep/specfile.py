"""Reads a sweep from files: `sweep.yaml`, and tables of settings as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sim.worldfile import nodes
from sim.worldfile.mistakes import Mistake, suggestion
from sim.worldfile.nodes import MappingNode, Mark
from sim.worldfile.reader import Unreadable, read_text
from sim.worldfile.reading import NotRead, read_regular
from troupe.sweep.functions import is_function
from troupe.sweep.samplers import ALLOWED, Sampler, sampler_of
from troupe.sweep.seeds import Unusable, parse_seeds
from troupe.sweep.spec import Row

LARGEST = 100_000_000
"""Bytes of a table."""

KEYS = (
    "worlds",
    "seeds",
    "parameters",
    "table",
    "samples",
    "sampling_seed",
    "duration",
    "each",
    "judge",
)


@dataclass
class FromFile:
    """What a `sweep.yaml` says; None and empty where it says nothing."""

    worlds: tuple[str, ...] = ()
    seeds: tuple[int, ...] | None = None
    parameters: dict[str, Sampler] = field(default_factory=dict)
    table: str | None = None
    samples: int = 1
    sampling_seed: int = 1
    duration: float | None = None
    each: tuple[str, ...] = ()
    judge: tuple[str, ...] = ()
    places: dict[str, Mark] = field(default_factory=dict)
    """Where the parameters stand."""


def read_sweep_file(path: Path) -> FromFile:
    """A sweep.yaml; raises Unusable with all its mistakes and their places.

    Names of worlds and of the table start at the file's folder where there are such files.
    """
    shown = str(path)
    try:
        text = read_regular(path, LARGEST).decode("utf-8-sig")
        root, mistakes = read_text(text, shown)
    except NotRead as error:
        raise Unusable(Mistake((), str(error), file=shown)) from None
    except UnicodeDecodeError:
        raise Unusable(Mistake((), "is not UTF-8 text", file=shown)) from None
    except Unreadable as error:
        raise Unusable(error.mistake) from None
    if not isinstance(root, MappingNode):
        raise Unusable(*mistakes, Mistake((), "a sweep is a mapping of keys", file=shown))
    found = FromFile()
    notes = list(mistakes)

    def note(what: str, *where: str, at_key: bool = False, allowed: str | None = None) -> None:
        mark = nodes.mark_of(root, where, at_key=at_key)
        notes.append(Mistake(where, what, None, allowed, *mark))

    def beside(name: str) -> str:
        file = name.rpartition(":")[0] if is_function(name) else name
        return str(path.parent / name) if (path.parent / file).exists() else name

    data = nodes.plain(root)
    for key, value in data.items():
        if key not in KEYS:
            note(f"unknown key{suggestion(key, KEYS)}", key, at_key=True, allowed=", ".join(KEYS))
        elif key in ("worlds", "each", "judge"):
            names = value if isinstance(value, tuple) else (value,)
            if not names or not all(isinstance(name, str) and name for name in names):
                note("must be texts", key)
            elif key == "worlds":
                found.worlds = tuple(beside(name) for name in names)
            else:
                setattr(found, key, names)
        elif key == "seeds":
            written = ",".join(str(one) for one in value) if isinstance(value, tuple) else value
            try:
                found.seeds = tuple(parse_seeds(str(written)))
            except Unusable as error:
                note(error.mistakes[0].what, key, allowed=error.mistakes[0].allowed)
        elif key == "table":
            if isinstance(value, str) and value:
                found.table = beside(value)
            else:
                note("must be the name of a CSV file", key)
        elif key in ("samples", "sampling_seed"):
            if isinstance(value, bool) or not isinstance(value, int) or value < (key == "samples"):
                note("must be a whole number", key)
            else:
                setattr(found, key, value)
        elif key == "duration":
            if isinstance(value, bool) or not isinstance(value, int | float) or value <= 0:
                note("must be simulated seconds above 0", key)
            else:
                found.duration = float(value)
        elif not isinstance(value, dict):
            note("must be a mapping of settings to their values", key)
        else:
            _parameters(value, found, note)
            for name in value:
                found.places[name] = nodes.mark_of(root, (key, name), at_key=True)
    if notes:
        raise Unusable(*notes)
    return found


def _parameters(given: dict[str, Any], found: FromFile, note: Callable[..., None]) -> None:
    for name, value in given.items():
        try:
            found.parameters[name] = sampler_of(value)
        except ValueError as error:
            note(str(error), "parameters", name, allowed=ALLOWED)


def read_table(path: Path) -> tuple[Row, ...]:
    """The rows of a CSV file: columns are settings, and `world` and `seed` if they are there.

    A value is YAML, as on the command line; an empty one is no change. Raises Unusable.
    """
    shown = str(path)
    try:
        text = read_regular(path, LARGEST).decode("utf-8-sig")
    except NotRead as error:
        raise Unusable(Mistake((), str(error), file=shown)) from None
    except UnicodeDecodeError:
        raise Unusable(Mistake((), "is not UTF-8 text", file=shown)) from None
    reader = csv.reader(io.StringIO(text), strict=True)
    rows: list[Row] = []
    notes: list[Mistake] = []
    try:
        names = [name.strip() for name in next(reader, [])]
        if not names or not all(all(name.split(".")) for name in names):
            raise Unusable(Mistake((), "the first line must name the columns", file=shown))
        if len(set(names)) < len(names):
            raise Unusable(Mistake((), "two columns have one name", file=shown, line=1))
        for cells in reader:
            if not any(cell.strip() for cell in cells):
                continue
            if len(cells) != len(names):
                what = f"has {len(cells)} values for {len(names)} columns"
                notes.append(Mistake((), what, file=shown, line=reader.line_num))
                continue
            rows.append(_row(dict(zip(names, cells, strict=True)), shown, reader.line_num, notes))
    except csv.Error as error:
        notes.append(Mistake((), f"is no CSV: {error}", file=shown, line=reader.line_num))
    if notes:
        raise Unusable(*notes)
    if not rows:
        raise Unusable(Mistake((), "has no row", file=shown))
    return tuple(rows)


def _row(cells: dict[str, str], file: str, line: int, notes: list[Mistake]) -> Row:
    world = cells.pop("world", "").strip() or None
    seeds = None
    written = cells.pop("seed", "").strip()
    settings = {}
    if written:
        try:
            seeds = tuple(parse_seeds(written))
        except Unusable as error:
            one = error.mistakes[0]
            notes.append(Mistake(("seed",), one.what, written, one.allowed, file, line))
    for key, text in cells.items():
        if not text.strip():
            continue
        try:
            node, mistakes = read_text(text, file)
        except Unreadable as error:
            node, mistakes = None, [error.mistake]
        notes += [Mistake((key,), one.what, text, None, file, line) for one in mistakes]
        settings[key] = None if node is None else nodes.plain(node)
    return Row(settings, world, seeds, Mark(file, line, None))


def is_sweep_file(name: str) -> bool:
    """Whether a file is a sweep rather than a world: it names `worlds` or `parameters`."""
    path = Path(name)
    if path.suffix not in (".yaml", ".yml"):
        return False
    try:
        root, _ = read_text(read_regular(path, LARGEST).decode("utf-8-sig"), name)
    except (NotRead, UnicodeDecodeError, Unreadable):
        return False
    return isinstance(root, MappingNode) and bool({"worlds", "parameters"} & set(root.items))
