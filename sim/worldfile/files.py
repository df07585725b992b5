"""Reads a world file with the files that it includes; names of files in them start at their own."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sim.worldfile import nodes
from sim.worldfile.mistakes import Mistake, listed, suggestion
from sim.worldfile.nodes import ListNode, MappingNode, Mark, Node, ScalarNode
from sim.worldfile.programs import is_file_name
from sim.worldfile.reader import Unreadable, read_text
from sim.worldfile.reading import NotRead, NotThere, is_stream, read_regular, read_stream

MOST_FILES = 200
"""Files that a world may include, each counted as often as it is read."""

LARGEST = 20_000_000
"""Bytes of a world file; a world of 100 000 robots has 8 million."""


@dataclass
class FileSet:
    """The files of one world, read one after the other; `mistakes` of all of them."""

    mistakes: list[Mistake] = field(default_factory=list)
    names: list[str] = field(default_factory=list)  # as shown, in the order of reading
    complete: bool = True  # False: a file is missing or unreadable, so what it says is unknown
    reads: int = 0
    _open: list[str] = field(default_factory=list)

    def read(self, path: Path, asked: Mistake | None = None) -> MappingNode | None:
        """The tree of a file laid upon the files that it includes, or None.

        `asked` is the place that named the file, for a file that is not there.
        """
        real = os.path.realpath(path)
        if real in self._open:
            loop = [*self._open[self._open.index(real) :], real]
            names = [os.path.basename(one) for one in loop]
            self._refuse(asked, path, f"files include each other in a loop: {' -> '.join(names)}")
            return None
        text = self._text(path, asked)
        if text is None:
            self.complete = False
            return None
        shown = str(path)
        if shown not in self.names:
            self.names.append(shown)
        try:
            root, mistakes = read_text(text, shown)
        except Unreadable as error:
            self.mistakes.append(error.mistake)
            self.complete = False
            return None
        self.mistakes += mistakes
        if root is None:
            self._note(Mark(shown, 1, 1), (), "the file is empty", None, "keys of a world file")
            self.complete = False
            return None
        if not isinstance(root, MappingNode):
            what = "a list" if isinstance(root, ListNode) else "a single value"
            self._note(root.mark, (), "a world file is a mapping", what, "`key: value` lines")
            self.complete = False
            return None
        self._open.append(real)
        below = self._included(root, path)
        self._open.pop()
        keys = {key: mark for key, mark in root.keys.items() if key != "include"}
        items = {key: node for key, node in root.items.items() if key != "include"}
        merged = nodes.merged(below, MappingNode(root.mark, items, keys, root.size))
        assert isinstance(merged, MappingNode)
        return merged

    def _included(self, root: MappingNode, path: Path) -> MappingNode:
        below: Node = MappingNode(root.mark, {}, {})
        node = root.items.get("include")
        if node is None:
            return MappingNode(root.mark, {}, {})
        entries = node.items if isinstance(node, ListNode) else (node,)
        for index, entry in enumerate(entries):
            where = ("include", index) if isinstance(node, ListNode) else ("include",)
            name = entry.value if isinstance(entry, ScalarNode) else None
            if not isinstance(name, str) or not name or "\0" in name:
                self._note(
                    entry.mark, where, "must be a file's name", None, "text, or a list of texts"
                )
                continue
            asked = Mistake(where, "", name, None, *entry.mark)
            self.reads += 1
            if self.reads > MOST_FILES:
                self._refuse(asked, path, f"more than {MOST_FILES} files are included")
                break
            included = self.read((path.parent if path.is_file() else folder_of(path)) / name, asked)
            if included is not None:
                below = nodes.merged(below, included)
        assert isinstance(below, MappingNode)
        return MappingNode(root.mark, below.items, below.keys, below.size)

    def _text(self, path: Path, asked: Mistake | None) -> str | None:
        if os.path.isdir(path):
            self._refuse(asked, path, "is a folder, not a world file")
            return None
        # The world file itself may come through a pipe.
        read = read_stream if asked is None and is_stream(path) else read_regular
        try:
            data = read(path, LARGEST)
        except NotThere:
            self._refuse(asked, path, "no such file" + _beside(path))
            return None
        except NotRead as error:
            self._refuse(asked, path, str(error))
            return None
        if b"\0" in data:
            self._refuse(None, path, "is a binary file, not a world file in YAML")
            return None
        try:
            return data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            before = data[: error.start].decode("utf-8-sig")
            line = before.count("\n") + 1
            column = len(before) - (before.rfind("\n") + 1) + 1
            mark = Mark(str(path), line, column)
            self._note(mark, (), "is not UTF-8 text", f"byte 0x{data[error.start]:02x}", None)
            return None

    def _refuse(self, asked: Mistake | None, path: Path, what: str) -> None:
        if asked is None:
            self.mistakes.append(Mistake((), what, file=str(path)))
        else:
            mark = Mark(asked.file or "", asked.line, asked.column)
            self._note(mark, asked.where, what, asked.given, None)
        self.complete = False

    def _note(
        self, mark: Mark, where: nodes.Path, what: str, given: str | None, allowed: str | None
    ) -> None:
        self.mistakes.append(Mistake(where, what, given, allowed, *mark))


def folder_of(path: Path) -> Path:
    """Where relative names in a world file start: its folder; the current one for a pipe."""
    if is_stream(path):
        return Path.cwd()
    return path.resolve().parent


def _beside(path: Path) -> str:
    """What a reader may have meant instead of a file that is not there."""
    try:
        names = sorted(entry.name for entry in path.parent.iterdir() if entry.suffix == path.suffix)
    except OSError:
        return f"; there is no folder {path.parent}"
    hint = suggestion(path.name, names)
    return hint or (f"; there are {listed(names, 8)}" if names else "")


def rebased(data: dict[str, Any], root: Node, folder: Path) -> dict[str, Any]:
    """The data with names of files that start elsewhere than at `folder` made absolute.

    A name starts at the folder of the file that it is written in. One from the command line
    starts at the world file's folder, or, where there is no such file, at the current one.
    """

    def placed(value: Any, where: nodes.Path) -> Any:
        if not isinstance(value, str) or not value or os.path.isabs(value):
            return value
        mark = nodes.mark_of(root, where)
        if mark.line is None:
            here = Path.cwd() / value
            return str(here) if not (folder / value).exists() and here.exists() else value
        home = folder_of(Path(mark.file))
        return value if home == folder else str(home / value)

    return renamed(data, placed)


def absolute(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The data with names of files that start at `folder` made absolute."""

    def placed(value: Any, where: nodes.Path) -> Any:
        relative = isinstance(value, str) and value and not os.path.isabs(value)
        return str(folder / value) if relative else value

    return renamed(data, placed)


def renamed(data: dict[str, Any], placed: Callable[[Any, nodes.Path], Any]) -> dict[str, Any]:
    """The data with `placed(name, where)` in place of every name of a file."""

    def changed(value: Any, where: nodes.Path, key: str) -> Any:
        if not isinstance(value, Mapping) or key not in value:
            return value
        if key == "file" or (isinstance(value[key], str) and is_file_name(value[key])):
            return {**value, key: placed(value[key], (*where, key))}
        return value

    out = dict(data)
    if "map" in out:
        out["map"] = changed(out["map"], ("map",), "file")
    if isinstance(out.get("controllers"), Mapping):
        out["controllers"] = {
            name: _command(changed(one, ("controllers", name), "program"), name, placed)
            for name, one in out["controllers"].items()
        }
    if isinstance(out.get("models"), Mapping):
        models = {}
        for name, model in out["models"].items():
            models[name] = model
            if isinstance(model, Mapping) and isinstance(model.get("sensors"), tuple):
                where = ("models", name, "sensors")
                sensors = tuple(
                    changed(sensor, (*where, index), "type")
                    for index, sensor in enumerate(model["sensors"])
                )
                models[name] = {**model, "sensors": sensors}
        out["models"] = models
    return out


def _command(controller: Any, name: str, placed: Any) -> Any:
    """A controller whose `command` begins with a file's name, with that file's place."""
    if not isinstance(controller, Mapping) or not isinstance(controller.get("command"), tuple):
        return controller
    words = controller["command"]
    if not words or not isinstance(words[0], str) or "/" not in words[0]:
        return controller
    return {
        **controller,
        "command": (placed(words[0], ("controllers", name, "command", 0)), *words[1:]),
    }
