"""A world given as Python data, as the tree of values that a file's text becomes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

import numpy as np

from sim.worldfile.mistakes import Mistake
from sim.worldfile.nodes import ListNode, MappingNode, Mark, Node, Path, ScalarNode
from sim.worldfile.reader import MOST_DEPTH

NOWHERE = Mark("", None, None)
"""The place of what stands in no file."""


def node_of(data: Any, mistakes: list[Mistake], where: Path = ()) -> Node:
    """The tree of mappings, sequences, arrays and scalars; what is none of them is a mistake."""
    if isinstance(data, np.ndarray | np.generic):
        data = data.tolist()
    if isinstance(data, PurePath):
        data = str(data)
    if data is None or isinstance(data, str | bool | int | float):
        return ScalarNode(NOWHERE, data)
    if len(where) >= MOST_DEPTH:
        mistakes.append(Mistake(where, f"is nested deeper than {MOST_DEPTH} levels"))
        return ScalarNode(NOWHERE, None)
    if isinstance(data, Mapping):
        items = {}
        for key, value in data.items():
            if not isinstance(key, str):
                mistakes.append(Mistake(where, "has a key that is no text", repr(key)))
                continue
            items[key] = node_of(value, mistakes, (*where, key))
        return MappingNode(NOWHERE, items, dict.fromkeys(items, NOWHERE))
    if isinstance(data, Sequence) and not isinstance(data, bytes | bytearray):
        entries = [node_of(value, mistakes, (*where, i)) for i, value in enumerate(data)]
        return ListNode(NOWHERE, tuple(entries))
    what = f"a {type(data).__name__}"
    mistakes.append(Mistake(where, "is nothing that a world can say", what, "plain data"))
    return ScalarNode(NOWHERE, None)
