"""Hypothesis strategies for the values of any message, made from its row of the table."""

from typing import Any

import numpy as np
from hypothesis import strategies as st

from player.messages import MessageSpec
from player.xdr import Array, Kind, Octets, Record, Scalar, Text

_FLOATS = {"f": 32, "d": 64}


def scalars(kind: Scalar) -> st.SearchStrategy[Any]:
    if kind.code in _FLOATS:
        return st.floats(width=_FLOATS[kind.code], allow_nan=False)
    if kind.code == "i":
        return st.integers(-(2**31), 2**31 - 1)
    return st.integers(0, kind.top or 2**32 - 1)


def values_of(kind: Kind) -> st.SearchStrategy[Any]:
    if isinstance(kind, Scalar):
        return scalars(kind)
    if isinstance(kind, Record):
        return st.tuples(*(scalars(s) for s in kind.scalars)).map(lambda t: kind.make(*t))
    if isinstance(kind, Array):
        return st.lists(values_of(kind.element), max_size=4)
    if isinstance(kind, Octets):
        return st.binary(max_size=min(kind.top or 9, 9))
    assert isinstance(kind, Text)
    # A NUL at the end of a C string is not part of it, and UTF-8 has no lone surrogates.
    text = st.text(st.characters(exclude_categories=["Cs"]), max_size=10)
    return text.map(lambda t: t.rstrip("\0"))


def messages_of(spec: MessageSpec) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries({name: values_of(kind) for name, kind in spec.fields})


def plain(value: Any) -> Any:
    """A decoded value as lists, tuples and numbers, to be compared with what was encoded."""
    if isinstance(value, np.ndarray):
        rows = value.tolist()
        return [tuple(row) if isinstance(row, list) else row for row in rows]
    return value
