"""Whose requests the world waits for: external robots, all and any, push and pull."""

from __future__ import annotations

import time

import pytest

from sim.fleet import patience as patience_module
from sim.fleet.patience import Patience
from tests.sim.serving import Serving, World
from troupe.testing.wire import (
    ACK,
    DATA,
    LASER,
    NACK,
    PLAYER,
    POSITION2D,
    PULL,
    PUSH,
    SIMULATION,
    Gone,
    RawClient,
    pulling,
    pushed,
)

# -- external robots ----------------------------------------------------------------------------


def test_an_external_robot_waits_for_its_client_and_says_where(world: World) -> None:
    with Serving(world(), patience=30) as run:
        port = run.port("one")
        told = run.line("one: waiting for a Player client")
        assert f"at 127.0.0.1:{port} that reads position2d:0" in told.string
        assert "for 60 s at the most" in told.string
        assert run.simulation.ticks == 0
        with pulling(port) as client:
            client.round()
            assert run.simulation.ticks == 1


def test_an_external_robot_for_which_nobody_comes_does_not_hold_the_run_up_for_ever(
    world: World,
) -> None:
    with Serving(world(), patience=0.2) as run:
        result = run.result()
    assert result.robot("one").state == "hung"
    assert "no client" in (result.robot("one").error or "")
    assert result.outcome == "controller_failed"
    run.line(r"one: no client that asks for data has come within \d+ s")


def test_a_client_that_falls_silent_is_hung_and_its_robot_stops(world: World) -> None:
    with Serving(world()) as run, pulling(run.port("one")) as client:
        for _ in range(5):
            client.drive(0.4)
            client.round()
        run.engine.crew.patience = Patience(0.3)  # not before: this client may be slow as well
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
            assert run.simulation.ticks == k + 1
        assert run.stop().ticks == 20


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
        assert run.simulation.ticks == 20
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
        assert run.simulation.ticks == 0


def test_any_still_waits_until_every_robots_client_has_come(world: World) -> None:
    with Serving(world("hand", clock="any")) as run, pulling(run.port("one")) as one:
        one.ask()
        onlooker = RawClient(run.port("one"))
        assert onlooker.devices()  # the run has had time to answer, and has not moved on
        assert run.simulation.ticks == 0
        with pulling(run.port("two")):
            one.answer()
            assert run.simulation.ticks == 1
        onlooker.close()


# -- push mode and onlookers --------------------------------------------------------------------


def test_a_world_that_push_clients_drive_runs_in_real_time(world: World) -> None:
    with Serving(world()) as run, pushed(run.port("one")) as client:
        while client.receive().type != DATA:
            pass
        began, first = time.monotonic(), run.simulation.time
        while run.simulation.time < first + 1.0:
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
            assert run.simulation.ticks == 201
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
        ticks = run.simulation.ticks
        one.ask()
        assert two.request(POSITION2D, 0, 1).type == ACK
        assert run.simulation.ticks == ticks
        two.ask()
        one.answer()
        assert run.simulation.ticks == ticks + 1


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
