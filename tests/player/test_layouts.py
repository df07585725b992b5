"""The layouts made from the table, against the codec made from it, byte by byte."""

import re
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from message_values import messages_of

from player import layouts, messages
from player.codes import Interface, MessageType
from player.errors import XdrError
from player.header import HEADER, Message
from player.xdr import Array, Octets, Record, Text

SPECS = list(messages.specs())
ROOT = Path(__file__).resolve().parents[2]
SPELLED = re.compile(r"""Struct\(\s*f?["']>|dtype\(\s*\[|["']>[iufd][1248]["']""")
"""A big-endian struct or numpy type, written out."""


def on_the_wire(kind, value):
    """What is in an array: the elements of a numpy row, of any kind."""
    if isinstance(kind, Text):
        return np.frombuffer(value.encode() + b"\0" * (kind.nul and value != ""), np.uint8)
    if isinstance(kind, Octets):
        return np.frombuffer(value, np.uint8)
    return value


def filled(form, values):
    """A payload, written into a row of the message's numpy type."""
    arrays = {
        name: on_the_wire(kind, values[name])
        for name, kind in form.fields
        if isinstance(kind, Array | Octets | Text)
    }
    rows = form.rows(1, **{name: len(elements) for name, elements in arrays.items()})
    for name, _ in form.fields:
        if name not in arrays or len(arrays[name]):
            rows[name][0] = arrays.get(name, values[name])
    return rows


def packed(form, values):
    """The same payload, made of structs."""
    kinds = dict(form.fields)
    found = b""
    names = iter(form.fields)
    for stretch in form.stretches:
        numbers = []
        for name, kind in names:
            if name == stretch.array:
                break
            numbers += values[name] if isinstance(kind, Record) else [values[name]]
        if stretch.array:
            elements = on_the_wire(kinds[stretch.array], values[stretch.array])
            numbers += [len(elements)] * 2
        found += stretch.numbers.pack(*numbers)
        if stretch.array:
            for element in elements:
                numbers = element if isinstance(element, tuple) else [element]
                found += stretch.records.pack(*numbers)
            found += bytes(-len(found) % 4)
    return found


@pytest.mark.parametrize("spec", SPECS, ids=repr)
@settings(max_examples=8)
@given(data=st.data())
def test_a_layout_gives_the_bytes_that_the_codec_gives(spec, data):
    values = data.draw(messages_of(spec))
    form = layouts.Form(spec.fields)
    payload = spec.encode(values)
    assert filled(form, values).tobytes() == payload
    assert packed(form, values) == payload


def test_many_payloads_lie_one_after_the_other():
    form = layouts.data(Interface.LASER)
    rows = form.rows(3, ranges=2, intensity=5)
    rows["ranges"] = [[1, 2], [3, 4], [5, 6]]
    rows["max_range"] = 8
    whole = rows.tobytes()
    for row, ranges in enumerate([[1, 2], [3, 4], [5, 6]]):
        payload = whole[row * rows.itemsize : (row + 1) * rows.itemsize]
        values = messages.decode(Interface.LASER, MessageType.DATA, 1, payload)
        assert values["ranges"].tolist() == ranges
        assert (values["max_range"], values["intensity"]) == (8, bytes(5))


def test_a_command_can_be_made_with_its_header_at_once():
    form = layouts.command(Interface.POSITION2D)
    head = (0, 0, 4, 1, 2, 1, 0.0, 0, form.head.size)
    whole = form.framed.pack(*head, 1.0, 2.0, 3.0, 1)
    payload = messages.encode(4, 2, 1, vel=(1.0, 2.0, 3.0), state=1)
    assert whole == Message(*head[:8], payload).encode()
    assert form.framed.size == HEADER.size + struct.calcsize(">3dI")


def test_a_layout_is_made_once_and_only_of_messages_that_there_are():
    assert layouts.data(Interface.LASER) is layouts.data(6, 1)
    form = layouts.data(Interface.RANGER)
    assert form.row_type(ranges=7) is form.row_type(ranges=7)
    with pytest.raises(XdrError, match="no message laser"):
        layouts.data(Interface.LASER, 77)


@pytest.mark.parametrize("folder", ["player/proxies", "sim/devices"])
def test_devices_and_proxies_spell_no_layout_themselves(folder):
    files = sorted((ROOT / folder).glob("*.py"))
    assert files
    assert [file.name for file in files if SPELLED.search(file.read_text())] == []
