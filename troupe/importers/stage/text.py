"""World files as text: YAML 1.2 with a comment behind each thing that says where it comes from."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

_PLAIN = re.compile(r"[A-Za-z_][\w./-]*|\.{0,2}/[\w./-]*")
_NOT_TEXT = {"true", "false", "null", "yes", "no", "on", "off", "y", "n"}


@dataclass(frozen=True)
class Line:
    """A value that is written on one line, and the comment behind it."""

    value: Any
    comment: str = ""


Block = Mapping[str, "Node"]
Node = Line | Block | Sequence[Line]


def dump(block: Block, indent: int = 0) -> str:
    """A mapping as lines of text; an empty key stands for a blank line."""
    lines: list[str] = []
    blank = " " * indent
    for key, node in block.items():
        if not key.strip():
            lines.append("")
        elif isinstance(node, Line):
            lines.append(f"{blank}{scalar(key)}: {flow(node.value)}{_behind(node.comment)}")
        elif isinstance(node, Mapping):
            lines.append(f"{blank}{scalar(key)}:")
            lines.append(dump(node, indent + 2))
        else:
            lines.append(f"{blank}{scalar(key)}:")
            lines += [f"{blank}  - {flow(item.value)}{_behind(item.comment)}" for item in node]
    return "\n".join(lines)


def _behind(comment: str) -> str:
    return f"  # {comment}" if comment else ""


def flow(value: Any) -> str:
    """A value in YAML's one-line style."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{scalar(str(k))}: {flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(flow, value)) + "]"
    return scalar(value)


def scalar(value: Any) -> str:
    """A text, number, truth value or null; numbers to nine digits."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        number = float(f"{value:.9g}")
        if abs(number) < 1e-9:  # what rounding leaves of a zero
            return "0"
        return str(int(number)) if number == int(number) and abs(number) < 1e9 else f"{number:.9g}"
    text = str(value)
    if _PLAIN.fullmatch(text) and text.lower() not in _NOT_TEXT:
        return text
    return json.dumps(text, ensure_ascii=False)
