"""A read file as a tree of values in which every key and value knows its file, line and column."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from sim.worldfile.scalars import Scalar

Path = tuple[str | int, ...]


class Mark(NamedTuple):
    """A place in a file: its name as the user wrote it, line and column from 1.

    `line` and `column` are None for what was given on the command line.
    """

    file: str
    line: int | None
    column: int | None


@dataclass(frozen=True, slots=True)
class ScalarNode:
    """A text, number, truth value or null."""

    mark: Mark
    value: Scalar
    size: int = 1


@dataclass(frozen=True, slots=True)
class ListNode:
    """A sequence."""

    mark: Mark
    items: tuple[Node, ...]
    size: int = 1  # values in the whole subtree, aliases counted as often as they stand


@dataclass(frozen=True, slots=True)
class MappingNode:
    """A mapping; the keys' own marks stand in `keys`."""

    mark: Mark
    items: Mapping[str, Node]
    keys: Mapping[str, Mark] = field(default_factory=dict)
    size: int = 1


Node = ScalarNode | ListNode | MappingNode


def plain(node: Node) -> Any:
    """The tree as dicts, tuples and scalars."""
    if isinstance(node, ScalarNode):
        return node.value
    if isinstance(node, ListNode):
        return tuple([plain(item) for item in node.items])
    return {key: plain(item) for key, item in node.items.items()}


def child(node: Node, key: str | int) -> Node | None:
    """The value at a key or list index, or None where there is none."""
    if isinstance(node, MappingNode):
        return node.items.get(str(key))
    if isinstance(node, ListNode) and isinstance(key, int) and 0 <= key < len(node.items):
        return node.items[key]
    return None


def at(root: Node, where: Path) -> Node | None:
    """What stands at `where`, or None."""
    node: Node | None = root
    for key in where:
        node = None if node is None else child(node, key)
    return node


def mark_of(root: Node, where: Path, *, at_key: bool = False) -> Mark:
    """The place of the value at `where` (of its key with `at_key`).

    Where the path leads to something that is not there (a missing key), the place of the
    last part that is: its key if it stands under one.
    """
    node = root
    mark, key_mark = root.mark, root.mark
    for key in where:
        below = child(node, key)
        if below is None:
            return key_mark
        key_mark = below.mark
        if isinstance(node, MappingNode):
            key_mark = node.keys.get(str(key), below.mark)
        node, mark = below, below.mark
    return key_mark if at_key else mark


def merged(under: Node, over: Node) -> Node:
    """`over` laid upon `under`: mappings merge key by key, anything else is replaced."""
    if not (isinstance(under, MappingNode) and isinstance(over, MappingNode)):
        return over
    items = dict(under.items)
    for key, node in over.items.items():
        items[key] = merged(items[key], node) if key in items else node
    return MappingNode(over.mark, items, {**under.keys, **over.keys}, under.size + over.size)
