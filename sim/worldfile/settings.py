"""Settings from the command line: `models.painter.drive.max_speed=0.3` laid upon a read file."""

from __future__ import annotations

from dataclasses import replace

from sim.worldfile.mistakes import Mistake
from sim.worldfile.nodes import ListNode, MappingNode, Mark, Node, ScalarNode
from sim.worldfile.reader import Unreadable, read_text


class BadSetting(Exception):
    """A setting that cannot be laid upon the file; `mistakes` says why."""

    def __init__(self, *mistakes: Mistake) -> None:
        super().__init__("; ".join(str(mistake) for mistake in mistakes))
        self.mistakes = mistakes


def with_setting(root: MappingNode, setting: str) -> MappingNode:
    """The tree with one setting `KEY=VALUE`: a dotted path (a list index as a number), YAML.

    What the path leads through and is not there yet (or is null) is made. Other places that
    share a value with this one by an alias do not change.
    """
    mark = Mark(f"--set {setting}", None, None)
    key, equals, text = setting.partition("=")
    path = [part.strip() for part in key.strip().split(".")]
    if not equals or not all(path):
        raise BadSetting(
            Mistake((), "is no setting", setting, "KEY=VALUE, such as clock.interval=0.1", "--set")
        )
    if path[0] == "include":
        raise BadSetting(
            Mistake(("include",), "cannot be set; write it into a file", file=mark.file)
        )
    try:
        node, mistakes = read_text(text, mark.file)
    except Unreadable as error:
        raise BadSetting(replace(error.mistake, line=None, column=None)) from None
    if mistakes:
        raise BadSetting(*(replace(mistake, line=None, column=None) for mistake in mistakes))
    value = ScalarNode(mark, None) if node is None else _marked(node, mark)
    changed = _changed(root, path, 0, value, mark)
    assert isinstance(changed, MappingNode)
    return changed


def _changed(node: Node | None, path: list[str], depth: int, value: Node, mark: Mark) -> Node:
    if depth == len(path):
        return value
    key, where = path[depth], tuple(path[:depth])
    if node is None or (isinstance(node, ScalarNode) and node.value is None):
        if key.isdecimal():
            raise BadSetting(Mistake(where, "is no list in the file", None, None, mark.file))
        node = MappingNode(mark, {}, {})
    if isinstance(node, MappingNode):
        below = _changed(node.items.get(key), path, depth + 1, value, mark)
        return replace(
            node,
            items={**node.items, key: below},
            keys={**node.keys, key: mark},
            size=node.size + 1,
        )
    if isinstance(node, ListNode):
        if not key.isdecimal() or int(key) >= len(node.items):
            last = len(node.items) - 1
            raise BadSetting(
                Mistake(
                    where,
                    "has no such place",
                    key,
                    f"a number from 0 to {last}" if last >= 0 else "nothing: the list is empty",
                    mark.file,
                )
            )
        index = int(key)
        below = _changed(node.items[index], path, depth + 1, value, mark)
        return replace(node, items=(*node.items[:index], below, *node.items[index + 1 :]))
    raise BadSetting(
        Mistake(where, f"is a single value, so it has no `{key}`", str(node.value), None, mark.file)
    )


def _marked(node: Node, mark: Mark) -> Node:
    """The tree with every place replaced by the command line."""
    if isinstance(node, ScalarNode):
        return replace(node, mark=mark)
    if isinstance(node, ListNode):
        return replace(node, mark=mark, items=tuple([_marked(item, mark) for item in node.items]))
    items = {key: _marked(item, mark) for key, item in node.items.items()}
    return replace(node, mark=mark, items=items, keys=dict.fromkeys(node.keys, mark))
