"""`troupe print`: readings of every interface as text and as JSON, and clear errors."""

from __future__ import annotations

import json
import math
import struct
from typing import Any

import pytest
import typer
from typer.testing import CliRunner, Result

from player import DeviceAddr, Interface, MessageType, messages
from player.xdr import Array, Octets, Record
from tests.troupe.stub_server import rude_server, stub_server
from troupe.commands.print_ import print_

app = typer.Typer()
app.command()(print_)
LASER = DeviceAddr(Interface.LASER, 0)

SCAN = {
    "min_angle": -1.5, "max_angle": 1.5, "resolution": 1.5, "max_range": 8.0,
    "ranges": [1.0, 2.5, 8.0], "intensity": b"\0\1\2", "id": 7,
}  # fmt: skip


def run(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


def message(addr: DeviceAddr, subtype: int, **values: Any) -> tuple[int, bytes]:
    return subtype, messages.encode(addr.interf, MessageType.DATA, subtype, **values)


def test_count_messages_are_printed_and_no_more() -> None:
    with stub_server({LASER: [message(LASER, 1, **SCAN)]}) as stub:
        done = run(stub.name, "laser:0", "--count", "3")
    assert done.exit_code == 0, done.stderr
    assert len(done.stdout.splitlines()) == 3


def test_text_names_time_device_message_and_every_field() -> None:
    with stub_server({LASER: [message(LASER, 1, **SCAN)]}) as stub:
        line = run(stub.name, "laser:0", "--count", "1").stdout
    assert line == (
        "0.100 laser:0 scan: min_angle -1.5; max_angle 1.5; resolution 1.5; max_range 8; "
        "ranges (3) [1 2.5 8]; intensity (3) [0 1 2]; id 7\n"
    )


def test_json_holds_all_fields_at_full_precision() -> None:
    base = DeviceAddr(Interface.POSITION2D, 0)
    state = message(base, 1, pos=(1 / 3, -2.0, 0.5), vel=(0.1, 0.0, -0.2), stall=1)
    with stub_server({base: [state]}) as stub:
        lines = run(stub.name, "position2d", "--count", "2", "--json").stdout.splitlines()
    first, second = map(json.loads, lines)
    assert first == {
        "time": 0.1,
        "device": "position2d:0",
        "message": "state",
        "pos": {"x": 1 / 3, "y": -2.0, "yaw": 0.5},
        "vel": {"x": 0.1, "y": 0.0, "yaw": -0.2},
        "stall": 1,
    }
    assert second["time"] > first["time"]


def example(kind: Any) -> Any:
    """Some value of a field: two elements where there can be several."""
    if isinstance(kind, Array):
        return [example(kind.element)] * 2
    if isinstance(kind, Octets):
        return b"\1\0"
    return kind.make(*[1] * len(kind.scalars)) if isinstance(kind, Record) else 1


DATA_ROWS = [spec for spec in messages.specs() if spec.type == MessageType.DATA]


@pytest.mark.parametrize("spec", DATA_ROWS, ids=[f"{s!r}" for s in DATA_ROWS])
def test_every_kind_of_data_in_the_protocol_can_be_printed(spec: Any) -> None:
    addr = DeviceAddr(spec.interf, 1)
    payload = spec.encode({name: example(kind) for name, kind in spec.fields})
    with stub_server({addr: [(spec.subtype, payload)]}) as stub:
        text = run(stub.name, str(addr), "--count", "1").stdout
        entry = json.loads(run(stub.name, str(addr), "--count", "1", "--json").stdout)
    assert entry["message"] == spec.name
    assert set(entry) == {"time", "device", "message", *(name for name, _ in spec.fields)}
    assert all(name in text for name, _ in spec.fields)


def test_data_that_is_not_in_our_table_is_shown_as_it_came() -> None:
    camera = DeviceAddr(Interface.CAMERA, 0)
    with stub_server({camera: [(1, b"\x00\xff\x10")]}) as stub:
        entry = json.loads(run(stub.name, "camera:0", "--count", "1", "--json").stdout)
    assert entry["undecoded"] == "00ff10"


def test_a_message_that_does_not_fit_its_layout_ends_nothing() -> None:
    with stub_server({LASER: [(1, b"\1\2\3"), message(LASER, 1, **SCAN)]}) as stub:
        broken, whole = run(stub.name, "laser:0", "--count", "2", "--json").stdout.splitlines()
    assert json.loads(broken)["undecoded"] == "010203"
    assert json.loads(whole)["ranges"] == [1.0, 2.5, 8.0]


def test_numbers_that_json_does_not_know_are_null() -> None:
    ranger = DeviceAddr(Interface.RANGER, 0)
    payload = struct.pack(">2I3d", 3, 3, 1.0, math.nan, math.inf)
    with stub_server({ranger: [(1, payload)]}) as stub:
        entry = json.loads(run(stub.name, "ranger:0", "--count", "1", "--json").stdout)
    assert entry["ranges"] == [1.0, None, None]


def test_it_ends_well_when_the_server_goes_away() -> None:
    with stub_server({LASER: [message(LASER, 1, **SCAN)]}, rounds=2) as stub:
        done = run(stub.name, "laser:0")
    assert done.exit_code == 0
    assert 1 <= len(done.stdout.splitlines()) <= 2
    assert "closed the connection" in done.stderr


def test_a_device_that_is_not_there_is_answered_with_those_that_are() -> None:
    with stub_server({LASER: []}) as stub:
        done = run(stub.name, "laser:1")
    assert done.exit_code == 2
    assert "no device laser:1" in done.stderr
    assert "laser:0" in done.stderr


@pytest.mark.parametrize("device", ["speech:0", "simulation:0", "graphics2d", "log:0", "player:0"])
def test_an_interface_without_data_is_refused_before_anybody_waits(device: str) -> None:
    done = run("127.0.0.1:1", device)
    assert done.exit_code == 2
    assert "sends no data" in done.stderr


@pytest.mark.parametrize("device", ["lazer:0", "laser:x", "laser:70000", "laser:-1", ""])
def test_what_is_no_device_is_refused(device: str) -> None:
    done = run("127.0.0.1:1", device)
    assert done.exit_code == 2
    assert repr(device) in done.stderr


def test_another_kind_of_server_is_named() -> None:
    with rude_server(b"220 mail.example.org ESMTP\r\n") as server:
        done = run(server, "laser:0")
    assert done.exit_code == 2
    assert "no Player server" in done.stderr
