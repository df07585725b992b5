"""A gripper closes on what lies between its paddles, carries it, and lets it go."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import troupe
from player import GripperProxy, Position2dProxy, Robot
from sim.log.reader import LogReader
from sim.log.replay import check
from troupe import Simulation

INNER, OUTER = 4, 8

PUCK = {"shape": "circle", "radius": 0.08, "pose": [2.3, 2.0, 0.0], "movable": True, "mass": 1.0}


def world(*obstacles: dict[str, Any], **gripper: Any) -> dict[str, Any]:
    return {
        "size": [10, 10],
        "duration": 60,
        "models": {
            "fetcher": {
                "body": {"shape": "circle", "radius": 0.2, "mass": 8},
                "simulation": "full",
                "actuators": [{"type": "gripper", **gripper}],
            }
        },
        "obstacles": [{"name": f"puck{k}", **one} for k, one in enumerate(obstacles)],
        "robots": [{"name": "a", "model": "fetcher", "pose": [2, 2, 0], "controller": "mine"}],
        "controllers": {"mine": {"external": True}},
    }


class Fetcher:
    """One run, whose robot does what it is told from outside."""

    def __init__(self, data: dict[str, Any]) -> None:
        self.todo: list[Callable[[Robot], object]] = []
        self.robot: Robot | None = None
        self.sim = Simulation(data, controllers={"mine": self.drive})

    def drive(self, robot: Robot) -> None:
        self.robot = robot
        _ = robot.gripper, robot.base, robot.simulation
        for one in self.todo:
            one(robot)
        self.todo.clear()

    def tell(self, *what: Callable[[Robot], object], ticks: int = 2) -> None:
        """Have it told, and so many ticks go by: the first brings what it is told to the robot."""
        self.todo += what
        for _ in range(ticks):
            self.sim.step()

    @property
    def gripper(self) -> GripperProxy:
        assert self.robot is not None
        return self.robot.gripper

    @property
    def base(self) -> Position2dProxy:
        assert self.robot is not None
        return self.robot.base

    @property
    def stage(self) -> Any:
        return self.sim._engine.scenery.stage

    def seen_from_robot(self, number: int = 0) -> np.ndarray:
        """Where a puck is in the robot's frame: x, y, yaw."""
        x, y, yaw = self.stage.poses[0]
        px, py, turned = self.stage.movable_poses[number]
        cos, sin = math.cos(yaw), math.sin(yaw)
        dx, dy = px - x, py - y
        away = math.remainder(turned - yaw, math.tau)
        return np.array([cos * dx + sin * dy, cos * dy - sin * dx, away])


@pytest.fixture
def fetcher() -> Iterator[Callable[..., Fetcher]]:
    made: list[Fetcher] = []

    def make(*obstacles: dict[str, Any], **gripper: Any) -> Fetcher:
        made.append(Fetcher(world(*obstacles, **gripper)))
        made[-1].tell(ticks=2)
        return made[-1]

    yield make
    for one in made:
        one.sim.close()


def grip(robot: Robot) -> None:
    robot.gripper.close_paddles()


def let_go(robot: Robot) -> None:
    robot.gripper.open_paddles()


def test_what_is_gripped_goes_where_the_robot_goes(fetcher: Callable[..., Fetcher]) -> None:
    one = fetcher({**PUCK, "pose": [2.31, 2.02, 30]})
    one.tell(grip)
    assert one.gripper.closed
    where = one.seen_from_robot()
    for forward, turn in ((0.5, 0.0), (0.3, 1.5), (-0.5, -1.0), (0.0, -1.5)):
        one.tell(lambda robot, f=forward, t=turn: robot.base.set_speed(f, t), ticks=12)
        assert one.seen_from_robot() == pytest.approx(where, abs=0.003)
    assert np.hypot(*(one.stage.movable_poses[0, :2] - [2.3, 2.0])) > 0.5


def test_what_is_let_go_stays_where_it_is(fetcher: Callable[..., Fetcher]) -> None:
    one = fetcher(PUCK)
    one.tell(grip, lambda robot: robot.base.set_speed(0.0, 1.0), ticks=10)
    one.tell(lambda robot: robot.base.set_speed(0.0, 0.0), ticks=10)
    one.tell(let_go, ticks=4)
    before = one.stage.movable_poses[0].copy()
    one.tell(lambda robot: robot.base.set_speed(-0.5, 0.0), ticks=10)
    assert one.stage.movable_poses[0] == pytest.approx(before, abs=1e-6)
    assert one.gripper.opened
    assert one.stage.holders == {}


@pytest.mark.parametrize(
    ("x", "radius", "beams"),
    [(2.3, 0.08, INNER | OUTER), (2.39, 0.08, OUTER), (2.268, 0.02, INNER), (2.5, 0.08, 0)],
)
def test_beams_tell_how_far_in_a_thing_is(
    fetcher: Callable[..., Fetcher], x: float, radius: float, beams: int
) -> None:
    one = fetcher({**PUCK, "radius": radius, "pose": [x, 2.0, 0.0]})
    assert one.gripper.beams == beams
    assert one.gripper.stored == 0


@pytest.mark.parametrize(
    "puck",
    [
        {**PUCK, "pose": [2.5, 2.0, 0.0]},  # out of reach
        {**PUCK, "pose": [2.3, 2.1, 0.0]},  # one paddle would meet it
        {**PUCK, "radius": 0.15, "pose": [2.36, 2.0, 0.0]},  # wider than the paddles open
        {**PUCK, "movable": False, "mass": 10.0},  # it stands
        {**PUCK, "z": 1.5},  # above the robot
    ],
    ids=["far", "aside", "wide", "standing", "above"],
)
def test_paddles_close_on_nothing_else(
    fetcher: Callable[..., Fetcher], puck: dict[str, Any]
) -> None:
    one = fetcher(puck)
    one.tell(grip)
    assert one.gripper.closed
    assert one.gripper.beams == 0
    assert one.stage.holders == {}


def test_of_several_the_one_that_is_further_in_is_held(fetcher: Callable[..., Fetcher]) -> None:
    small = {**PUCK, "radius": 0.03}
    one = fetcher({**small, "pose": [2.34, 2.0, 0]}, {**small, "pose": [2.26, 2.0, 0]})
    one.tell(grip)
    assert one.stage.holders == {1: 0}
    assert one.gripper.beams == INNER


def test_a_robot_that_is_put_elsewhere_lets_go(fetcher: Callable[..., Fetcher]) -> None:
    one = fetcher(PUCK)
    one.tell(grip)
    one.tell(lambda robot: robot.simulation.set_pose2d("a", (6.0, 6.0, 0.0)), ticks=3)
    assert one.stage.poses[0, 0] == pytest.approx(6.0, abs=0.01)
    assert one.stage.movable_poses[0, :2] == pytest.approx([2.3, 2.0], abs=0.01)
    assert one.stage.holders == {}
    one.tell(lambda robot: robot.simulation.set_pose2d("puck0", (6.3, 6.0, 0.0)), ticks=3)
    one.tell(let_go)
    one.tell(grip)
    assert one.stage.holders == {0: 0}
    one.tell(lambda robot: robot.simulation.set_pose2d("puck0", (3.0, 3.0, 0.0)), ticks=3)
    assert one.stage.holders == {}
    assert one.gripper.beams == 0


def test_the_geometry_is_that_of_the_world_file(fetcher: Callable[..., Fetcher]) -> None:
    one = fetcher(pose=[0.25, 0.1, 90], space=[0.2, 0.3])
    told = one.gripper.request_geometry()
    assert told.pose == pytest.approx((0.25, 0.1, 0, 0, 0, math.pi / 2))
    assert told.inner_size[:2] == pytest.approx((0.2, 0.3))
    assert told.outer_size[:2] == pytest.approx((0.2, 0.36))
    assert (told.beams, told.capacity) == (2, 0)


def test_paddles_show_where_they_are(fetcher: Callable[..., Fetcher]) -> None:
    one = fetcher(PUCK)
    shown = one.sim._engine.robots[0].drawings

    def inner_sides(drawings: Any) -> list[float]:
        return [min(map(abs, drawing.points[:, 1].tolist())) for drawing in drawings]

    assert inner_sides(shown) == pytest.approx([0.12, 0.12])
    one.tell(grip)
    assert inner_sides(one.sim._engine.robots[0].drawings) == pytest.approx([0.08, 0.08], abs=1e-3)


CARRIES = """\
from player import GripperProxy, PlayerClient, Position2dProxy
with PlayerClient() as robot:
    base, gripper = Position2dProxy(robot), GripperProxy(robot)
    robot.read()
    while not gripper.beams & 4:
        base.set_speed(0.3)
        robot.read()
    gripper.close_paddles()
    for step in range(30):
        base.set_speed(0.4, 0.6)
        robot.read()
    gripper.open_paddles()
    for step in range(10):
        base.set_speed(-0.4)
        robot.read()
"""


def test_a_program_fetches_and_its_log_runs_again_bit_by_bit(tmp_path: Path) -> None:
    data = world({**PUCK, "pose": [3.0, 2.0, 0.0]})
    (tmp_path / "carries.py").write_text(CARRIES)
    data["controllers"] = {"mine": {"program": str(tmp_path / "carries.py")}}
    results = [troupe.run(data, log=tmp_path / f"{name}.mcap") for name in "ab"]
    assert results[0].outcome == "completed"
    assert results[0].digest == results[1].digest
    assert check(LogReader(tmp_path / "a.mcap"), results[0].digest).equal
