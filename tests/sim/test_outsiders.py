"""Which client from outside is a robot's clock, and what its robot is when it has gone."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.result import RobotRecord
from tests.sim.serving import Serving, World, write_world
from troupe.testing.wire import (
    ACK,
    CLOSE,
    LASER,
    POSITION2D,
    SIMULATION,
    SPEECH,
    RawClient,
    pulling,
    pushed,
)

SCAN = {(LASER, 0, 1)}
STATE = {(POSITION2D, 0, 1)}


def heard(client: RawClient) -> None:
    """All that the client has sent before has been taken."""
    assert client.request(POSITION2D, 0, 1).type == ACK


def robot(run: Serving, name: str = "one") -> RobotRecord:
    return run.engine.context.by_name[name].record


# -- who is the clock ---------------------------------------------------------------------------


def test_a_client_that_only_reads_has_its_data_at_once_and_is_the_clock(world: World) -> None:
    with Serving(world()) as run, pulling(run.port("one"), (LASER, 0)) as client:
        for k in range(5):
            assert set(client.round()) == SCAN
            assert run.simulation.ticks == k + 1
        heard(client)
        assert run.simulation.ticks == 5  # the world waits for it
        assert robot(run).devices == ["laser:0"]


def test_a_client_that_is_pushed_what_it_reads_need_not_ask(world: World) -> None:
    with Serving(world()) as run, pushed(run.port("one"), (LASER, 0)) as client:
        assert client.receive().interf == LASER
        assert run.engine.crew.pushed_only


def test_a_client_that_has_asked_first_is_the_clock_and_a_second_that_reads_looks_on(
    world: World,
) -> None:
    with (
        Serving(world()) as run,
        pulling(run.port("one"), (LASER, 0)) as first,
        pulling(run.port("one"), (LASER, 0)) as second,
    ):
        second.ask()
        second.answer()
        first.data.clear()
        for _ in range(5):  # what it asks for is there already: it holds nobody up
            second.round()
        assert run.simulation.ticks == 6
        assert set(first.round()) == SCAN
        assert run.simulation.ticks == 6


def test_who_drives_comes_before_who_only_reads_from_its_first_request_on(world: World) -> None:
    with (
        Serving(world()) as run,
        pulling(run.port("one"), (LASER, 0)) as reader,
        pulling(run.port("one"), (LASER, 0)) as looker,
    ):
        reader.round()
        with pulling(run.port("one")) as driver:
            looker.round()
            reader.round()  # the driver has not asked yet: it holds nobody up
            ticks = run.simulation.ticks
            driver.round()
            for _ in range(3):
                driver.drive(0.3)
                driver.round()
            assert run.simulation.ticks >= ticks + 3
            ticks = run.simulation.ticks
            reader.round()
            reader.ask()  # it looks on now, and waits for the driver
            heard(driver)
            assert run.simulation.ticks == ticks
            driver.round()
            reader.answer()
        result = run.result()
    assert result.robot("one").state == "lost"  # though somebody looks on


def test_who_has_subscribed_the_drive_first_is_waited_for_and_others_look_on(world: World) -> None:
    with (
        Serving(world()) as run,
        pulling(run.port("one")) as driver,
        pulling(run.port("one"), (LASER, 0)) as looker,
    ):
        looker.ask()
        heard(driver)
        assert run.simulation.ticks == 0
        driver.round()
        looker.answer()


def test_who_has_subscribed_nothing_that_sends_data_is_no_clock(world: World) -> None:
    with (
        Serving(world()) as run,
        pulling(run.port("one"), (SIMULATION, 0), (SPEECH, 0)) as mute,
    ):
        mute.ask()
        assert mute.receive().type == ACK
        heard(mute)
        assert run.simulation.ticks == 0


def test_a_client_of_all_robots_is_the_clock_of_those_it_reads(world: World) -> None:
    path = world("hand", layout="shared")
    with (
        Serving(path) as run,
        pulling(run.shared_port, (POSITION2D, 0), (LASER, 1)) as client,
    ):
        for k in range(3):
            assert set(client.round()) == {(POSITION2D, 0, 1), (LASER, 1, 1)}
            assert run.simulation.ticks == k + 1


POST = """\
size: [9, 9]
models: {post: {body: {shape: circle, radius: 0.3}, drive: null, sensors: [{type: laser}]}}
robots: [{model: post, name: one, pose: [4, 4, 0], controller: hand}]
controllers: {hand: {external: true}}
"""


def test_a_robot_without_a_drive_has_a_clock_too(tmp_path: Path) -> None:
    with Serving(write_world(tmp_path, POST)) as run:
        with pulling(run.port("one"), (LASER, 0)) as client:
            client.round()
            client.round()
            ticks = run.simulation.ticks
            assert client.request(LASER, 0, 1).type == ACK
            assert run.simulation.ticks == ticks == 2
            client.access(LASER, 0, CLOSE)
        assert run.result().robot("one").state == "finished"


# -- what a robot is when its client has gone ---------------------------------------------------


def test_a_client_that_unsubscribes_all_devices_has_finished(world: World) -> None:
    with Serving(world()) as run:
        with pulling(run.port("one"), (POSITION2D, 0), (LASER, 0)) as client:
            client.round()
            client.access(POSITION2D, 0, CLOSE)
            heard(client)
            assert robot(run).state == "running"  # it reads on
            assert set(client.round()) == SCAN
            client.access(LASER, 0, CLOSE)
        result = run.result()
    assert (result.robot("one").state, result.robot("one").error) == ("finished", None)
    assert (result.outcome, result.exit_code) == ("completed", 0)


def test_a_client_that_breaks_off_is_lost(world: World) -> None:
    with Serving(world()) as run:
        with pulling(run.port("one"), (LASER, 0)) as client:
            client.round()
        result = run.result()
    assert result.robot("one").state == "lost"
    assert "closed the connection" in (result.robot("one").error or "")
    assert result.exit_code == 1


@pytest.mark.parametrize("device", [POSITION2D, LASER])
def test_who_has_finished_may_come_back(world: World, device: int) -> None:
    with Serving(world("hand")) as run, pulling(run.port("two")) as other:
        with pulling(run.port("one"), (device, 0)) as client:
            client.ask()
            other.round()
            client.answer()
            client.access(device, 0, CLOSE)
            other.round()
        assert robot(run).state == "finished"
        with pulling(run.port("one"), (device, 0)) as again:
            again.ask()
            other.round()
            again.answer()
            assert robot(run).state == "running"
            ticks = run.simulation.ticks
            other.ask()
            heard(again)
            assert run.simulation.ticks == ticks  # it is waited for
            again.round()
            other.answer()


def test_who_looked_on_at_a_lost_robot_does_not_bring_it_back(world: World) -> None:
    with (
        Serving(world("hand")) as run,
        pulling(run.port("two")) as other,
        pulling(run.port("one"), (LASER, 0)) as looker,
    ):
        with pulling(run.port("one")) as client:
            client.ask()
            other.round()
            client.answer()
        other.round()
        assert robot(run).state == "lost"
        looker.round()
        looker.ask()
        other.round()
        looker.answer()
        assert robot(run).state == "lost"


# -- clients that go before they had a reading --------------------------------------------------


@pytest.mark.parametrize("orderly", [True, False])
def test_a_client_that_goes_without_a_reading_is_lost_and_that_is_told(
    world: World, orderly: bool
) -> None:
    with Serving(world("hand")) as run:
        with pulling(run.port("two")), pulling(run.port("one")) as client:
            client.ask()  # the world waits for the other robot's client
            assert client.receive().type == ACK
            if orderly:
                client.access(POSITION2D, 0, CLOSE)
                heard(client)
            client.close()
            with pulling(run.port("one"), (LASER, 0)) as looker:
                assert looker.request(LASER, 0, 1).type == ACK
        result = run.result()
    one = result.robot("one")
    assert one.state == "lost"
    assert "went away before its robot's first tick" in (one.error or "")
    assert result.exit_code == 1


def test_a_client_that_goes_before_it_asks_is_told_and_the_robot_waits_on(world: World) -> None:
    with Serving(world()) as run:
        with pulling(run.port("one"), (LASER, 0)) as client:
            heard(client)
        run.line(r"one: 127.0.0.1:\d+ went away before its robot's first tick")
        assert "before its robot's first tick" in (robot(run).error or "")
        with pulling(run.port("one")) as again:
            again.round()
            assert robot(run).error is None
            again.access(POSITION2D, 0, CLOSE)
        assert run.result().exit_code == 0


def test_what_nobody_has_come_for_is_told_along_with_who_went(world: World) -> None:
    with Serving(world(), patience=0.5) as run:
        pulling(run.port("one"), (LASER, 0)).close()
        run.line("one: .* went away before its robot's first tick")
        error = run.result().robot("one").error or ""
    assert error.startswith("no client that asks for data has come within")
    assert "went away before its robot's first tick" in error
