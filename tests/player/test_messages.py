"""The message table: every row, there and back, and against known bytes."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from message_values import messages_of, plain

from player import messages
from player.codes import DeviceAddr, Interface, MessageType
from player.errors import XdrError
from player.header import HEADER_SIZE, MessageReader, pack_message

SPECS = list(messages.specs())
DATA, CMD, REQ, ACK, SYNCH, NACK = MessageType


@pytest.mark.parametrize("spec", SPECS, ids=repr)
@settings(max_examples=12)
@given(data=st.data())
def test_every_message_survives_the_round_trip(spec, data):
    values = data.draw(messages_of(spec))
    payload = spec.encode(values)
    decoded = spec.decode(payload)
    assert {name: plain(value) for name, value in decoded.items()} == values
    assert spec.encode(decoded) == payload
    assert len(payload) % 4 == 0


@pytest.mark.parametrize("spec", SPECS, ids=repr)
@settings(max_examples=5)
@given(data=st.data())
def test_no_message_is_read_from_a_part_of_itself(spec, data):
    payload = spec.encode(data.draw(messages_of(spec)))
    for cut in range(0, len(payload), 4):
        with pytest.raises(XdrError):
            spec.decode(payload[:cut])
    with pytest.raises(XdrError):
        spec.decode(payload + b"\0\0\0\0")


def test_every_request_has_a_row_for_its_reply():
    for spec in SPECS:
        if spec.type == REQ:
            interf = spec.interf or Interface.LASER
            reply = messages.find(interf, ACK, spec.subtype)
            assert reply is not None
            assert reply.name == spec.name


def test_a_refusal_of_anything_is_known_and_empty():
    spec = messages.find(Interface.CAMERA, NACK, 77)
    assert spec is not None
    assert spec.decode(b"") == {}


def test_unknown_messages_are_not_found():
    assert messages.find(Interface.LASER, REQ, 99) is None
    assert messages.find(Interface.PLAYER, REQ, 255) is None  # the universal ones are devices'
    with pytest.raises(XdrError, match="no message laser type 1 subtype 77"):
        messages.encode(Interface.LASER, DATA, 77)


# Sizes of Player's protocol, from its generated XDR code.
@pytest.mark.parametrize(
    ("interface", "type_", "subtype", "values", "size"),
    [
        ("POSITION2D", DATA, 1, {"pos": (0,) * 3, "vel": (0,) * 3, "stall": 0}, 52),
        ("POSITION2D", CMD, 1, {"vel": (0,) * 3, "state": 1}, 28),
        ("POSITION2D", CMD, 2, {"pos": (0,) * 3, "vel": (0,) * 3, "state": 1}, 52),
        ("POSITION2D", ACK, 1, {"pose": (0,) * 6, "size": (0,) * 3}, 72),
        ("FIDUCIAL", DATA, 1, {"fiducials": [(1, *[0.0] * 12)]}, 108),
        ("BUMPER", DATA, 1, {"bumpers": b"\0\0"}, 12),
        ("BUMPER", ACK, 1, {"bumpers": [(0,) * 8]}, 64),
        ("BLOBFINDER", DATA, 1, {"width": 160, "height": 120, "blobs": [(0,) * 10] * 7}, 296),
        ("DIO", CMD, 1, {"count": 1, "bits": 1}, 8),
        ("SIMULATION", REQ, 1, {"name": "r0", "pose": (0, 0, 0)}, 36),
        ("RANGER", DATA, 1, {"ranges": [0.0] * 180}, 1448),
        (
            "RANGER",
            ACK,
            1,
            {
                "pose": (0,) * 6,
                "size": (0,) * 3,
                "element_poses": [(0,) * 6],
                "element_sizes": [(0,) * 3],
            },
            160,
        ),
        (
            "LASER",
            DATA,
            1,
            {
                "min_angle": -1,
                "max_angle": 1,
                "resolution": 0.1,
                "max_range": 8,
                "ranges": [1.0] * 180,
                "intensity": bytes(180),
                "id": 0,
            },
            936,
        ),
    ],
)
def test_sizes_are_players(interface, type_, subtype, values, size):
    assert len(messages.encode(Interface[interface], type_, subtype, **values)) == size


@given(st.lists(st.tuples(st.integers(1, 6), st.binary(max_size=20)), max_size=6), st.data())
def test_messages_are_found_however_the_bytes_are_cut(parts, data):
    whole = b"".join(pack_message(6, 1, type_, 3, payload, seq=9) for type_, payload in parts)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(whole)), max_size=8)))
    reader = MessageReader()
    found = []
    for start, end in zip([0, *cuts], [*cuts, len(whole)], strict=True):
        reader.feed(whole[start:end])
        while (message := reader.take()) is not None:
            found.append(message)
            assert message.encode() in whole
    assert [(m.type, m.payload) for m in found] == parts
    assert reader.buffered == 0


def test_a_message_is_not_given_before_its_last_byte():
    whole = pack_message(6, 0, 1, 1, b"12345678")
    reader = MessageReader()
    for size in range(len(whole)):
        reader.feed(whole[size : size + 1])
        message = reader.take()
        assert (message is None) == (size + 1 < len(whole))
    assert HEADER_SIZE == 40


def test_addresses_are_read_as_they_are_written():
    for interface in Interface:
        addr = DeviceAddr(interface, 3)
        assert DeviceAddr.parse(str(addr)) == addr
    assert DeviceAddr.parse("laser") == (6, 0)
    for wrong in ("lasr:0", "laser:", "laser:x", "laser:65536", "laser:-1", ""):
        with pytest.raises(ValueError, match=r"interface|index"):
            DeviceAddr.parse(wrong)
