"""JSON as every reader takes it (RFC 8259 and I-JSON): what is let in, and what is written.

Python's own module reads and writes more than that: infinities and NaN, halves of surrogate pairs,
integers that no double holds, and depths that it can read but not write again.
"""

from __future__ import annotations

import json
import math
from typing import Any

DEEPEST = 100
"""Levels of lists and objects within each other."""


def loads(text: str) -> Any:
    """The value of JSON text; ValueError, which says why, for what not every reader takes."""
    try:
        value = json.loads(
            text, parse_constant=no_number, parse_float=number, parse_int=whole_number
        )
    except RecursionError:
        raise ValueError(TOO_DEEP) from None
    check(value)
    return value


TOO_DEEP = f"it is nested more than {DEEPEST} levels deep"


def no_number(text: str) -> Any:
    raise ValueError(f"{text[:40]} is no number in JSON")


def number(text: str) -> float:
    value = float(text)
    return value if math.isfinite(value) else no_number(text)


def whole_number(text: str) -> int:
    number(text)  # readers have doubles: beyond those there is nothing for them
    return int(text)


def check(value: Any) -> None:
    """Level by level, so that the depth does not matter: ValueError for what is not to come in."""
    level = [value]
    for depth in range(DEEPEST + 1):
        below: list[Any] = []
        for item in level:
            if isinstance(item, str):
                item.encode()  # UnicodeEncodeError is a ValueError
            elif isinstance(item, dict | list) and depth == DEEPEST:
                raise ValueError(TOO_DEEP)
            elif isinstance(item, dict):
                below += item.keys()
                below += item.values()
            elif isinstance(item, list):
                below += item
        if not below:
            return
        level = below


def plain(value: Any) -> Any:
    """The same value as it can be written.

    A number that is not finite becomes null, and half of a surrogate pair, which is no character,
    is written out as `\\udc80`.
    """
    if isinstance(value, str):
        return value.encode(errors="backslashreplace").decode()
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {plain(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value


def dumps(value: Any) -> str:
    """JSON text, made whole before any of it is written."""
    return json.dumps(plain(value), allow_nan=False)
