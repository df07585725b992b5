"""Who has paused the world is waited for like anybody else, and then no more."""

from __future__ import annotations

from pathlib import Path

import pytest

import troupe
from tests.patience import PATIENCE
from tests.sim.serving import Serving, write_world
from troupe.testing.wire import (
    ACK,
    DATA,
    LASER,
    PLAYER,
    POSITION2D,
    REQ,
    SIMULATION,
    SYNCH,
    Gone,
    RawClient,
    message,
    pulling,
)

WORLD = """\
size: [20, 20]
duration: 2
until: duration
models:
  full: {body: {shape: circle, radius: 0.3}, simulation: full, sensors: [{type: laser}]}
  rover: {body: {shape: circle, radius: 0.3}}
robots:
  - {name: one, model: full, pose: [10, 10, 0], controller: mine}
  - {name: two, model: rover, pose: [10, 15, 0], controller: mine}
controllers: {mine: {program: ./mine.py}}
"""

PAUSES = """
from player import PlayerClient, Position2dProxy, SimulationProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    while robot.time < 0.5 and robot.read():
        pass
    if robot.name == "one":
        SimulationProxy(robot).pause()
        robot.flush()
        {then}
    while robot.read():
        base.set_speed(0.2)
"""

READS = "pass"
HANGS = "import time; time.sleep(1000)"
ASKS = "while base.request_geometry(): pass"


@pytest.mark.parametrize("then", [READS, HANGS, ASKS])
def test_a_program_that_pauses_for_ever_is_hung_and_the_run_goes_on(
    tmp_path: Path, then: str
) -> None:
    (tmp_path / "mine.py").write_text(PAUSES.format(then=then))
    path = write_world(tmp_path, WORLD)
    for patience in (1.0, 4.0, 16.0, PATIENCE):  # on a busy machine the other one may be slow too
        lines: list[str] = []
        result = troupe.run(path, patience=patience, say=lines.append)
        one, two = result.robots
        if two.state == "running":
            break
    assert (one.state, two.state) == ("hung", "running")
    assert "kept the world paused for" in (one.error or "")
    assert result.sim_time == pytest.approx(2.0)
    assert two.distance > 0.1
    assert sum(line.startswith("one: hung: kept the world paused") for line in lines) == 1


EXTERNAL = WORLD.replace("{program: ./mine.py}", "{external: true}").replace(
    "until: duration", "until: controllers"
)


def pause(client: RawClient) -> None:
    """Stop the clock, or let it go on; the run has heard of it afterwards."""
    client.command(SIMULATION, 0, 1)
    assert client.request(POSITION2D, 0, 1).type == ACK


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return write_world(tmp_path, EXTERNAL)


def test_an_onlooker_that_pauses_for_ever_loses_its_connection(path: Path) -> None:
    with (
        Serving(path, patience=2.0) as run,
        pulling(run.port("one")) as one,
        pulling(run.port("two")) as two,
        RawClient(run.port("one")) as onlooker,
    ):
        pause(onlooker)
        one.ask()
        two.ask()
        run.line(r"^127.0.0.1:\d+: kept the world paused for \d+ s: its connection is closed")
        one.answer()
        two.answer()
        with pytest.raises(Gone):
            onlooker.request(POSITION2D, 0, 1)
        assert {robot.record.state for robot in run.engine.robots} == {"running"}


def test_the_others_are_not_blamed_for_a_pause(path: Path) -> None:
    """The patience with them begins anew when it is over, whoever has asked and who has not."""
    with (
        Serving(path, patience=2.0) as run,
        pulling(run.port("one")) as one,
        pulling(run.port("two")) as two,
        RawClient(run.port("one")) as onlooker,
    ):
        one.ask()
        pause(onlooker)
        run.line("kept the world paused")
        two.ask()
        one.answer()
        two.answer()
        assert {robot.record.state for robot in run.engine.robots} == {"running"}


def test_who_may_not_pause_is_not_taken_for_who_has(path: Path) -> None:
    with (
        Serving(path) as run,
        pulling(run.port("one")) as one,
        pulling(run.port("two")) as two,
        RawClient(run.port("one")) as onlooker,
    ):
        pause(onlooker)
        with RawClient(run.port("two")) as stranger:
            pause(stranger)  # two's clients may not
            assert run.engine.context.paused
        two.request(POSITION2D, 0, 1)
        assert run.engine.context.paused  # it has gone, and the pause was not its own
        one.ask()
        two.ask()
        ticks = run.simulation.ticks
        pause(onlooker)
        one.answer()
        two.answer()
        assert run.simulation.ticks == ticks + 1


def test_who_has_paused_reads_on_what_is_and_lets_the_world_go_on(path: Path) -> None:
    with (
        Serving(path) as run,
        pulling(run.port("one"), (POSITION2D, 0), (SIMULATION, 0)) as one,
        pulling(run.port("two")) as two,
    ):
        one.drive(0.3)
        one.ask()
        two.round()
        (before,) = one.answer().values()
        pause(one)
        two.ask()
        for _ in range(3):  # it reads on, as a program does that has not noticed
            assert one.round() == {(POSITION2D, 0, 1): before}
        one.subscribe(LASER)  # nobody had read that before
        got = one.round()
        assert got[POSITION2D, 0, 1] == before
        assert max(got[LASER, 0, 1].unpack("4f2I180f2II")[6:186]) > 5
        assert run.simulation.ticks == 1
        pause(one)
        assert run.simulation.ticks == 1  # it is waited for again
        one.data.clear()
        one.ask()
        two.answer()
        assert one.answer()[POSITION2D, 0, 1].time == pytest.approx(0.2)
        assert run.simulation.ticks == 2


def test_who_asks_and_then_pauses_is_answered_too(path: Path) -> None:
    with (
        Serving(path) as run,
        pulling(run.port("one"), (POSITION2D, 0), (SIMULATION, 0)) as one,
        pulling(run.port("two")),
    ):
        one.ask()
        assert one.receive().type == ACK
        one.command(SIMULATION, 0, 1)
        assert [one.receive().type for _ in range(2)] == [DATA, SYNCH]
        pause(one)
        one.send(message(PLAYER, 0, REQ, 4))
        assert one.receive().type == ACK
        assert run.simulation.ticks == 0  # the other one is waited for, as ever
