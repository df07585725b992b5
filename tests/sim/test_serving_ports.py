"""Which port serves which robot, and addresses that cannot be had."""

from __future__ import annotations

import contextlib
import os
import socket

import pytest

import player
from controllers import keyboard
from sim import ports
from tests.sim.serving import Serving, World
from troupe.testing.wire import (
    LASER,
    POSITION2D,
    pulling,
)


def test_one_port_serves_all_robots_by_index(world: World) -> None:
    with Serving(world("hand", layout="shared")) as run:
        run.line("two: waiting for a Player client at .* that reads position2d:1")
        with pulling(run.shared_port, (POSITION2D, 0)) as one:
            assert {(4, 0), (4, 1), (6, 0), (6, 1), (31, 0)} <= set(one.devices())
            assert (31, 1) not in one.devices()
            with pulling(run.shared_port, (POSITION2D, 1), (LASER, 1)) as two:
                one.drive(0.4)
                two.drive(-0.2, index=1)
                for _ in range(10):
                    one.ask()
                    got = two.round()
                    assert set(one.answer()) == {(POSITION2D, 0, 1)}
                assert set(got) == {(POSITION2D, 1, 1), (LASER, 1, 1)}
                assert run.pose(0)[0] > 3.2
                assert run.pose(1)[0] < 2.95
        result = run.result()
    assert result.robot("two").devices == ["position2d:1", "laser:1"]


def test_one_client_may_drive_all_robots_of_a_port_and_is_the_clock_of_all(world: World) -> None:
    with Serving(world("hand", layout="shared")) as run:
        with pulling(run.shared_port, (POSITION2D, 0), (POSITION2D, 1)) as client:
            for _ in range(10):
                client.drive(0.4, index=0)
                client.drive(0.2, index=1)
                assert set(client.round()) == {(POSITION2D, 0, 1), (POSITION2D, 1, 1)}
            assert run.simulation.ticks == 10
            assert run.pose(0)[0] > run.pose(1)[0] > 3.1
        result = run.result()
    assert [robot.state for robot in result.robots] == ["lost", "lost"]


def two_free_ports() -> int:
    """The lower of two ports that follow each other and are free now.

    Below 32768: the system hands out none of those to anybody who asks for just some port.
    """
    for base in range(20000 + os.getpid() % 5000, 32000):
        with contextlib.suppress(OSError):
            for port in (base, base + 1):
                socket.create_server(("127.0.0.1", port)).close()
            return base
    raise AssertionError("no free ports")


def test_ports_follow_each_other_from_the_base(world: World) -> None:
    base = two_free_ports()
    with Serving(world("hand"), listen=("127.0.0.1", base)) as run:
        assert (run.port("one"), run.port("two")) == (base, base + 1)


def test_a_port_that_is_taken_is_a_clear_error(world: World) -> None:
    with Serving(world()) as first:
        port = first.port("one")
        with pytest.raises(OSError, match=f"cannot listen on 127.0.0.1:{port}"):
            Serving(world(), listen=("127.0.0.1", port))
        with pulling(port) as client:  # the first run is none the worse for it
            client.round()


def test_ports_beyond_the_last_are_a_clear_error(world: World) -> None:
    with pytest.raises(OSError, match="65535 is the last one"):
        Serving(world("hand"), listen=("127.0.0.1", 65535))


def test_another_address_than_loopback_is_pointed_out(world: World) -> None:
    with Serving(world(), listen=("0.0.0.0", 0)) as run:
        run.line("listening on 0.0.0.0: anybody who reaches this address can drive the robots")


# -- ports that nobody has chosen -----------------------------------------------------------------


@pytest.fixture
def default_port(monkeypatch: pytest.MonkeyPatch) -> int:
    """Where clients look that are told no port; another than Player's, which others may have."""
    assert ports.DEFAULT_PORT == player.DEFAULT_PORT == 6665
    port = two_free_ports()
    monkeypatch.setattr(ports, "DEFAULT_PORT", port)
    monkeypatch.setattr(player.environment, "DEFAULT_PORT", port)
    return port


@pytest.mark.parametrize("layout", ["per_robot", "shared"])
def test_a_client_that_is_told_no_port_finds_the_robot_that_waits_for_one(
    world: World, default_port: int, layout: str
) -> None:
    with Serving(world(layout=layout), listen=None) as run:
        told = run.line("one: waiting for a Player client")
        assert f"at 127.0.0.1:{default_port} that reads position2d:0" in told.string
        run.line(f"  by hand: python -m controllers.keyboard 127.0.0.1:{default_port}")
        with player.PlayerClient(environ={}, timeout=None) as client:
            base = player.Position2dProxy(client)
            base.set_speed(0.3)
            assert client.read()
        assert run.simulation.ticks >= 1


def test_the_next_robots_wait_at_the_next_ports(world: World, default_port: int) -> None:
    with Serving(world("hand"), listen=None) as run:
        assert run.port("one") == default_port
        assert run.port("two") == default_port + 1


def test_where_the_default_port_is_taken_a_free_one_is_taken_and_told(
    world: World, default_port: int
) -> None:
    with socket.create_server(("127.0.0.1", default_port)), Serving(world(), listen=None) as run:
        run.line(f"cannot listen on 127.0.0.1:{default_port}: .*: a free port is taken instead")
        with pulling(run.port("one")) as client:
            client.round()


def test_the_keyboard_takes_the_default_unless_it_is_told_another() -> None:
    assert keyboard.place_of(None) == (None, None)
    assert keyboard.place_of("127.0.0.1") == ("127.0.0.1", player.DEFAULT_PORT)
