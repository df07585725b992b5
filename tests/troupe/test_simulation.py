"""The open run: by steps, by reset, by functions and by `troupe.run`, one and the same."""

from __future__ import annotations

import gc
import math
import os
import pickle
import textwrap
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

import troupe
from player import Robot

WORLD: dict[str, Any] = {
    "size": [10, 8],
    "duration": 3,
    "until": "duration",
    "models": {
        "rover": {
            "body": {"shape": "circle", "radius": 0.3},
            "sensors": [{"type": "laser", "samples": 36, "noise": 0.01}, {"type": "blobfinder"}],
            "actuators": [{"type": "sprayer"}],
        }
    },
    "robots": [
        {"name": "one", "model": "rover", "pose": [2, 4, 0], "controller": "mine"},
        {"name": "two", "model": "rover", "pose": [6, 4, 90], "controller": "mine"},
    ],
    "controllers": {"mine": {"program": "wander"}},
}
PROGRAM = """
import player

def drive(robot):
    ahead = robot.laser.ranges[12:24].min()
    near = sum(blob.range < 2.0 for blob in robot.blobfinder.blobs)
    jitter = 0.1 * robot.rng().standard_normal()
    robot.base.set_speed(0.4, (0.0 if ahead > 1.5 and not near else 0.8) + jitter)

if __name__ == "__main__":
    player.run(drive)
"""


def function() -> Any:
    """The function `drive` of the program."""
    names: dict[str, Any] = {"__name__": "mine"}
    exec(textwrap.dedent(PROGRAM), names)
    return names["drive"]


@pytest.fixture
def program(tmp_path: Path) -> dict[str, Any]:
    """The world with the program's file as its controller."""
    (tmp_path / "mine.py").write_text(PROGRAM)
    return {**WORLD, "controllers": {"mine": {"program": str(tmp_path / "mine.py")}}}


def test_steps_have_the_digest_of_a_whole_run(program: dict[str, Any]) -> None:
    whole = troupe.run(program)
    with troupe.Simulation(program) as sim:
        while not sim.over:
            sim.step()
        result = sim.result()
    assert (result.digest, result.outcome, result.ticks) == (whole.digest, "completed", 30)
    assert whole.robot("one").distance > 0.5


def test_a_function_drives_as_the_same_function_in_a_process(program: dict[str, Any]) -> None:
    apart = troupe.run(program)
    here = troupe.run(program, controllers={"mine": function()})
    assert here.digest == apart.digest
    with troupe.Simulation(program, controllers={"mine": function()}) as sim:
        sim.step(30)
        assert sim.result().digest == apart.digest


def test_a_reset_is_a_fresh_run() -> None:
    with troupe.Simulation(WORLD, controllers=False) as sim:

        def run() -> str:
            while not sim.over:
                scan = sim.readings("laser")
                ahead = scan.ranges[:, 12:24].min(axis=1)
                sim.command(scan.robots, forward=0.4, turn=0.1 * ahead)
                sim.step()
            return sim.result().digest

        first = run()
        sim.reset()
        assert (sim.ticks, sim.over) == (0, False)
        assert run() == first
        sim.reset(seed=7)
        other = run()  # the lasers' noise is another
        sim.reset(seed=1)
        assert run() == first != other


def test_what_is_asked_are_copies_with_the_documented_shapes() -> None:
    with troupe.Simulation(WORLD, controllers=False) as sim:
        sim.command(["one"], forward=0.3)
        sim.step(5)
        assert sim.names == ["one", "two"]
        assert (sim.time, sim.ticks) == (pytest.approx(0.5), 5)
        for array, shape in (
            (sim.poses, (2, 3)), (sim.velocities, (2, 3)), (sim.odometry, (2, 3)),
            (sim.stalls, (2,)), (sim.contacts, (2,)),
        ):  # fmt: skip
            assert array.shape == shape
        poses = sim.poses
        poses[:] = 0.0
        assert sim.poses[0, 0] > 2.0
        scan = sim.readings("laser:0")
        assert (scan.ranges.shape, scan.bearings.shape, scan.robots.tolist()) == (
            (2, 36), (36,), [0, 1],
        )  # fmt: skip
        before = sim.readings("laser").ranges
        before[:] = 0.0
        assert sim.readings("laser").ranges.min() > 0.0
        assert sim.readings("blobfinder").counts.shape == (2,)
        assert sim.picture((200, 160)).shape == (160, 200, 3)
        assert sim._repr_png_()[:4] == b"\x89PNG"
        assert sim.view().poses.shape == (2, 3)


def test_readings_stay_what_they_were_whenever_one_looks_at_them() -> None:
    def drive(sim: troupe.Simulation) -> None:
        sim.command(forward=0.3, turn=0.2)
        sim.step()

    with (
        troupe.Simulation(WORLD, controllers=False) as sim,
        troupe.Simulation(WORLD, controllers=False) as other,
    ):
        kept, looked_at = [], []
        for _ in range(4):
            kept.append(sim.readings("laser"))
            looked_at.append(other.readings("laser").data)
            drive(sim)
            drive(other)
        kept.append(sim.readings("laser"))
        looked_at.append(other.readings("laser").data)
        sim.set_pose("one", (4.0, 2.0, 1.0))
        sim.reset()
    for one, then in zip(kept, looked_at, strict=True):
        again = pickle.loads(pickle.dumps(one))
        assert np.array_equal(one.ranges, then.ranges)
        assert np.array_equal(one.hits, then.hits)
        assert one.ranges is one.data.ranges
        assert np.array_equal(again.ranges, then.ranges)
    assert not np.array_equal(kept[0].ranges, kept[3].ranges)


def test_readings_that_are_asked_late_are_those_that_were_read_all_along() -> None:
    with (
        troupe.Simulation(WORLD, controllers=False) as early,
        troupe.Simulation(WORLD, controllers=False) as late,
    ):
        for _ in range(4):
            early.readings("laser")
            early.step()
            late.step()
        assert np.array_equal(early.readings("laser").ranges, late.readings("laser").ranges)


def test_robots_are_put_sprayed_with_and_speak() -> None:
    with troupe.Simulation(WORLD, controllers=False) as sim:
        sim.set_pose("one", (4.0, 2.0, math.pi / 2))
        assert sim.poses[0] == pytest.approx([4, 2, math.pi / 2])
        facing = sim.readings("laser").ranges[0, 18]
        assert facing == pytest.approx(6.0, abs=0.1)
        sim.spray("one")
        sim.say(1, "hello")
        sim.step()
        result = sim.result()
    assert result.floor.painted_area > 0.0
    assert result.robot("two").said == [(0.0, "hello")]


def test_processes_and_python_drive_at_once(program: dict[str, Any]) -> None:
    robots = [program["robots"][0], {**program["robots"][1], "controller": None}]
    with troupe.Simulation({**program, "robots": robots}) as sim:
        sim.command("two", turn=1.0)
        sim.step(10)
        assert sim.velocities[1, 2] == pytest.approx(1.0, abs=0.01)
        assert sim.result().robot("one").distance > 0.1
        with pytest.raises(ValueError, match="one is driven by its controller"):
            sim.command("one", forward=0.1)


@pytest.mark.parametrize(
    ("act", "says"),
    [
        (lambda sim: sim.command([0, 9]), "no robot 9: they are 0 to 1"),
        (lambda sim: sim.command("three"), "no robot 'three'; there are one, two"),
        (lambda sim: sim.command(forward=[1, 2, 3]), r"forward has the shape \(3,\)"),
        (lambda sim: sim.command(turn=math.nan), "finite"),
        (lambda sim: sim.readings("sonar"), "no robot has a sensor 'sonar'; there are: laser:0"),
        (lambda sim: sim.readings("laser:1"), "'laser:1'; there are"),
        (lambda sim: sim.set_pose("one", (0, 0, 0)), "no room"),
        (lambda sim: sim.set_pose("one", (1, 2)), "three finite numbers"),
        (lambda sim: sim.spray("one", sprayer=3), "no sprayer 3"),
        (lambda sim: sim.step(0), "at least 1"),
        (lambda sim: sim.reset(seed=-1), "seed"),
    ],
)
def test_what_cannot_be_is_an_error_that_says_so(act: Any, says: str) -> None:
    with troupe.Simulation(WORLD, controllers=False) as sim:
        with pytest.raises(ValueError, match=says):
            act(sim)
        sim.step()  # it goes on


def test_there_are_no_steps_after_the_end() -> None:
    with troupe.Simulation(WORLD, controllers=False) as sim:
        sim.step(30)
        assert (sim.over, sim.outcome) == (True, "completed")
        with pytest.raises(RuntimeError, match="the run is over at 3 s"):
            sim.step()
    with pytest.raises(RuntimeError, match="closed"):
        sim.step()
    assert sim.result().ticks == 30


def test_a_function_that_raises_is_named_with_its_tick_and_the_result_is_kept() -> None:
    def fail(robot: Robot) -> None:
        if robot.name == "two" and robot.time > 0.35:
            raise ZeroDivisionError("no")

    with troupe.Simulation(WORLD, controllers={"mine": fail}) as sim:
        with pytest.raises(troupe.RunError, match=r"two raised at tick 4 .*: no") as e:
            sim.step(10)
        assert e.value.result.ticks == 4
        with pytest.raises(RuntimeError, match="closed"):
            sim.step()
    with pytest.raises(troupe.RunError, match=r"two raised at tick 4") as caught:
        troupe.run(WORLD, controllers={"mine": fail})
    assert caught.value.result.ticks == 4


def test_a_function_can_finish() -> None:
    def stop(robot: Robot) -> None:
        if robot.time > 0.45:
            robot.finish()

    result = troupe.run({**WORLD, "until": "controllers"}, controllers={"mine": stop})
    assert (result.outcome, result.ticks) == ("completed", 5)
    assert {robot.state for robot in result.robots} == {"finished"}


def test_hooks_see_the_run_end_it_and_name_themselves_where_they_raise() -> None:
    times = []
    result = troupe.run(
        WORLD, controllers=False, each_tick=lambda sim: times.append(sim.time),
        until=lambda sim: sim.time > 0.95, trajectories=True,
    )  # fmt: skip
    assert (result.outcome, result.ticks) == ("completed", 10)
    assert times == pytest.approx(np.arange(1, 11) * 0.1)
    assert result.times is not None
    assert result.poses is not None
    assert (result.times.shape, result.poses.shape) == ((10,), (10, 2, 3))
    with pytest.raises(troupe.RunError, match=r"each_tick raised at tick 1 .*KeyError") as caught:
        troupe.run(WORLD, controllers=False, each_tick=lambda sim: {}["x"])
    assert caught.value.result.ticks == 1
    with pytest.raises(troupe.RunError, match="a hook cannot step it"):
        troupe.run(WORLD, controllers=False, each_tick=lambda sim: sim.step())


def test_two_simulations_live_side_by_side_and_one_that_is_dropped_leaves_nothing(
    program: dict[str, Any],
) -> None:
    me = psutil.Process(os.getpid())
    gc.collect()
    before = {child.pid for child in me.children(recursive=True)}
    one, two = troupe.Simulation(program), troupe.Simulation(program, seed=2)
    one.step(3)
    two.step(3)
    assert {child.pid for child in me.children(recursive=True)} > before
    del one, two
    gc.collect()
    left = [
        child for child in me.children(recursive=True)
        if child.pid not in before and child.status() != psutil.STATUS_ZOMBIE
    ]  # fmt: skip
    assert left == []


def test_a_world_is_checked_and_written_as_yaml(tmp_path: Path) -> None:
    world = troupe.World(WORLD, duration=1)
    assert world.models["rover"].body.radius == 0.3
    assert (world.duration, len(world.robots)) == (1, 2)
    world.to_yaml(tmp_path / "world.yaml")
    digests = {
        troupe.run(one, controllers=False).digest
        for one in (world, tmp_path / "world.yaml", troupe.load(tmp_path / "world.yaml"))
    }
    assert len(digests) == 1
    assert world.with_settings({"models.rover.body.radius": 0.2}).models["rover"].body.radius == 0.2
    with pytest.raises(troupe.WorldError) as caught:
        troupe.World(size=[4, 3], models={"a": {"body": {"shape": "circle", "radiuss": 1}}})
    lines = str(caught.value).splitlines()
    assert any(
        line.startswith("models.a.body.radiuss: ") and "did you mean" in line for line in lines
    )


def test_controllers_that_no_robot_has_are_refused() -> None:
    with pytest.raises(ValueError, match="no robot has the controller 'yours'; there are mine"):
        troupe.Simulation(WORLD, controllers={"yours": function()})
    with pytest.raises(ValueError, match="must be a function"):
        troupe.Simulation(WORLD, controllers={"mine": "wander"})  # type: ignore[dict-item]
