"""Rounds that are written together for all clients: byte by byte those that are made one by one."""

from __future__ import annotations

import contextlib
import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from player.connection import Connection
from sim.devices.switchboard import Switchboard
from tests.sim.served_world import WORLD
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    ACK,
    BLOBFINDER,
    BUMPER,
    CLOSE,
    LASER,
    POSITION2D,
    SONAR,
    SPEECH,
    SYNCH,
    Got,
    RawClient,
    pulling,
)

Heard = list[Got]


def whole_round(client: RawClient) -> Heard:
    """All that follows a request for data, without the port, which is another in each run."""
    heard = []
    while not heard or heard[-1].type != SYNCH:
        heard.append(replace(client.receive(), robot=0))
    return heard


def conversation(run: Serving) -> Iterator[Heard]:
    """Two clients, one of which goes on to ask for other things."""
    one = pulling(run.port("one"), (POSITION2D, 0), (LASER, 0), (BLOBFINDER, 0))
    two = pulling(run.port("two"), (POSITION2D, 0))

    def rounds(number: int) -> Iterator[Heard]:
        for _ in range(number):
            one.drive(0.5, 0.3)
            one.ask()
            two.ask()
            yield whole_round(one)
            yield whole_round(two)

    with one, two:
        yield from rounds(3)
        two.subscribe(LASER)
        yield from rounds(2)
        narrow = struct.pack(">5fIf", -0.5, 0.5, 0.0175, 5.0, 0.0, 0, 10.0)
        assert one.request(LASER, 0, 2, narrow).type == ACK
        yield from rounds(2)
        assert (
            one.request(BLOBFINDER, 0, 1, struct.pack(">7I", 0, 0, 9, 200, 255, 0, 9)).type == ACK
        )
        yield from rounds(2)
        assert one.access(LASER, 0, CLOSE).type == ACK
        assert one.access(BLOBFINDER, 0, CLOSE).type == ACK
        yield from rounds(2)
        one.subscribe(SONAR)
        yield from rounds(2)
        one.subscribe(BUMPER)
        yield from rounds(2)
        two.ask()  # whose answer comes when the other has asked as well
        one.ask()
        yield whole_round(one)
        yield whole_round(two)


def heard_in(path: Path) -> list[Heard]:
    with Serving(path) as run:
        return list(conversation(run))


@pytest.fixture
def ready(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Whether rounds that were written together could be used, one by one."""
    used: list[bool] = []
    take_round = Connection.take_round

    def watched(connection: Connection, piece: memoryview, messages: int) -> bool:
        used.append(take_round(connection, piece, messages))
        return used[-1]

    monkeypatch.setattr(Connection, "take_round", watched)
    return used


def test_rounds_written_together_are_those_written_one_by_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ready: list[bool]
) -> None:
    path = write_world(tmp_path, WORLD)
    together = heard_in(path)
    assert all(ready)
    assert len(ready) == len(together)
    ready.clear()
    monkeypatch.setattr(Switchboard, "ready_rounds", lambda *_: {})
    assert together == heard_in(path)
    assert not ready


def test_who_has_subscribed_what_tells_nothing_is_served_all_the_same(
    tmp_path: Path, ready: list[bool]
) -> None:
    with Serving(write_world(tmp_path, WORLD)) as run:
        one = pulling(run.port("one"), (POSITION2D, 0), (SPEECH, 0))
        two = pulling(run.port("two"))
        with one, two:
            for _ in range(3):
                one.ask()
                two.ask()
                assert [got.interf for got in whole_round(one)] == [1, POSITION2D, 1]
                whole_round(two)
    assert any(ready)


def test_what_cannot_be_encoded_costs_its_clients_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A scan of a sensor of one's own may be no scan: who reads it is told, and nobody else."""
    from sim.devices.encoding import ScanRows  # noqa: PLC0415

    encode = ScanRows.__call__

    def broken(self: ScanRows, group: object) -> object:
        if run.simulation.ticks >= 3:
            raise ValueError("no scan")
        return encode(self, group)  # type: ignore[arg-type]

    monkeypatch.setattr(ScanRows, "__call__", broken)
    with Serving(write_world(tmp_path, WORLD)) as run:
        one = pulling(run.port("one"), (POSITION2D, 0), (LASER, 0))
        two = pulling(run.port("two"))
        with one, two:
            for _ in range(6):
                with contextlib.suppress(OSError):  # it has lost its connection by then
                    one.ask()
                two.ask()
                whole_round(two)
        assert run.line("no scan")
