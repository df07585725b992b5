"""Text in YAML to a tree of marked values: plain data only, every mistake with its place."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import yaml

from sim.worldfile.mistakes import Mistake
from sim.worldfile.nodes import ListNode, MappingNode, Mark, Node, Path, ScalarNode
from sim.worldfile.scalars import core_scalar

MOST_DEPTH = 50
"""Nesting allowed; the schema needs 7, and the YAML parser's own stack must not overflow."""

MOST_ALIASED = 200_000
"""Values that aliases may add to a file, so that a few lines cannot fill the memory."""

_NOT_IN_YAML = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""YAML 1.2, section 5.1: what no printable character may be."""

_Parser = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # libyaml's parser is ten times faster


class Unreadable(Exception):
    """The text is no YAML, or none that may be read any further; `mistake` says why."""

    def __init__(self, mistake: Mistake) -> None:
        super().__init__(str(mistake))
        self.mistake = mistake


_Valued = (yaml.ScalarEvent, yaml.SequenceStartEvent, yaml.MappingStartEvent)


@dataclass
class _Composition:
    """One pass over the events of a document."""

    file: str
    events: Iterator[yaml.Event]
    mistakes: list[Mistake] = field(default_factory=list)
    anchors: dict[str, Node | None] = field(default_factory=dict)  # None: not complete yet
    aliased: int = 0

    def mark(self, event: yaml.Event) -> Mark:
        start = event.start_mark
        assert start is not None  # events of a parser have marks
        return Mark(self.file, start.line + 1, start.column + 1)

    def mistake(
        self,
        mark: Mark,
        where: Path,
        what: str,
        given: str | None = None,
        allowed: str | None = None,
    ) -> Mistake:
        return Mistake(where, what, given, allowed, *mark)

    def note(
        self,
        mark: Mark,
        where: Path,
        what: str,
        given: str | None = None,
        allowed: str | None = None,
    ) -> None:
        self.mistakes.append(self.mistake(mark, where, what, given, allowed))

    def node(self, event: yaml.Event, where: Path) -> Node:
        if isinstance(event, yaml.AliasEvent):
            return self.alias(event, where)
        assert isinstance(event, _Valued)
        mark = self.mark(event)
        if len(where) > MOST_DEPTH:
            raise Unreadable(
                self.mistake(mark, where[:4], f"nested more than {MOST_DEPTH} levels deep")
            )
        if event.tag is not None:
            self.note(
                mark,
                where,
                "tags have no meaning here",
                event.tag,
                "plain values; put text that looks like a number into quotes",
            )
        if event.anchor is not None:
            self.anchors[event.anchor] = None
        if isinstance(event, yaml.ScalarEvent):
            node: Node = self.scalar(event, mark, where)
        elif isinstance(event, yaml.SequenceStartEvent):
            node = self.sequence(mark, where)
        else:
            node = self.mapping(mark, where)
        if event.anchor is not None:
            self.anchors[event.anchor] = node
        return node

    def alias(self, event: yaml.AliasEvent, where: Path) -> Node:
        mark = self.mark(event)
        if event.anchor not in self.anchors:
            raise Unreadable(
                self.mistake(
                    mark, where, "an alias of nothing that stands before it", f"*{event.anchor}"
                )
            )
        node = self.anchors[event.anchor]
        if node is None:
            raise Unreadable(
                self.mistake(
                    mark, where, "an alias of something that it stands in", f"*{event.anchor}"
                )
            )
        self.aliased += node.size
        if self.aliased > MOST_ALIASED:
            raise Unreadable(
                self.mistake(mark, where, f"aliases stand for more than {MOST_ALIASED} values")
            )
        return node

    def scalar(self, event: yaml.ScalarEvent, mark: Mark, where: Path) -> ScalarNode:
        if not event.implicit[0] or event.tag is not None:
            return ScalarNode(mark, event.value)
        try:
            return ScalarNode(mark, core_scalar(event.value))
        except ValueError as error:
            self.note(mark, where, f"{error} is too large for anything here")
            return ScalarNode(mark, None)

    def sequence(self, mark: Mark, where: Path) -> ListNode:
        items: list[Node] = []
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            items.append(self.node(event, (*where, len(items))))
        return ListNode(mark, tuple(items), 1 + sum([item.size for item in items]))

    def mapping(self, mark: Mark, where: Path) -> MappingNode:
        items: dict[str, Node] = {}
        keys: dict[str, Mark] = {}
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            key_mark = self.mark(event)
            key = self.key(event, key_mark, where)
            event = next(self.events)
            value = self.node(event, (*where, "?" if key is None else key))
            if isinstance(event, yaml.ScalarEvent) and event.value == "" and event.implicit[0]:
                # a value that is not written has its mark where the next thing begins
                value = ScalarNode(key_mark, value.value if isinstance(value, ScalarNode) else None)
            if key is None:
                continue
            if key in items:
                first = keys[key].line
                self.note(key_mark, (*where, key), f"this key stands twice; first in line {first}")
                continue
            items[key], keys[key] = value, key_mark
        return MappingNode(mark, items, keys, 1 + sum([item.size for item in items.values()]))

    def key(self, event: yaml.Event, mark: Mark, where: Path) -> str | None:
        node = self.node(event, (*where, "?"))
        if not isinstance(node, ScalarNode):
            self.note(mark, where, "a key must be text", "a list or mapping as a key")
            return None
        if node.value == "<<" and isinstance(event, yaml.ScalarEvent) and event.implicit[0]:
            self.note(
                mark,
                where,
                "merge keys are not part of YAML 1.2",
                "<<",
                "`include` another file (mappings merge), or an alias for a whole value",
            )
            return None
        if not isinstance(node.value, str):
            written = getattr(event, "value", str(node.value))
            self.note(mark, where, "a key must be text", written, f'in quotes: "{written}"')
            return None
        return node.value


def read_text(text: str, file: str) -> tuple[Node | None, list[Mistake]]:
    """Reads one YAML document. Returns the tree and the mistakes after which reading went on.

    The tree is None for a text without a document (empty, or comments alone). Raises
    `Unreadable` where nothing sensible can be read any further.
    """
    events: Iterator[yaml.Event] = yaml.parse(text, Loader=_Parser)
    composition = _Composition(file, events)
    root: Node | None = None
    try:
        for event in events:
            if isinstance(event, yaml.DocumentStartEvent):
                if root is not None:
                    composition.note(
                        composition.mark(event),
                        (),
                        "a second document begins",
                        "---",
                        "one document",
                    )
                    break
            elif isinstance(event, yaml.NodeEvent):
                root = composition.node(event, ())
    except yaml.MarkedYAMLError as error:
        raise Unreadable(_syntax_mistake(error, text, file)) from None
    except yaml.YAMLError as error:  # a reader's error: a character that YAML does not allow
        raise Unreadable(_character_mistake(error, text, file)) from None
    if isinstance(root, ScalarNode) and root.value is None:
        root = None
    return root, composition.mistakes


def _syntax_mistake(error: yaml.MarkedYAMLError, text: str, file: str) -> Mistake:
    mark = error.problem_mark or error.context_mark
    what = "not YAML: " + ", ".join(part for part in (error.problem, error.context) if part)
    if mark is None:
        return Mistake((), what, file=file)
    lines = text.splitlines()
    line = lines[mark.line] if mark.line < len(lines) else ""
    if "\t" in line[: len(line) - len(line.lstrip())]:
        what += "; indent with spaces, not with tabs"
    return Mistake((), what, file=file, line=mark.line + 1, column=mark.column + 1)


def _character_mistake(error: yaml.YAMLError, text: str, file: str) -> Mistake:
    found = _NOT_IN_YAML.search(text)
    if found is None:
        return Mistake((), f"not YAML: {error}", file=file)
    line = text.count("\n", 0, found.start()) + 1
    column = found.start() - text.rfind("\n", 0, found.start())
    what = f"the character U+{ord(found.group()):04X} is not allowed in YAML"
    return Mistake((), what, file=file, line=line, column=column)
