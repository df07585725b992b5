"""Whose requests the world waits for: external robots, layouts, several clients, push and pull."""

from __future__ import annotations

import contextlib
import os
import socket
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from sim.fleet import patience as patience_module
from tests.sim.raw_client import (
    ACK,
    DATA,
    LASER,
    NACK,
    PLAYER,
    POSITION2D,
    PULL,
    PUSH,
    REQ,
    SIMULATION,
    SYNCH,
    Gone,
    RawClient,
    message,
    pulling,
    pushed,
)
from tests.sim.serving import Serving, write_world

WORLD = """\
size: [20, 20]
until: {until}
models:
  rover:
    body: {{shape: box, size: [1, 1]}}
    sensors: [{{type: laser, samples: 5}}]
robots:
  - {{name: one, model: rover, pose: [3, 4, 0], controller: hand}}
  - {{name: two, model: rover, pose: [3, 8, 0], controller: {second}}}
controllers:
  hand: {{external: true}}
  wander: {{program: wander}}
player: {{layout: {layout}, clock: {clock}}}
"""

World = Callable[..., Path]


@pytest.fixture
def world(tmp_path: Path) -> World:
    """Two robots; the second stands unless told otherwise."""

    def make(
        second: str = "null",
        layout: str = "per_robot",
        clock: str = "all",
        until: str = "controllers",
    ) -> Path:
        text = WORLD.format(second=second, layout=layout, clock=clock, until=until)
        return write_world(tmp_path, text)

    return make


# -- external robots ----------------------------------------------------------------------------


def test_an_external_robot_waits_for_its_client_and_says_where(world: World) -> None:
    with Serving(world(), patience=30) as run:
        port = run.port("one")
        told = run.line("one: waiting for a Player client")
        assert f"at 127.0.0.1:{port} that subscribes position2d:0" in told.string
        assert "for 60 s at the most" in told.string
        assert run.engine.ticks == 0
        with pulling(port) as client:
            client.round()
            assert run.engine.ticks == 1


def test_an_external_robot_for_which_nobody_comes_does_not_hold_the_run_up_for_ever(
    world: World,
) -> None:
    with Serving(world(), patience=0.2) as run:
        result = run.result()
    assert result.robot("one").state == "hung"
    assert "no client" in (result.robot("one").error or "")
    assert result.outcome == "controller_failed"
    run.line(r"one: no client that drives it has come within \d+ s")


def test_a_client_that_only_looks_does_not_start_the_clock(world: World) -> None:
    with Serving(world()) as run, pulling(run.port("one"), (LASER, 0)) as onlooker:
        onlooker.ask()
        with pulling(run.port("one")) as client:
            assert run.engine.ticks == 0
            client.round()
        assert set(onlooker.answer()) == {(LASER, 0, 1)}


def test_a_client_that_falls_silent_is_hung_and_its_robot_stops(world: World) -> None:
    with Serving(world(), patience=0.3) as run, pulling(run.port("one")) as client:
        for _ in range(5):
            client.drive(0.4)
            client.round()
        result = run.result()
        with pytest.raises(Gone):
            client.round()
    assert result.robot("one").state == "hung"
    run.line("one: hung: nothing for")


def test_what_a_client_reads_is_one_round_per_tick_and_its_commands_count_at_once(
    world: World,
) -> None:
    with Serving(world()) as run, pulling(run.port("one")) as client:
        for k in range(20):
            got = client.round()[POSITION2D, 0, 1]
            assert got.time == pytest.approx(0.1 * (k + 1))
            assert run.engine.ticks == k + 1
        assert run.stop().ticks == 20


# -- layouts ------------------------------------------------------------------------------------


def test_one_port_serves_all_robots_by_index(world: World) -> None:
    with Serving(world("hand", layout="shared")) as run:
        run.line("two: waiting for a Player client at .* that subscribes position2d:1")
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
            assert run.engine.ticks == 10
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
        with (
            Serving(world(), listen=("127.0.0.1", port)) as second,
            pytest.raises(OSError, match=f"cannot listen on 127.0.0.1:{port}"),
        ):
            second.result()
        with pulling(port) as client:  # the first run is none the worse for it
            client.round()


def test_ports_beyond_the_last_are_a_clear_error(world: World) -> None:
    with (
        Serving(world("hand"), listen=("127.0.0.1", 65535)) as run,
        pytest.raises(OSError, match="65535 is the last one"),
    ):
        run.result()


def test_another_address_than_loopback_is_pointed_out(world: World) -> None:
    with Serving(world(), listen=("0.0.0.0", 0)) as run:
        run.line("listening on 0.0.0.0: anybody who reaches this address can drive the robots")


# -- all and any --------------------------------------------------------------------------------


def read_in_turn(one: RawClient, two: RawClient, rounds: int) -> None:
    """What a program with two connections does."""
    for _ in range(rounds):
        one.drive(0.4)
        one.round()
        two.drive(0.4)
        two.round()


def test_a_program_that_reads_two_robots_in_turn_runs_with_any(world: World) -> None:
    with (
        Serving(world("hand", clock="any")) as run,
        pulling(run.port("one")) as one,
        pulling(run.port("two")) as two,
    ):
        read_in_turn(one, two, 20)
        # the first connection asks and has no data waiting; the second finds some
        assert run.engine.ticks == 20
        assert run.pose(0)[0] == pytest.approx(run.pose(1)[0], abs=0.05)


def test_with_all_such_a_program_is_blocked_and_is_told_what_would_help(
    world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(patience_module, "HINT_AFTER", 0.2)
    with (
        Serving(world("hand")) as run,
        pulling(run.port("one")) as one,
        pulling(run.port("two")),
    ):
        one.ask()
        told = run.line("two: its client has not asked")
        assert "`player: {clock: any}`" in told.string
        assert run.engine.ticks == 0


def test_any_still_waits_until_every_robots_client_has_come(world: World) -> None:
    with Serving(world("hand", clock="any")) as run, pulling(run.port("one")) as one:
        one.ask()
        onlooker = RawClient(run.port("one"))
        assert onlooker.devices()  # the run has had time to answer, and has not moved on
        assert run.engine.ticks == 0
        with pulling(run.port("two")):
            one.answer()
            assert run.engine.ticks == 1
        onlooker.close()


# -- push mode and onlookers --------------------------------------------------------------------


def test_a_world_that_push_clients_drive_runs_in_real_time(world: World) -> None:
    with Serving(world()) as run, pushed(run.port("one")) as client:
        while client.receive().type != DATA:
            pass
        began, first = time.monotonic(), run.engine.time
        while run.engine.time < first + 1.0:
            client.drive(0.4)
            client.receive()
        # real time is a lower bound on any machine; how much later depends on its load
        assert time.monotonic() - began > 0.9
        assert run.pose()[0] > 3.1


def test_push_clients_and_onlookers_hold_nobody_up(world: World) -> None:
    with Serving(world()) as run:
        with pulling(run.port("one")) as client:
            client.round()
            silent = [
                pushed(run.port("one"), (POSITION2D, 0), (LASER, 0)),
                pushed(run.port("two"), (POSITION2D, 0), (LASER, 0)),
                pulling(run.port("one"), (POSITION2D, 0), (LASER, 0)),  # the second: no clock
                pulling(run.port("two"), (POSITION2D, 0), (LASER, 0)),  # of a robot that stands
            ]
            for _ in range(200):
                client.drive(0.1)
                client.round()
            assert run.engine.ticks == 201
            got = silent[3].round()  # it has its data whenever it cares to ask
            assert set(got) == {(POSITION2D, 0, 1), (LASER, 0, 1)}
        for one in silent:
            one.close()


def test_a_client_that_turns_to_push_is_waited_for_no_more_and_back_again_is(
    world: World,
) -> None:
    with (
        Serving(world("hand")) as run,
        pulling(run.port("one")) as one,
        pulling(run.port("two")) as two,
    ):
        one.ask()
        two.round()
        one.answer()
        two.mode(PUSH)
        for _ in range(5):
            one.round()
        two.mode(PULL)
        assert two.data  # it was sent, without asking
        ticks = run.engine.ticks
        one.ask()
        assert two.request(POSITION2D, 0, 1).type == ACK
        assert run.engine.ticks == ticks
        two.ask()
        one.answer()
        assert run.engine.ticks == ticks + 1


def test_data_goes_only_to_those_who_have_subscribed_it(world: World) -> None:
    with Serving(world()) as run, pulling(run.port("one")) as client:
        with pushed(run.port("one"), (LASER, 0)) as other:
            client.round()
            got = other.receive()
            assert (got.interf, got.type) == (LASER, DATA)
        client.subscribe(LASER)
        client.data.clear()
        assert set(client.round()) == {(POSITION2D, 0, 1), (LASER, 0, 1)}
        client.access(LASER, 0, 2)
        client.data.clear()
        assert set(client.round()) == {(POSITION2D, 0, 1)}


def test_a_client_that_asks_with_nothing_subscribed_gets_its_ack_and_no_synch(
    world: World,
) -> None:
    with Serving(world()) as run, RawClient(run.port("one")) as idle:
        idle.mode(PULL)
        idle.ask()
        got = idle.receive()
        assert (got.interf, got.subtype, got.type) == (PLAYER, 4, ACK)
        with pulling(run.port("one")) as client:
            client.round()
            client.round()
            assert idle.request(SIMULATION, 0, 1).type == NACK
        assert idle.data == []


# -- several clients at one robot ---------------------------------------------------------------


def test_the_last_command_wins_whoever_gives_it(world: World) -> None:
    with Serving(world()) as run, pulling(run.port("one")) as client:
        with RawClient(run.port("one")) as other:
            for _ in range(15):
                client.drive(0.4)
                client.request(POSITION2D, 0, 1)  # it has been taken
                other.drive(-0.2)
                other.request(POSITION2D, 0, 1)
                got = client.round()
            assert got[POSITION2D, 0, 1].unpack("6dI")[3] == pytest.approx(-0.2)
        for _ in range(15):
            got = client.round()
        # who gave the last command is gone: the robot stands until somebody gives another
        assert got[POSITION2D, 0, 1].unpack("6dI")[3] == pytest.approx(0.0, abs=1e-9)
        for _ in range(15):
            client.drive(0.4)
            got = client.round()
        assert got[POSITION2D, 0, 1].unpack("6dI")[3] == pytest.approx(0.4)


def test_an_onlooker_that_goes_away_stops_nobody(world: World) -> None:
    with Serving(world()) as run, pulling(run.port("one")) as client:
        client.drive(0.4)
        for _ in range(15):
            client.round()
        with pulling(run.port("one")) as onlooker:
            onlooker.request(POSITION2D, 0, 1)
        got = [client.round() for _ in range(15)][-1]
        assert got[POSITION2D, 0, 1].unpack("6dI")[3] == pytest.approx(0.4)


def test_when_the_clock_goes_the_next_pull_client_is_the_clock(world: World) -> None:
    with Serving(world()) as run:
        first = pulling(run.port("one"))
        first.round()
        second = pulling(run.port("one"))
        first.close()
        second.data.clear()
        second.round()
        ticks = run.engine.ticks
        second.round()
        assert run.engine.ticks == ticks + 1
        second.close()
        assert run.result().robot("one").state == "lost"


def test_a_client_that_goes_away_is_lost_its_robot_stops_and_it_may_come_back(
    world: World,
) -> None:
    with Serving(world("hand")) as run, pulling(run.port("two")) as two:
        client = pulling(run.port("one"))
        for _ in range(10):
            client.drive(0.4)
            client.ask()
            two.round()
            client.answer()
        client.close()
        two.round()
        run_lost = run.engine.crew.drivers[0].record
        assert run_lost.state == "lost"
        before = run.pose(0)
        for _ in range(30):
            two.round()
        assert run.pose(0)[0] - before[0] < 0.1  # the way that it takes to brake
        with pulling(run.port("one")) as again:
            run.line("one: a client has come")
            for _ in range(30):
                again.drive(0.4)
                again.ask()
                two.round()
                again.answer()
            assert run.engine.crew.drivers[0].record.state == "running"
            assert run.pose(0)[0] > before[0] + 0.8
        two.round()  # the world waits for both: it has seen the other go
        result = run.stop()
    assert result.robot("one").state == "lost"
    assert "closed the connection" in (result.robot("one").error or "")


def test_a_robot_without_a_controller_stands_but_may_be_looked_at(world: World) -> None:
    with (
        Serving(world()) as run,
        pulling(run.port("one")) as client,
        pushed(run.port("two")) as other,
    ):
        for _ in range(5):
            client.round()
        assert other.receive().unpack("6dI")[:2] == (0, 0)


def test_an_unsubscribed_drive_is_let_go(world: World) -> None:
    with (
        Serving(world("hand")) as run,
        pulling(run.port("one")) as one,
        pulling(run.port("two")) as two,
    ):
        for _ in range(10):
            one.drive(0.4)
            one.ask()
            two.round()
            one.answer()
        one.access(POSITION2D, 0, 2)  # from now on nobody drives it, nor waits for it
        before = run.pose(0)[0]
        for _ in range(30):
            two.round()
        assert run.pose(0)[0] - before < 0.1


def test_requests_are_answered_while_the_world_waits_for_others(world: World) -> None:
    with (
        Serving(world("hand")) as run,
        pulling(run.port("one")) as one,
        pulling(run.port("two")) as two,
    ):
        one.ask()
        for _ in range(50):
            assert two.request(POSITION2D, 0, 1).type == ACK
        assert run.engine.ticks == 0
        two.round()
        one.answer()


def test_a_run_that_waits_for_nobody_still_answers(world: World) -> None:
    world_text = world(until="duration").read_text().replace("controller: hand", "controller: null")
    path = world()
    path.write_text(world_text)
    with Serving(path) as run, pulling(run.port("one")) as client:
        for _ in range(3):
            assert set(client.round()) == {(POSITION2D, 0, 1)}
        assert client.request(POSITION2D, 0, 1).type == ACK


def test_replies_and_data_of_one_client_keep_their_order(world: World) -> None:
    """Data that waited before a request goes out before its reply (and after REQ DATA's ACK)."""
    with (
        Serving(world("hand")) as run,
        pulling(run.port("one")) as one,
        pulling(run.port("two")) as two,
    ):
        one.ask()
        two.round()
        one.answer()
        # now `one` is behind, and nothing waits for it; push a tick through by asking twice
        one.send(message(PLAYER, 0, REQ, 4), message(POSITION2D, 0, REQ, 1))
        two.round()
        kinds = []
        while True:
            got = one.receive()
            kinds.append((got.interf, got.type))
            if got.type == SYNCH:
                break
        assert kinds == [(PLAYER, 4), (POSITION2D, 4), (POSITION2D, DATA), (PLAYER, SYNCH)]
