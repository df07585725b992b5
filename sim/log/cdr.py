"""Messages as bytes: the CDR encoding of ROS 2, little-endian, as the definitions say."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.log.definitions import PRIMITIVES, fields

HEAD = b"\x00\x01\x00\x00"
"""Begins every message: plain CDR, little-endian. Alignment counts from behind it."""
DTYPES = {name: np.dtype(kind) for name, kind in PRIMITIVES.items()}
CODES = {
    "b1": "?", "u1": "B", "i1": "b", "u2": "H", "i2": "h", "u4": "I", "i4": "i", "u8": "Q",
    "i8": "q", "f4": "f", "f8": "d",
}  # fmt: skip
STRUCTS = {name: struct.Struct("<" + CODES[kind.str[1:]]) for name, kind in DTYPES.items()}
Places = dict[str, list[int]]


class Encoder:
    """One message that is being written.

    With `traced`, `places` says where in `data` each field's values stand, `kinds` of which type.
    """

    def __init__(self, traced: bool = False) -> None:
        self.data = bytearray()
        self.traced = traced
        self.places: Places = {}
        self.kinds: dict[str, np.dtype[Any]] = {}

    def message(self, name: str, values: Mapping[str, Any], path: str = "") -> None:
        """Append a message of a type; fields that `values` has not are 0 or empty."""
        for field in fields(name):
            value = values.get(field.name)
            where = f"{path}.{field.name}" if self.traced and path else field.name
            if field.length is None:
                self._one(field.type, value, where)
            elif field.length == 0:
                value = () if value is None else value
                self._number("uint32", len(value), where + "#")
                self._many(field.type, value, where)
            else:
                self._many(field.type, [0] * field.length if value is None else value, where)

    def _one(self, kind: str, value: Any, path: str) -> None:
        if kind == "string":
            data = (value or "").encode(errors="replace") + b"\0"
            self._number("uint32", len(data), path + "#")
            if self.traced:
                start = len(self.data)
                self.places.setdefault(path, []).extend(range(start, start + len(data) - 1))
            self.data += data
        elif kind in STRUCTS:
            self._number(kind, value or 0, path)
        else:
            self.message(kind, value or {}, path)

    def _many(self, kind: str, values: Any, path: str) -> None:
        if kind in DTYPES:
            if len(values):
                self._numbers(DTYPES[kind], values, path)
        elif isinstance(values, np.ndarray):  # of messages that are numbers of one type, as points
            if len(values):
                self._numbers(DTYPES[fields(kind)[0].type], values, path)
        else:
            for value in values:
                self._one(kind, value, path)

    def _number(self, kind: str, value: Any, path: str) -> None:
        packed = STRUCTS[kind]
        over = len(self.data) % packed.size
        if over:
            self.data += bytes(packed.size - over)
        if self.traced:
            self.places.setdefault(path, []).append(len(self.data))
            self.kinds[path] = DTYPES[kind]
        self.data += packed.pack(value)

    def _numbers(self, dtype: np.dtype[Any], values: Any, path: str) -> None:
        numbers = np.asarray(values, dtype).reshape(-1)
        size = dtype.itemsize
        self.data += bytes(-len(self.data) % size)
        if self.traced:
            at = len(self.data)
            self.places.setdefault(path, []).extend(range(at, at + size * len(numbers), size))
            self.kinds[path] = dtype
        self.data += numbers.tobytes()


def encode(name: str, values: Mapping[str, Any]) -> bytes:
    """The bytes of a message of a type such as `troupe_msgs/Said`."""
    encoder = Encoder()
    encoder.message(name, values)
    return HEAD + bytes(encoder.data)


def decode(name: str, data: bytes) -> dict[str, Any]:
    """The message back: numbers, texts, arrays, and dicts for messages in it."""
    value, _ = _message(name, data[len(HEAD) :], 0)
    return value


def _message(name: str, data: bytes, at: int) -> tuple[dict[str, Any], int]:
    found: dict[str, Any] = {}
    for field in fields(name):
        count = field.length
        if count == 0:
            length, at = _numbers(DTYPES["uint32"], data, at, 1)
            count = int(length[0])
        if field.type in DTYPES:
            numbers, at = _numbers(DTYPES[field.type], data, at, 1 if count is None else count)
            found[field.name] = numbers[0].item() if count is None else numbers
            continue
        values = []
        for _ in range(1 if count is None else count):
            value, at = (
                _string(data, at) if field.type == "string" else _message(field.type, data, at)
            )
            values.append(value)
        found[field.name] = values[0] if count is None else values
    return found, at


def _string(data: bytes, at: int) -> tuple[Any, int]:
    length, at = _numbers(DTYPES["uint32"], data, at, 1)
    end = at + int(length[0])
    return data[at : max(at, end - 1)].decode(errors="replace"), end


def _numbers(dtype: np.dtype[Any], data: bytes, at: int, count: int) -> tuple[NDArray[Any], int]:
    if count:
        at += -at % dtype.itemsize
    end = at + count * dtype.itemsize
    if end > len(data):
        raise ValueError("a message ends too early")
    return np.frombuffer(data, dtype, count, at), end


def stamp(time: float) -> dict[str, int]:
    """Simulated seconds as a ROS time."""
    nanoseconds = round(time * 1e9)
    return {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}
