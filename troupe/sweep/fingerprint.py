"""The name of a run's world: a hash of all that the world file and the files it names say.

Where a file lies does not matter, what is in it does: a sweep's folder can be taken up again on
another machine, and a controller that has changed makes other runs.
"""

from __future__ import annotations

import ast
import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sim.build import LoadedWorld
from sim.worldfile import nodes
from sim.worldfile.files import rebased
from sim.worldfile.nodes import ListNode, MappingNode, Node
from sim.worldfile.programs import is_file_name
from troupe.sweep.results import Judge
from troupe.sweep.versions import versions

LENGTH = 16
"""Hexadecimal digits of a hash: two of 10^6 worlds share one with a chance of 3 in 10^8."""

NO_MATTER = ("seed", "duration", "name", "video")
"""Keys of a world that are told apart from it, or that do not change a result."""

Stamp = tuple[str, int, int]
"""A file's path, size and time of change in ns."""


@dataclass(frozen=True)
class Fingerprint:
    """A world's hash, and the files that it was made of as they were then."""

    hash: str
    stamps: tuple[Stamp, ...]

    def holds(self) -> bool:
        """Whether the files are what they were."""
        return holds(self.stamps)


def holds(stamps: Iterable[Stamp]) -> bool:
    """Whether files are what they were."""
    return all(stamp(Path(one[0])) == one for one in stamps)


def hash_of(told: Mapping[str, Any]) -> str:
    """The name that follows from all that is told."""
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:LENGTH]


def fingerprint(loaded: LoadedWorld, duration: float, judges: Sequence[Judge] = ()) -> Fingerprint:
    """The hash of a loaded world that is run for so many simulated seconds at most.

    Runs that are judged are others than those that are not, or by other judges.
    """
    files: set[Path] = {loaded.path.resolve()} | {
        Path(name).resolve() for name in sources_of(loaded.root) if Path(name).is_file()
    }
    data = rebased(nodes.plain(loaded.root), loaded.root, loaded.folder)
    if isinstance(data.get("controllers"), Mapping):  # what drives nobody changes no result
        used = drivers(loaded)
        data["controllers"] = {k: v for k, v in data["controllers"].items() if k in used}
    for key in NO_MATTER:
        data.pop(key, None)
    told: dict[str, Any] = {
        "world": with_contents(data, loaded.folder, files),
        "duration": duration,
        "versions": versions(),
    }
    if judges:
        told["judges"] = [[one.name, judge_digest(one, loaded.folder, files)] for one in judges]
    stamps = tuple(stamp(path) for path in sorted(files))
    return Fingerprint(hash_of(told), stamps)


def drivers(loaded: LoadedWorld) -> set[str]:
    """The names of the controllers that drive somebody."""
    named = {robot.controller for robot in loaded.robots}
    named |= {door.controller for door in loaded.layout.doors}
    return {name for name in named if name is not None}


def judge_digest(judge: Judge, folder: Path, files: set[Path]) -> str:
    """A digest of the file in which a judge stands, with the modules beside it that it imports."""
    source = judge.source
    return "" if source is None else digest_of(source.resolve(), folder, files)


def stamp(path: Path) -> Stamp:
    """What tells of a file whether it has been changed; zeros for one that is not there."""
    try:
        found = path.stat()
    except OSError:
        return (str(path), 0, 0)
    return (str(path), found.st_size, found.st_mtime_ns)


def sources_of(node: Node) -> set[str]:
    """The files that a read world's values stand in."""
    found: set[str] = set()
    waiting: list[Node] = [node]
    while waiting:
        one = waiting.pop()
        if one.mark.line is not None:
            found.add(one.mark.file)
        if isinstance(one, MappingNode):
            waiting += one.items.values()
        elif isinstance(one, ListNode):
            waiting += one.items
    return found


def with_contents(data: dict[str, Any], folder: Path, files: set[Path]) -> dict[str, Any]:
    """The world's values with digests in place of files' names; the files are added to `files`."""

    def contents(name: str) -> str:
        return digest_of((folder / name).resolve(), folder, files)

    def changed(value: Any, key: str) -> Any:
        name = value.get(key) if isinstance(value, Mapping) else None
        if not isinstance(name, str) or not name or not (key == "file" or is_file_name(name)):
            return value
        return {**value, key: contents(name)}

    out = dict(data)
    if isinstance(out.get("map"), Mapping):
        out["map"] = changed(out["map"], "file")
    if isinstance(out.get("models"), Mapping):
        out["models"] = {
            name: {**model, "sensors": [changed(one, "type") for one in model["sensors"]]}
            if isinstance(model, Mapping) and isinstance(model.get("sensors"), tuple)
            else model
            for name, model in out["models"].items()
        }
    if isinstance(out.get("controllers"), Mapping):
        out["controllers"] = {
            name: _command(changed(one, "program"), folder, contents)
            for name, one in out["controllers"].items()
        }
    return out


def _command(controller: Any, folder: Path, contents: Any) -> Any:
    """A controller whose command's words that name files are replaced by what is in these."""
    if not isinstance(controller, Mapping) or not isinstance(controller.get("command"), tuple):
        return controller
    words = []
    for number, word in enumerate(controller["command"]):
        path = (folder / word if number == 0 else Path(word)) if isinstance(word, str) else None
        named = path is not None and (number > 0 or "/" in str(word)) and path.is_file()
        words.append(contents(str(path.resolve())) if named and path is not None else word)
    return {**controller, "command": words}


def digest_of(
    path: Path, folder: Path, files: set[Path], leave: Callable[[Path], bool] = lambda path: False
) -> str:
    """A digest of a file; of a Python program with the modules beside it that it imports.

    `leave(path)`: whether such a module is told otherwise.
    """
    digest = hashlib.sha256()
    waiting, seen = [path], {path}
    parts = []
    while waiting:
        one = waiting.pop()
        files.add(one)
        try:
            data = one.read_bytes()
        except OSError:
            data = b""
        parts.append(hashlib.sha256(data).hexdigest())
        if one.suffix == ".py":
            for found in imported(data, (one.parent, path.parent, folder)):
                if found not in seen and not leave(found):
                    seen.add(found)
                    waiting.append(found)
    for part in [parts[0], *sorted(parts[1:])]:
        digest.update(part.encode())
    return digest.hexdigest()


def imported(source: bytes, folders: tuple[Path, ...]) -> Iterator[Path]:
    """The files in these folders of the modules that a program imports, as far as it is seen."""
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError):
        return
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            names |= {base, *(f"{base}.{alias.name}".strip(".") for alias in node.names)}
    for name in sorted(names - {""}):
        parts = name.split(".")
        for folder in folders:
            for depth in range(1, len(parts) + 1):
                place = folder.joinpath(*parts[:depth])
                for path in (place.with_name(place.name + ".py"), place / "__init__.py"):
                    if path.is_file():
                        yield path.resolve()
