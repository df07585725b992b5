"""Several clients at one robot, and clients that come and go."""

from __future__ import annotations

import pytest

from tests.sim.serving import Serving, World
from troupe.testing.wire import (
    ACK,
    DATA,
    PLAYER,
    POSITION2D,
    REQ,
    SYNCH,
    RawClient,
    message,
    pulling,
    pushed,
)


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
        ticks = run.simulation.ticks
        second.round()
        assert run.simulation.ticks == ticks + 1
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
        run_lost = run.engine.robots[0].record
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
            assert run.engine.robots[0].record.state == "running"
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
        assert run.simulation.ticks == 0
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
