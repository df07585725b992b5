"""Benchmarks of the stage; they run with `--benchmark-only`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from stage_worlds import robot, world

from sim.stage.floor import FloorPaint
from sim.stage.layout import build_layout
from sim.stage.placement import place
from sim.stage.stage import Stage
from sim.worldfile.robots import expanded

MODELS = {"a": robot(size=(1.0, 1.0))}


def crowd(count: int, size: tuple[float, float]) -> Stage:
    """Robots that wander, at random places."""
    entry = {"model": "a", "count": count, "placement": "random"}
    made = world(size=size, models=MODELS, robots=[entry])
    layout = build_layout(made, Path())
    stage = Stage(layout, made.models, made.clock)
    for pose in place(layout, expanded(enumerate(made.robots)), made.models, 1):
        stage.add_robot("a", pose)
    turns = np.random.default_rng(1).uniform(-0.8, 0.8, count)
    stage.command(np.arange(count), np.stack([np.full(count, 0.4), 0 * turns, turns], axis=1))
    return stage


@pytest.mark.parametrize(
    ("count", "size"),
    [
        (4, (16.0, 21.0)),
        (100, (100.0, 100.0)),
        (1000, (math.sqrt(1e5), math.sqrt(1e5))),
        (1000, (60.0, 60.0)),
    ],
    ids=["4-paper", "100-sparse", "1000-sparse", "1000-dense"],
)
def test_tick(benchmark: Any, count: int, size: tuple[float, float]) -> None:
    """One tick of 0.1 s in five steps; sparse is 0.01 robots per square metre."""
    stage = crowd(count, size)
    for _ in range(20):
        stage.tick()
    benchmark.pedantic(stage.tick, rounds=50, iterations=4 if count == 4 else 1)


def test_tick_of_four_robots_pressed_to_a_wall(benchmark: Any) -> None:
    stage = crowd(4, (16.0, 21.0))
    for number in range(4):
        stage.set_pose(number, (15.4, 3.0 + 4 * number, 0.0))
    stage.command(np.arange(4), [[0.4, 0.0, 0.0]] * 4)
    for _ in range(20):
        stage.tick()
    benchmark.pedantic(stage.tick, rounds=50, iterations=4)
    assert stage.stalls.all()


def test_place_a_thousand_robots(benchmark: Any) -> None:
    entry = {"model": "a", "count": 1000, "placement": "random"}
    made = world(size=(316.0, 316.0), models=MODELS, robots=[entry])
    layout = build_layout(made, Path())
    robots = expanded(enumerate(made.robots))
    benchmark.pedantic(place, (layout, robots, made.models, 1), rounds=3)


def test_spray(benchmark: Any) -> None:
    """Four sprayers of 1 x 1 m on cells of 5 cm, on their way."""
    paint = FloorPaint(build_layout(world(size=(16.0, 21.0)), Path()), 0.05)
    numbers = np.arange(4)
    poses = np.array([[3.0, 3.0 + 4 * k, 0.3 * k] for k in range(4)])
    size, offset = np.ones((4, 2)), np.zeros((4, 2))

    def stamp() -> None:
        ways = np.stack([poses, poses], axis=1)
        ways[:, 1, 0] += 0.001
        paint.spray(numbers, numbers, ways, size, offset)
        poses[:] = ways[:, 1]

    benchmark.pedantic(stamp, rounds=50, iterations=20, warmup_rounds=1)
