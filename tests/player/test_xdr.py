"""The encoding of single fields, byte by byte."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from player.errors import XdrError
from player.table import BLOB
from player.xdr import (
    BOX3D,
    COLOR,
    F32,
    F64,
    I32,
    POSE2D,
    POSE3D,
    U8,
    U32,
    Array,
    Layout,
    Octets,
    Pose2d,
    Text,
)


def test_a_small_integer_takes_four_bytes():
    assert Layout([("state", U8)]).pack({"state": 1}) == b"\0\0\0\1"


def test_a_dynamic_array_starts_with_its_count_twice():
    packed = Layout([("ranges", Array(F32))]).pack({"ranges": [1.0, 2.0]})
    assert packed.hex(" ", 4) == "00000002 00000002 3f800000 40000000"


def test_bytes_are_padded_to_four():
    packed = Layout([("bumpers", Octets())]).pack({"bumpers": b"\1\0\1"})
    assert packed.hex(" ", 4) == "00000003 00000003 01000100"


def test_a_string_travels_with_its_nul():
    packed = Layout([("name", Text())]).pack({"name": "r0"})
    assert packed.hex(" ", 4) == "00000003 00000003 72300000"


def test_an_empty_array_is_eight_zero_bytes():
    for kind in (Array(F64), Array(POSE3D), Octets()):
        assert Layout([("a", kind)]).pack({"a": b"" if kind == Octets() else []}) == bytes(8)


def test_an_empty_array_of_records_keeps_its_columns():
    assert Layout([("a", Array(POSE3D))]).unpack(bytes(8))["a"].shape == (0, 6)


def test_records_become_named_tuples():
    layout = Layout([("pose", POSE2D), ("stall", U8)])
    values = layout.unpack(layout.pack({"pose": (1, 2, 3), "stall": True}))
    assert values == {"pose": Pose2d(1.0, 2.0, 3.0), "stall": 1}
    assert values["pose"].yaw == 3.0


def test_arrays_become_numpy_in_native_order():
    layout = Layout([("n", Array(U32)), ("p", Array(BOX3D)), ("b", Array(BLOB))])
    blob = (1, 0xFF0000, 3, 4, 5, 6, 7, 8, 9, 1.5)
    values = layout.unpack(layout.pack({"n": [7], "p": [(1, 2, 3)], "b": [blob]}))
    assert values["n"].dtype == np.uint32
    assert values["p"].dtype == np.float64
    assert values["p"].shape == (1, 3)
    assert values["b"]["color"].tolist() == [0xFF0000]
    assert all(array.dtype.isnative for array in values.values())


def test_narrow_integers_read_as_c_reads_them():
    assert Layout([("state", U8)]).unpack(b"\0\0\1\2") == {"state": 2}


def test_a_text_that_is_not_utf8_can_still_be_printed():
    raw = bytes.fromhex("00000003 00000003 72ff0000")
    text = Layout([("name", Text())]).unpack(raw)["name"]
    assert text == "r\\xff"


@pytest.mark.parametrize(
    ("fields", "values", "complaint"),
    [
        ([("state", U8)], {"state": 256}, "state: 256 does not fit"),
        ([("state", U8)], {"state": -1}, "state: -1 does not fit"),
        ([("n", U32)], {"n": 2**32}, "n: "),
        ([("n", I32)], {"n": 1.5}, "n: "),
        ([("x", F32)], {"x": 1e300}, "x: "),
        ([("x", F32)], {"x": "far"}, "x: "),
        ([("pose", POSE2D)], {"pose": (1, 2)}, "pose: 3 numbers are needed"),
        ([("color", COLOR)], {"color": (0, 0, 0, 300)}, "color: 300 does not fit"),
        ([("r", Array(F32))], {"r": [[1.0]]}, "r: shape"),
        ([("r", Array(F32))], {"r": ["near"]}, "r: "),
        ([("r", Array(POSE3D))], {"r": [(1, 2)]}, "r: shape"),
        ([("key", Octets(4))], {"key": b"12345"}, "key: 5 bytes"),
        ([("key", Octets())], {"key": "text"}, "key: 'text' is not bytes"),
        ([("key", Octets())], {"key": 5}, "key: 5 is not bytes"),
        ([("name", Text(4))], {"name": "long"}, "name: 5 bytes"),
        ([("name", Text())], {"name": b"r0"}, "name: b'r0' is not a string"),
        ([("name", Text())], {"name": "\ud800"}, "name: "),
        ([("a", U8)], {}, "missing: \\['a'\\]"),
        ([("a", U8)], {"a": 1, "b": 2}, "unknown: \\['b'\\]"),
    ],
)
def test_what_does_not_fit_is_refused_by_name(fields, values, complaint):
    with pytest.raises(XdrError, match=complaint):
        Layout(fields).pack(values)


@pytest.mark.parametrize(
    ("kind", "payload", "complaint"),
    [
        (U8, "0000", "cut short"),
        (U8, "00000000 00000000", "4 bytes too many"),
        (Array(F32), "00000001", "no room for its two counts"),
        (Array(F32), "00000001 00000002 00000000 00000000", "counts differ"),
        (Array(F32), "00000002 00000002 00000000", "2 elements announced"),
        (Array(BLOB), "ffffffff ffffffff", "4294967295 elements announced"),
        (Octets(), "ffffffff ffffffff 00000000", "4294967295 elements announced"),
        (Octets(), "00000003 00000003 0102", "3 elements announced"),
        (Text(4), "00000008 00000008 61616161 61616161", "8 bytes \\(at most 4\\)"),
    ],
)
def test_a_payload_that_is_not_the_layout_is_refused(kind, payload, complaint):
    with pytest.raises(XdrError, match=complaint):
        Layout([("field", kind)]).unpack(bytes.fromhex(payload))


@given(st.binary(max_size=64))
def test_no_payload_breaks_the_decoder(payload):
    layout = Layout([("name", Text()), ("ranges", Array(F64)), ("state", U8)])
    try:
        values = layout.unpack(payload)
    except XdrError:
        return
    assert set(values) == {"name", "ranges", "state"}
