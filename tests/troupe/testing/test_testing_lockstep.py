"""A world that is served in a thread: as in a run, and to be looked at meanwhile."""

from __future__ import annotations

import math

import pytest

import troupe
from player import PlayerClient, Position2dProxy
from tests.patience import PATIENCE
from troupe.testing import Lockstep, RawClient
from troupe.testing.wire import PULL

WORLD = {
    "size": [10, 10],
    "models": {"rover": {"body": {"shape": "circle", "radius": 0.3}, "drive": {"max_speed": 1}}},
    "robots": [{"name": "rover", "model": "rover", "pose": [2, 5, 0], "controller": "hand"}],
    "controllers": {"hand": {"external": True}},
}


def straight(client: PlayerClient, rounds: int) -> None:
    """A controller under test: it drives straight on."""
    base = Position2dProxy(client)
    for _ in range(rounds):
        base.set_speed(0.5, 0.0)
        assert client.read()


def test_the_run_waits_for_its_client_and_may_be_looked_at_meanwhile() -> None:
    with (
        Lockstep(WORLD) as run,
        PlayerClient("127.0.0.1", run.port("rover"), timeout=PATIENCE) as client,
    ):
        straight(client, 20)
        x, y, yaw = run.pose("rover")
        assert 2.5 < x < 3.0
        assert (y, yaw) == pytest.approx((5.0, 0.0))
        assert run.simulation.ticks in (19, 20)
        assert len(run.evidence.times) in (19, 20)
        assert run.stop().outcome == "interrupted"
    assert math.isclose(run.evidence.poses[0, 0, 1], 5.0)


def test_a_served_run_has_the_digest_of_one_that_is_driven_from_python() -> None:
    with Lockstep(WORLD, duration=2.0) as run:
        with PlayerClient(environ=run.environment("rover"), timeout=PATIENCE) as client:
            base = Position2dProxy(client)
            while client.read():
                base.set_speed(0.5, 0.3)
        served = run.result()

    def drive(robot):
        robot.base.set_speed(0.5, 0.3)

    driven = troupe.run(WORLD, seed=1, duration=2.0, controllers={"hand": drive})
    assert served.digest == driven.digest
    assert served.ticks == 20


def test_a_run_that_nobody_drives_is_stopped_while_it_waits() -> None:
    with Lockstep(WORLD) as run:
        assert run.simulation.ticks == 0
        result = run.stop()
    assert (result.outcome, result.ticks) == ("interrupted", 0)


def test_steps_of_a_simulation_that_was_stopped_do_nothing() -> None:
    with troupe.Simulation(WORLD, controllers=False) as simulation:
        simulation.step()
        simulation.stop()
        simulation.step()
        assert (simulation.ticks, simulation.outcome) == (1, "interrupted")


def test_a_line_that_does_not_come_before_the_end_is_an_error() -> None:
    with Lockstep(WORLD) as run:
        run.stop()
        with pytest.raises(AssertionError, match="no line has matched 'never'"):
            run.line("never")


def test_what_a_hook_raises_is_the_runs_end() -> None:
    def fault(simulation: troupe.Simulation) -> None:
        raise ValueError("seen")

    with Lockstep(WORLD, each_tick=fault) as run:
        client = RawClient(run.port("rover"))
        client.mode(PULL)
        client.subscribe(4)
        client.ask()
        with pytest.raises(ValueError, match="seen"):
            run.result()
        client.close()
