"""`clock: free`: the world runs on by itself, as Player's did, whatever clients from outside do.

The wall clock is the tests' own: it stands until a test lets it go on.
"""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from sim.fleet.driver import Driver
from sim.fleet.sleeping import ASLEEP, Sleeping
from sim.result import RobotRecord
from tests.patience import PATIENCE
from tests.sim.serving import Serving, World, write_world
from troupe.simulation import Simulation
from troupe.testing.wire import ACK, CLOSE, LASER, POSITION2D, RawClient, pulling


class Clock:
    """A wall clock that a test moves, and that tells when the world has come as far."""

    def __init__(self) -> None:
        self.time = 0.0
        self.ticks = 0
        self.changed = threading.Condition()

    def now(self) -> float:
        return self.time + 1e-6 * (self.time > 0)  # no rounding error holds up what is due

    def ticked(self, simulation: Simulation) -> None:
        """To be called after each tick."""
        with self.changed:
            self.ticks = simulation.ticks
            self.changed.notify_all()

    def pass_by(self, seconds: float) -> None:
        """Let time pass, less than a second at a time: a run that is later than that forgets it.

        Returns when the world has made all ticks that are due: time t begins with tick t / 0.1 + 1.
        """
        while seconds > 1e-9:
            step = min(seconds, 0.8)
            seconds -= step
            self.time += step
            with self.changed:
                due = round(self.time / 0.1) + 1
                assert self.changed.wait_for(lambda due=due: self.ticks >= due, PATIENCE)


def free(path: Path, clock: Clock, **settings: object) -> Serving:
    return Serving(path, free=True, now=clock.now, each_tick=clock.ticked, **settings)  # type: ignore[arg-type]


def x_of(client: RawClient) -> float:
    return float(client.round()[POSITION2D, 0, 1].unpack("6dI")[0])


def test_a_program_that_sleeps_has_driven_on_meanwhile(world: World) -> None:
    clock = Clock()
    with free(world(), clock) as run, pulling(run.port("one")) as client:
        clock.pass_by(0.5)  # nobody has asked, and the world has gone on
        start = x_of(client)
        client.drive(0.2)
        client.request(POSITION2D, 0, 1)  # it has been taken
        clock.pass_by(4.0)
        assert x_of(client) - start == pytest.approx(0.8, abs=0.05)


def test_each_request_gets_the_newest_reading_and_no_more_than_that(world: World) -> None:
    clock = Clock()
    with (
        free(world(), clock) as run,
        pulling(run.port("one"), (POSITION2D, 0), (LASER, 0)) as client,
    ):
        for k in range(1, 4):
            clock.pass_by(1.0)
            client.ask()
            got = [client.receive() for _ in range(4)]  # ACK, two of data, SYNCH
            assert [one.time for one in got[1:3]] == pytest.approx([k + 0.1] * 2)


def test_a_client_that_asks_again_within_a_tick_waits_for_the_next_one(world: World) -> None:
    clock = Clock()
    with free(world(), clock) as run, pulling(run.port("one")) as client:
        clock.pass_by(0.2)
        assert client.round()[POSITION2D, 0, 1].time == pytest.approx(0.3)
        client.ask()
        clock.pass_by(0.1)
        assert client.answer()[POSITION2D, 0, 1].time == pytest.approx(0.4)


def test_the_world_waits_for_no_client_and_holds_the_pace_of_the_clock(world: World) -> None:
    clock = Clock()
    with free(world("hand"), clock, realtime=2.0) as run:
        run.line("one: a Player client at .* may come at any time")
        clock.time = 0.5
        with clock.changed:
            assert clock.changed.wait_for(lambda: clock.ticks >= 11, PATIENCE)
        assert run.simulation.ticks == 11
        assert not run.engine.behind(0.0)


def test_a_client_that_is_done_has_finished_in_a_free_world_too(world: World) -> None:
    clock = Clock()
    with free(world(), clock) as run:
        with pulling(run.port("one")) as client:
            clock.pass_by(0.2)
            client.round()
            client.access(POSITION2D, 0, CLOSE)
            assert client.request(POSITION2D, 0, 1).type == ACK
        clock.time += 0.1
        assert run.result().robot("one").state == "finished"


MIXED = """\
size: [12, 12]
duration: 100
models:
  rover: {body: {shape: circle, radius: 0.3}, sensors: [{type: laser, samples: 5}]}
robots:
  - {name: one, model: rover, pose: [3, 3, 0], controller: hand}
  - {name: two, model: rover, pose: [3, 8, 0], controller: mine}
controllers:
  hand: {external: true}
  mine: {program: ./mine.py}
player: {clock: free}
"""

MINE = """
from player import PlayerClient, Position2dProxy, SimulationProxy

had = []
with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while len(had) < 20 and robot.read():
        sum(k * k for k in range(20_000))
        had.append(round(robot.time, 6))
        base.set_speed(0.2)
    SimulationProxy(robot).report("had", had)
    robot.read()
"""


def test_a_program_of_the_world_file_misses_no_reading_in_a_free_world(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    clock = Clock()
    path = write_world(tmp_path, MIXED)
    with Serving(path, now=clock.now, each_tick=clock.ticked) as run:
        with pulling(run.port("one")) as client:
            client.round()
            clock.pass_by(2.5)
        result = run.stop()
    two = result.robot("two")
    assert (two.state, two.error) == ("finished", None)
    assert two.properties["had"] == [round(0.1 * (k + 1), 6) for k in range(20)]
    assert result.robot("one").state == "lost"


HERE = (1.0, 1.0, 0.0)

# -- a line for those who sleep in a world that waits -------------------------------------------


def test_a_client_that_sleeps_in_a_world_that_waits_is_told_what_helps_once() -> None:
    lines: list[str] = []
    driver = Driver(0, "external", RobotRecord("one", "rover", 0.0, HERE, HERE, "running"))
    now = 10.0
    sleeping = Sleeping(lines.append, lambda: now)
    driver.since = now - 100.0
    sleeping.asked(driver)  # its first request: it may have been started late
    driver.asked = True
    driver.since = now - 0.9 * ASLEEP
    sleeping.asked(driver)
    assert lines == []
    driver.since = now - 4.0
    sleeping.asked(driver)
    sleeping.asked(driver)
    assert len(lines) == 1
    assert lines[0].startswith("one: its client did not ask for data for 4.0 s")
    assert "--free" in lines[0]
    assert "`player: {clock: free}`" in lines[0]


def test_only_a_world_that_is_held_to_the_clock_looks_for_sleepers(world: World) -> None:
    for realtime, is_free, looks in ((1.0, False, True), (None, False, False), (1.0, True, False)):
        with Serving(world(), realtime=realtime, free=is_free) as run:
            sleeping = run.engine.drivers.clocks.sleeping
            assert (sleeping is not None) is looks
            if sleeping is not None:
                sleeping.now = lambda: float("inf")
                with pulling(run.port("one")) as client:
                    client.round()
                    client.round()
                run.line("one: its client did not ask for data for")
