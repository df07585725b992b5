"""Codecs of the messages in the table: payload bytes <-> fields, by interface, type and subtype.

A codec is compiled when its message is first used.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from math import isfinite
from typing import Any

import numpy as np

from player.codes import Interface, MessageType, interface_name
from player.errors import XdrError
from player.table import EMPTY, TABLE, UNIVERSAL, Fields
from player.xdr import Array, Layout, Record, Scalar, Values

_NACK_TYPE = int(MessageType.NACK)


class MessageSpec:
    """One row of the table; its codec is compiled when it is first needed."""

    def __init__(self, interf: int, type: int, subtype: int, name: str, fields: Fields) -> None:
        self.interf = int(interf)
        self.type = int(type)
        self.subtype = subtype
        self.name = name
        self.fields = fields

    def __repr__(self) -> str:
        where = interface_name(self.interf) if self.interf else "any"
        return f"{where} {MessageType(self.type).name} {self.subtype} ({self.name})"

    @cached_property
    def layout(self) -> Layout:
        """The compiled codec."""
        return Layout(self.fields)

    def encode(self, values: Mapping[str, Any]) -> bytes:
        """The payload of `values`; raises XdrError, which names the message and the field."""
        try:
            return self.layout.pack(values)
        except XdrError as error:
            raise XdrError(f"{self!r}: {error}") from None

    def decode(self, payload: bytes) -> Values:
        """The values of `payload`; raises XdrError unless it fits to its last byte."""
        try:
            return self.layout.unpack(payload)
        except XdrError as error:
            raise XdrError(f"{self!r}: {error}") from None

    def check_finite(self, values: Mapping[str, Any]) -> None:
        """Raises XdrError, which names the field, where a NaN or an infinity is among the numbers.

        `values` are such as `encode` has taken.
        """
        for name, kind in self.fields:
            if isinstance(kind, Scalar | Record | Array) and not _finite(kind, values[name]):
                raise XdrError(f"{self!r}: {name}: {values[name]!r} is not a finite number")


def _finite(kind: Scalar | Record | Array, value: Any) -> bool:
    if isinstance(kind, Scalar):
        return kind.code not in "fd" or isfinite(value)
    if isinstance(kind, Record):
        return all(map(_finite, kind.scalars, value))
    element = kind.element
    if isinstance(element, Record) and not element.homogeneous:
        return all(_finite(element, row) for row in value)
    return bool(np.isfinite(np.asarray(value, np.float64)).all())


_SPECS = {(int(i), int(t), s): MessageSpec(i, t, s, name, f) for i, t, s, name, f in TABLE}
_UNIVERSAL = {(int(t), s): MessageSpec(0, t, s, name, f) for t, s, name, f in UNIVERSAL}
_NACK = MessageSpec(0, _NACK_TYPE, 0, "refused", EMPTY)


def find(interf: int, type: int, subtype: int) -> MessageSpec | None:
    """The message's row, None if the protocol (as far as Troupe knows it) has no such message."""
    spec = _SPECS.get((interf, type, subtype))
    if spec is None and interf != Interface.PLAYER:
        spec = _UNIVERSAL.get((type, subtype))
    if spec is None and type == _NACK_TYPE:
        return _NACK
    return spec


def specs() -> Iterable[MessageSpec]:
    """All rows: of the interfaces, then those of any interface."""
    return [*_SPECS.values(), *_UNIVERSAL.values()]


def known(interf: int, type: int, subtype: int) -> MessageSpec:
    """The message's row; raises XdrError if there is none."""
    spec = find(interf, type, subtype)
    if spec is None:
        raise XdrError(f"no message {interface_name(interf)} type {type} subtype {subtype}")
    return spec


def encode(interf: int, type: int, subtype: int, /, **values: Any) -> bytes:
    """The payload of one message, by its numbers and fields; raises XdrError."""
    return known(interf, type, subtype).encode(values)


def decode(interf: int, type: int, subtype: int, payload: bytes) -> Values:
    """The fields of one message's payload; raises XdrError."""
    return known(interf, type, subtype).decode(payload)
