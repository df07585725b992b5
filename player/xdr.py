"""Player's XDR: layouts of scalars, records, arrays and strings, packed and unpacked.

Everything is big-endian and a multiple of four bytes long (RFC 4506); integers of 8 and 16 bits
travel as 32. Player's quirk: a dynamic array is its count, then the XDR array, which starts with
the count again: `count, count, elements`. Bytes and strings are padded to four with zeros, and a
string's count includes its terminating NUL.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from player.errors import XdrError

Values = dict[str, Any]
"""A decoded message: field name -> number, named tuple, numpy array, bytes or str."""

_COUNTS = struct.Struct(">II")


class Scalar(NamedTuple):
    """A number: `code` is its struct code on the wire, `top` its largest value if narrower."""

    code: str
    top: int = 0


U8 = Scalar("I", 0xFF)
U16 = Scalar("I", 0xFFFF)
U32 = Scalar("I")
I32 = Scalar("i")
F32 = Scalar("f")
F64 = Scalar("d")


class Record(NamedTuple):
    """A group of scalars of fixed size; decodes to the named tuple `make`."""

    make: type[Any]
    scalars: tuple[Scalar, ...]
    names: tuple[str, ...]

    @property
    def codes(self) -> str:
        """The struct codes of all numbers."""
        return "".join(scalar.code for scalar in self.scalars)

    @property
    def homogeneous(self) -> bool:
        """True if all numbers have one type, so that an array of records is a matrix."""
        return len({scalar.code for scalar in self.scalars}) == 1


class Array(NamedTuple):
    """A dynamic array, decoded to numpy in native byte order.

    Of scalars: shape (n,). Of homogeneous records: (n, k). Of mixed records: (n,), structured.
    """

    element: Scalar | Record


class Octets(NamedTuple):
    """A dynamic array of bytes, at most `top` of them (0: no limit but the message's size)."""

    top: int = 0


class Text(NamedTuple):
    """A C string, `top` bytes at most; it travels with its NUL unless `nul` is False.

    A NUL at the end is taken off when it is read, either way. Bytes that are not UTF-8 are read as
    `\\xff`: whatever a client sends, the text can be printed.
    """

    top: int = 0
    nul: bool = True


Kind = Scalar | Record | Array | Octets | Text
Field = tuple[str, Kind]


class Pose2d(NamedTuple):
    """A pose or a twist in the plane: metres (m/s), radians (rad/s)."""

    x: float
    y: float
    yaw: float


class Pose3d(NamedTuple):
    """A pose in space: metres, radians."""

    x: float
    y: float
    z: float
    roll: float
    pitch: float
    yaw: float


class Box2d(NamedTuple):
    """A size in the plane, metres, in the order of the wire: width (y), length (x)."""

    width: float
    length: float


class Box3d(NamedTuple):
    """A size in space, metres, in the order of the wire: width (y), length (x), height (z)."""

    width: float
    length: float
    height: float


class Point2d(NamedTuple):
    """A point in the plane, metres."""

    x: float
    y: float


class Color(NamedTuple):
    """A colour, 0..255 each."""

    alpha: int
    red: int
    green: int
    blue: int


class WireAddr(NamedTuple):
    """A device address as it travels: IPv4 address and port, then interface and index."""

    host: int
    robot: int
    interf: int
    index: int  # type: ignore[assignment]  # Player's name for it, not tuple's method


def record(make: type[Any], *scalars: Scalar) -> Record:
    """The record of the named tuple `make`; one scalar stands for all of its fields."""
    names: tuple[str, ...] = make._fields
    kinds = scalars if len(scalars) == len(names) else scalars * len(names)
    return Record(make, kinds, names)


POSE2D = record(Pose2d, F64)
POSE3D = record(Pose3d, F64)
BOX2D = record(Box2d, F64)
BOX3D = record(Box3d, F64)
POINT2D = record(Point2d, F64)
COLOR = record(Color, U8)
ADDR = record(WireAddr, U32, U32, U16, U16)


def dtype_of(element: Scalar | Record) -> np.dtype[Any]:
    """The numpy type of one array element on the wire (big-endian)."""
    if isinstance(element, Scalar):
        return np.dtype(_NUMPY[element.code])
    if element.homogeneous:
        return np.dtype(_NUMPY[element.scalars[0].code])
    return np.dtype(
        [(n, _NUMPY[s.code]) for n, s in zip(element.names, element.scalars, strict=True)]
    )


_new = tuple.__new__  # a quarter of the time that a named tuple's own constructor takes

_NUMPY = {"I": ">u4", "i": ">i4", "f": ">f4", "d": ">f8"}


class _Fixed:
    """Consecutive fields of fixed size: one precompiled struct."""

    def __init__(self, fields: Sequence[Field]) -> None:
        self.fields = fields
        codes = ""
        self._groups: list[tuple[str, int, int, type[Any] | None]] = []
        self._narrow: list[tuple[int, int, str]] = []  # position, largest value, field
        position = 0
        for name, kind in fields:
            scalars = kind.scalars if isinstance(kind, Record) else (kind,)
            make = kind.make if isinstance(kind, Record) else None
            self._groups.append((name, position, position + len(scalars), make))
            for scalar in scalars:
                assert isinstance(scalar, Scalar)
                if scalar.top:
                    self._narrow.append((position, scalar.top, name))
                codes += scalar.code
                position += 1
        self.struct = struct.Struct(">" + codes)

    def pack(self, values: Mapping[str, Any]) -> bytes:
        flat: list[Any] = []
        for name, start, end, make in self._groups:
            if make is None:
                flat.append(values[name])
                continue
            group = tuple(values[name])
            if len(group) != end - start:
                raise XdrError(f"{name}: {end - start} numbers are needed ({len(group)} given)")
            flat.extend(group)
        for position, top, name in self._narrow:
            if not 0 <= flat[position] <= top:
                raise XdrError(f"{name}: {flat[position]!r} does not fit (0..{top})")
        try:
            return self.struct.pack(*flat)
        except (struct.error, OverflowError, TypeError) as error:
            names = ", ".join(name for name, _ in self.fields)
            raise XdrError(f"{names}: {error}") from None

    def values(self, payload: bytes) -> Values:
        """The values of a payload that is of this size, and these numbers alone."""
        flat = self.struct.unpack(payload)
        for position, top, _ in self._narrow:
            if flat[position] > top:
                flat = self._cut(flat)
                break
        return {
            name: flat[start] if make is None else _new(make, flat[start:stop])
            for name, start, stop, make in self._groups
        }

    def unpack(self, payload: bytes, offset: int, values: Values) -> int:
        end = offset + self.struct.size
        if end > len(payload):
            names = ", ".join(name for name, _ in self.fields)
            raise XdrError(
                f"{names}: cut short ({len(payload) - offset} of {self.struct.size} bytes)"
            )
        flat = self.struct.unpack_from(payload, offset)
        for position, top, _ in self._narrow:
            if flat[position] > top:
                flat = self._cut(flat)
                break
        for name, start, stop, make in self._groups:
            values[name] = flat[start] if make is None else _new(make, flat[start:stop])
        return end

    def _cut(self, flat: tuple[Any, ...]) -> tuple[Any, ...]:
        """The numbers as C reads 32-bit items into narrow ones."""
        numbers = list(flat)
        for position, top, _ in self._narrow:
            numbers[position] &= top
        return tuple(numbers)


class _Dynamic:
    """One array, byte string or text: two equal counts, then the elements."""

    def __init__(self, name: str, kind: Array | Octets | Text) -> None:
        self.name = name
        self.kind = kind
        if isinstance(kind, Array):
            self.wire = dtype_of(kind.element)
            self.native = self.wire.newbyteorder("=")
            matrix = isinstance(kind.element, Record) and kind.element.homogeneous
            self.columns = len(kind.element.scalars) if matrix else 0  # type: ignore[union-attr]
            self.size = self.wire.itemsize * (self.columns or 1)

    def pack(self, values: Mapping[str, Any]) -> bytes:
        value = values[self.name]
        if isinstance(self.kind, Array):
            return self._pack_array(value)
        if isinstance(self.kind, Text):
            raw = self._encode_text(value)
            if raw and self.kind.nul:
                raw += b"\0"
        else:
            try:
                raw = bytes(memoryview(value))
            except TypeError:
                raise XdrError(f"{self.name}: {value!r} is not bytes") from None
        if self.kind.top and len(raw) > self.kind.top:
            raise XdrError(f"{self.name}: {len(raw)} bytes (at most {self.kind.top})")
        return _COUNTS.pack(len(raw), len(raw)) + raw + bytes(-len(raw) % 4)

    def _encode_text(self, value: Any) -> bytes:
        if not isinstance(value, str):
            raise XdrError(f"{self.name}: {value!r} is not a string")
        try:
            return value.encode()
        except UnicodeEncodeError as error:
            raise XdrError(f"{self.name}: {error}") from None

    def _pack_array(self, value: Any) -> bytes:
        try:
            array = np.asarray(value, dtype=self.wire)
        except (ValueError, TypeError, OverflowError) as error:
            raise XdrError(f"{self.name}: {error}") from None
        if self.columns and array.size == 0:
            array = array.reshape(0, self.columns)
        expected = (len(array), self.columns) if self.columns else (len(array),)
        if array.shape != expected:
            raise XdrError(f"{self.name}: shape {array.shape} (expected {expected})")
        return _COUNTS.pack(len(array), len(array)) + array.tobytes()

    def unpack(self, payload: bytes, offset: int, values: Values) -> int:
        room = len(payload) - offset - 8
        if room < 0:
            raise XdrError(f"{self.name}: cut short (no room for its two counts)")
        count, again = _COUNTS.unpack_from(payload, offset)
        offset += 8
        if count != again:
            raise XdrError(f"{self.name}: its two counts differ ({count} and {again})")
        if isinstance(self.kind, Array):
            end: int = offset + count * self.size
            self._check(count, end, payload)
            array = np.frombuffer(payload, self.wire, count * (self.columns or 1), offset)
            array = array.astype(self.native)
            values[self.name] = array.reshape(count, self.columns) if self.columns else array
            return end
        end = offset + count + (-count % 4)
        self._check(count, end, payload)
        if self.kind.top and count > self.kind.top:
            raise XdrError(f"{self.name}: {count} bytes (at most {self.kind.top})")
        raw = payload[offset : offset + count]
        if isinstance(self.kind, Text):
            values[self.name] = raw.removesuffix(b"\0").decode("utf-8", "backslashreplace")
        else:
            values[self.name] = raw
        return int(end)

    def _check(self, count: int, end: int, payload: bytes) -> None:
        if end > len(payload):
            raise XdrError(
                f"{self.name}: {count} elements announced, the payload ends before them "
                f"({end} bytes needed, {len(payload)} there)"
            )


class Layout:
    """How a message's payload is laid out: fields in order, compiled once."""

    def __init__(self, fields: Sequence[Field]) -> None:
        self._parts: list[_Fixed | _Dynamic] = []
        fixed: list[Field] = []
        for name, kind in fields:
            if isinstance(kind, Scalar | Record):
                fixed.append((name, kind))
                continue
            if fixed:
                self._parts.append(_Fixed(fixed))
                fixed = []
            self._parts.append(_Dynamic(name, kind))
        if fixed:
            self._parts.append(_Fixed(fixed))
        self._names = frozenset(name for name, _ in fields)
        self.plain: Callable[[bytes], Values] | None = None
        """Of a message that is numbers and no array: values of a payload of the right size."""
        if len(self._parts) == 1 and isinstance(self._parts[0], _Fixed):
            self.plain = self._parts[0].values

    def pack(self, values: Mapping[str, Any]) -> bytes:
        """The payload of `values`, which must have exactly the layout's fields.

        Raises XdrError where a field is missing, unknown, or does not fit.
        """
        if values.keys() != self._names:
            missing = sorted(self._names - values.keys())
            unknown = sorted(values.keys() - self._names)
            raise XdrError(f"fields missing: {missing}, fields unknown: {unknown}")
        return b"".join(part.pack(values) for part in self._parts)

    def unpack(self, payload: bytes) -> Values:
        """The values of `payload`, to its last byte; raises XdrError where it does not fit."""
        values: Values = {}
        offset = 0
        for part in self._parts:
            offset = part.unpack(payload, offset, values)
        if offset != len(payload):
            raise XdrError(f"{len(payload) - offset} bytes too many at the end")
        return values
