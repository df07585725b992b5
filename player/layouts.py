"""How messages lie on the wire, made from the table: structs of numbers, numpy types of rows.

For who fills many messages at once or looks at a few numbers of one; the codec in `xdr`, which
gives and takes all values of a message, is slower. Each layout is made when it is first used.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from functools import cache, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from player import messages
from player.codes import MessageType
from player.header import HEADER
from player.xdr import Array, Field, Record, Scalar, dtype_of

KEPT_TYPES = 512
"""Numpy types that are kept: one for each message and sizes of its arrays."""


class Stretch(NamedTuple):
    """Numbers that follow each other, and the array after them, if there is one."""

    numbers: struct.Struct
    """The numbers, and the array's two counts."""
    array: str
    """The array's name in the table, "" if none follows."""
    element: np.dtype[Any]
    """An element of the array; of mixed records by their names."""
    columns: int
    """Numbers in an element that is a record of one type; 0 for any other."""
    records: struct.Struct
    """The same element as a struct."""


class Form:
    """The bytes of one message: stretches of numbers, between them arrays padded to four bytes."""

    def __init__(self, fields: Sequence[Field]) -> None:
        self.fields = tuple(fields)
        self.stretches: tuple[Stretch, ...] = tuple(_stretches(self.fields))
        self.arrays = tuple(stretch.array for stretch in self.stretches if stretch.array)
        """The names of the arrays, in their order."""

    @property
    def head(self) -> struct.Struct:
        """The numbers before the first array with that array's two counts, or all numbers."""
        return self.stretches[0].numbers

    @property
    def tail(self) -> struct.Struct:
        """The numbers behind the last array, or all numbers if there is none."""
        return self.stretches[-1].numbers

    @property
    def element(self) -> np.dtype[Any]:
        """An element of the first array."""
        return self.stretches[0].element

    @property
    def records(self) -> struct.Struct:
        """An element of the first array as a struct."""
        return self.stretches[0].records

    @property
    def framed(self) -> struct.Struct:
        """The message's header and its numbers in one struct, for messages without arrays."""
        return struct.Struct(HEADER.format + self.head.format[1:])

    def count(self, payload: bytes) -> int | None:
        """The size of the array that the message ends with; None if that does not fit.

        For messages that are numbers, one array and nothing behind it.
        """
        head = self.stretches[0]
        if len(payload) < head.numbers.size:
            return None
        *_, size, again = head.numbers.unpack_from(payload)
        bytes_each = head.element.itemsize * (head.columns or 1)
        fits = size == again and len(payload) == head.numbers.size + size * bytes_each
        return int(size) if fits else None

    def row_type(self, **sizes: int) -> np.dtype[Any]:
        """The whole payload as a numpy type, where the arrays have these sizes.

        Its fields are the table's. Before the array `ranges` stand its counts, `ranges_counts`.
        """
        return _row_type(self, tuple(sizes[name] for name in self.arrays))

    def rows(self, number: int, **sizes: int) -> NDArray[Any]:
        """So many payloads one after the other, shape (number,): zeros, but for the counts."""
        rows = np.zeros(number, self.row_type(**sizes))
        for name in self.arrays:
            rows[f"{name}_counts"] = sizes[name]
        return rows


def _stretches(fields: Sequence[Field]) -> list[Stretch]:
    """A message's fields, cut behind each array."""
    found = []
    codes = ""
    for name, kind in fields:
        if isinstance(kind, Scalar | Record):
            codes += _codes(kind)
            continue
        element: np.dtype[Any] = np.dtype("u1")
        records, columns = "B", 0
        if isinstance(kind, Array):
            element, records = dtype_of(kind.element), _codes(kind.element)
            if isinstance(kind.element, Record) and kind.element.homogeneous:
                columns = len(kind.element.scalars)
        numbers = struct.Struct(f">{codes}II")
        found.append(Stretch(numbers, name, element, columns, struct.Struct(f">{records}")))
        codes = ""
    nothing = np.dtype([]), 0, struct.Struct("")
    return [*found, Stretch(struct.Struct(f">{codes}"), "", *nothing)]


def _codes(kind: Scalar | Record) -> str:
    return kind.code if isinstance(kind, Scalar) else kind.codes


@lru_cache(KEPT_TYPES)
def _row_type(form: Form, sizes: tuple[int, ...]) -> np.dtype[Any]:
    left = iter(sizes)
    arrays = {stretch.array: stretch for stretch in form.stretches}
    columns: list[Any] = []
    for name, kind in form.fields:
        if isinstance(kind, Scalar):
            columns.append((name, dtype_of(kind)))
        elif isinstance(kind, Record):
            many = (len(kind.scalars),) if kind.homogeneous else ()
            columns.append((name, dtype_of(kind), many))
        else:
            size, stretch = next(left), arrays[name]
            shape = (size, stretch.columns) if stretch.columns else (size,)
            columns += [(f"{name}_counts", ">u4", (2,)), (name, stretch.element, shape)]
            if padding := -size * stretch.element.itemsize % 4:
                columns.append((f"{name}_padding", "u1", (padding,)))
    return np.dtype(columns)


@cache
def of(interf: int, type: int, subtype: int) -> Form:
    """How a message of the table lies; raises XdrError if there is none."""
    return Form(messages.known(interf, type, subtype).fields)


def data(interf: int, subtype: int = 1) -> Form:
    """How a device's data lies."""
    return of(interf, MessageType.DATA, subtype)


def command(interf: int, subtype: int = 1) -> Form:
    """How a command to a device lies."""
    return of(interf, MessageType.CMD, subtype)
