"""An error that a client leads to costs it its connection, is told with its traceback, no more."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import troupe
from player.codes import Interface, MessageType
from player.messages import MessageSpec, specs
from player.xdr import Array, Octets, Record, Scalar, Text
from sim.build import load
from sim.devices import position2d
from sim.devices.laser import Laser
from sim.devices.position2d import Position2d
from sim.filming import Film, open_recorder
from tests.sim.served_world import WORLD
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    ACK,
    LASER,
    NACK,
    PLAYER,
    POSITION2D,
    REQ,
    SIMULATION,
    Gone,
    RawClient,
    message,
    octets,
    pulling,
    text,
)


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Serving]:
    with Serving(write_world(tmp_path, WORLD)) as serving:
        yield serving


def set_property(client: RawClient, key: str, value: bytes, name: str = "one") -> int:
    payload = text(name) + text(key) + bytes(4) + octets(value)
    return client.request(SIMULATION, 0, 6, payload).type


# -- colours ------------------------------------------------------------------------------------

NO_COLORS = [
    b'"#-00001"',
    b'"#+00001"',
    b'"# 00001"',
    b'"#1_2_3_"',
    '"#١٢٣٤٥٦"'.encode(),
    b'"#12345"',
    b'"#1234567"',
    b'"red"',
    b"4711",
    b"",
    struct.pack("<4f", np.nan, 0, 0, 1),
]


@pytest.mark.parametrize("value", NO_COLORS)
def test_what_is_no_colour_is_refused_and_the_run_goes_on(run: Serving, value: bytes) -> None:
    with pulling(run.port("one")) as client, pulling(run.port("two")) as other:
        assert set_property(client, "color", value) == NACK
        assert set_property(client, "color", b'"#a0B1c2"') == ACK
        other.ask()
        client.round()
        other.answer()
        assert run.engine.robots[0].color == 0xA0B1C2


# -- errors of ours -----------------------------------------------------------------------------


def fail(*_: Any) -> None:
    raise RuntimeError("the floor gave way")


def where_it_fails(monkeypatch: pytest.MonkeyPatch, where: str) -> None:
    """A mistake in one of the devices."""
    if where == "in the command":
        monkeypatch.setattr(Position2d, "command", fail)
    elif where == "in the request":
        monkeypatch.setattr(Position2d, "request", fail)
    elif where == "in the reply":
        monkeypatch.setattr(Position2d, "request", lambda *_: {"no": "such field"})
    elif where == "when it is carried out":
        monkeypatch.setattr(position2d, "heading", fail)
    else:
        monkeypatch.setattr(Laser, "encode", fail)


WHERE = [
    "in the command",
    "in the request",
    "in the reply",
    "when it is carried out",
    "in the data that it has configured",
]


@pytest.mark.parametrize("where", WHERE)
def test_an_error_costs_its_client_the_connection_and_nobody_else_anything(
    run: Serving, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    with pulling(run.port("one")) as client, pulling(run.port("two")) as other:
        port = client.socket.getsockname()[1]
        with monkeypatch.context() as patch:
            where_it_fails(patch, where)
            other.ask()
            with pytest.raises(Gone):  # noqa: PT012 - in which of them depends on where
                client.command(POSITION2D, 0, 4, struct.pack(">2d", 0.3, 0.1))
                client.request(LASER, 0, 2, struct.pack(">4ffIf", -0.5, 0.5, 0.1, 2, 0, 0, 0))
                client.subscribe(LASER)
                client.request(POSITION2D, 0, 1)
                client.round()
                client.round()
        told = run.line(f"^127.0.0.1:{port}: what it sent has led to an error").string
        assert "Traceback (most recent call last)" in told
        assert "the floor gave way" in told or "no such field" in told or "XdrError" in told
        assert sum("Traceback" in line for line in run.lines) == 1
        other.answer()
        for _ in range(3):
            other.round()
        with pulling(run.port("one")) as again:  # and it may come back
            other.ask()
            again.round()
            other.answer()
    result = run.stop()
    assert json.loads(json.dumps(result.as_json(), allow_nan=False))


def test_a_program_that_lost_its_connection_so_is_lost_in_the_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(position2d, "heading", fail)
    (tmp_path / "mine.py").write_text("""
from player import PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.read():
        if robot.name == "two" and robot.time > 0.5:
            base.set_velocity_heading(0.3, 0.1)
""")
    world = WORLD.replace("{external: true}", "{program: ./mine.py}")
    lines: list[str] = []
    path = write_world(tmp_path, world)
    result = troupe.run(path, duration=3.0, say=lines.append)
    assert result.outcome == "controller_failed"
    assert (result.robot("one").state, result.robot("two").state) == ("running", "lost")
    assert "the floor gave way" in (result.robot("two").error or "")
    assert result.sim_time == pytest.approx(3.0)
    assert sum("Traceback" in line for line in lines) == 1


# -- whatever devices are told, with the whole run behind them ----------------------------------

numbers = st.one_of(
    st.floats(width=64),
    st.sampled_from([0.0, -0.0, 1.0, 1e6, 1e7, 1e300, -1.7e308, 5e-324]),
    st.floats(-5, 5),
)
counts = st.one_of(st.integers(0, 3), st.sampled_from([255, 1 << 16, (1 << 31) - 1, 0xFFFFFFFF]))
json_values = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8)),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(st.text(max_size=4), inner, max_size=4)
    ),
    max_leaves=8,
)
values = st.one_of(
    json_values.map(lambda value: json.dumps(value).encode()),
    st.text("-+_ 0123456789abcdef", min_size=6, max_size=6).map(lambda t: f'"#{t}"'.encode()),
    st.sampled_from(NO_COLORS),
    st.sampled_from(
        [
            b"1e999",
            b"-1e999",
            b"NaN",
            b'"\\ud800"',
            b"[" * 2000,
            b"[" * 200 + b"]" * 200,
            b"9" * 400,
        ]
    ),
    st.binary(min_size=16, max_size=16),
    st.binary(max_size=30),
)
texts = st.one_of(
    st.sampled_from(["one", "two", "color", "time", "k", "scan_pose", ""]),
    st.text(max_size=30),
    st.sampled_from(["x" * 2000, "\x1b[2J", "\ud7ff￿", "\U0001f916" * 50, "a\0b"]),
)


def scalar(kind: Scalar) -> st.SearchStrategy[Any]:
    if kind.code in "fd":
        width = 32 if kind.code == "f" else 64
        return st.one_of(
            st.floats(width=width), numbers if width == 64 else st.floats(-5, 5, width=32)
        )
    if kind.code == "i":
        return st.integers(-(1 << 31), (1 << 31) - 1)
    return st.integers(0, kind.top) if kind.top else counts


def field(kind: Any) -> st.SearchStrategy[Any]:
    """Anything that can be said in a field."""
    if isinstance(kind, Scalar):
        return scalar(kind)
    if isinstance(kind, Record):
        return st.tuples(*map(scalar, kind.scalars))
    if isinstance(kind, Array):
        return st.lists(field(kind.element), max_size=5)
    if isinstance(kind, Octets):
        return values
    assert isinstance(kind, Text)
    most = kind.top - 1 if kind.top else None
    return texts.map(lambda said: said.encode()[:most].decode(errors="ignore"))


TOLD = [
    spec
    for spec in specs()
    if spec.type in (MessageType.CMD, MessageType.REQ)
    and spec.interf != Interface.PLAYER
    and not (spec.interf == Interface.SIMULATION and spec.name == "pause")
]
"""All that a device can be told or asked, but for the pause: the world is to go on."""
INTERFACES = sorted({spec.interf for spec in TOLD if spec.interf})


@st.composite
def told(draw: st.DrawFn) -> bytes:
    """A well-formed message to a device, which says anything whatever."""
    spec: MessageSpec = draw(st.sampled_from(TOLD))
    said = {name: draw(field(kind)) for name, kind in spec.fields}
    interf = spec.interf or draw(st.sampled_from(INTERFACES))
    return message(
        interf, draw(st.sampled_from([0, 0, 0, 1])), spec.type, spec.subtype, spec.encode(said)
    )


@st.composite
def properties(draw: st.DrawFn) -> bytes:
    """A property that there is, or that may be, set to anything whatever."""
    name, key = draw(st.sampled_from(["one", "two"])), draw(st.sampled_from(["color", "k", "time"]))
    payload = text(name) + text(key) + bytes(4) + octets(draw(values))
    return message(SIMULATION, 0, REQ, 6, payload)


class Filmed:
    """A run with a video, and the client that drives it while others say anything."""

    def __init__(self, folder: Path) -> None:
        path = write_world(folder, WORLD)
        self.film = Film(open_recorder(folder / "run.mp4", load(path), speed=1.0))
        self.run = Serving(path, each_tick=self.draw)
        self.client = pulling(self.run.port("one"), (POSITION2D, 0), (LASER, 0))
        self.other = pulling(self.run.port("two"))

    def draw(self, simulation: troupe.Simulation) -> None:
        self.film.each_tick(simulation._engine)

    def round(self) -> None:
        self.other.ask()
        self.client.round()
        self.other.answer()


@pytest.fixture(scope="module")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Filmed]:
    filmed = Filmed(tmp_path_factory.mktemp("filmed"))
    yield filmed
    result = filmed.run.stop()
    filmed.film.finish(filmed.run.engine)

    def no_constant(name: str) -> Any:
        raise AssertionError(name)

    text = json.dumps(result.as_json(), allow_nan=False, ensure_ascii=False)
    assert json.loads(text.encode().decode(), parse_constant=no_constant)["robots"]


def all_taken(client: RawClient) -> None:
    """Wait until the run has taken all that a client has sent, whatever it has answered to it."""
    client.send(message(PLAYER, 0, REQ, 1, seq=4711))
    while (got := client.receive()).seq != 4711 or got.interf != PLAYER:
        pass


@settings(
    max_examples=200,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(
    data=st.lists(st.one_of(told(), told(), properties()), max_size=10),
    robot=st.sampled_from(["one", "two"]),
)
def test_whatever_devices_are_told_no_error_comes_of_it(
    filmed: Filmed, data: list[bytes], robot: str
) -> None:
    run = filmed.run
    with RawClient(run.port(robot)) as client:
        for interf in (6, 7, 10, 62):
            client.access(interf, 0, 1)
        client.send(b"".join(data))
        all_taken(client)
        filmed.round()
    filmed.round()
    assert not [line for line in run.lines if "Traceback" in line]
    assert run.running
    x, y, yaw = run.pose()
    assert 0 <= x <= 10
    assert 0 <= y <= 10
    assert -np.pi <= yaw <= np.pi
