"""A bench for Paint without physics: square bodies that move as told, exact lasers and blobs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from controllers.paint.brain import Brain, Command, Reading, Settings
from controllers.paint.constants import LEVEL
from controllers.paint.cycle import step
from controllers.paint.geometry import Pose
from sensors.rays import bearings_of, cast
from sensors.scene import Scene
from troupe.testing.evidence import Evidence, Surroundings
from troupe.testing.paint.goals import SAME_HEIGHT
from troupe.testing.ranks import passings
from troupe.testing.touching import contacts

INTERVAL = 0.1  # s
ACCELERATION = 2.0  # m/s2
TURN_ACCELERATION = math.radians(360.0)
SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
RED, GREEN = 0xFF0000, 0x00FF00


class Blob(NamedTuple):
    """A run of one colour in the image."""

    color: int
    left: int
    right: int


@dataclass
class Outcome:
    """What came of a run."""

    time: float
    finished: list[bool]
    reports: list[dict[str, Any]]
    failures: list[str | None]
    poses: NDArray[np.float64]
    starts: NDArray[np.float64]
    contacts: int = 0
    swaps: int = 0
    said: list[list[tuple[float, str]]] = field(default_factory=list)


def blobs_of(colors: NDArray[np.int64]) -> list[Blob]:
    """Runs of one colour, from the image's left; `colors` is per column, 0 for nothing."""
    found = []
    first = 0
    for column in range(1, len(colors) + 1):
        if column == len(colors) or colors[column] != colors[first]:
            if colors[first]:
                found.append(Blob(int(colors[first]), first, column - 1))
            first = column
    return found


def run(
    starts: NDArray[np.float64],
    settings: Callable[[int], Settings],
    region: NDArray[np.float64],
    *,
    duration: float = 1800.0,
    seed: int = 0,
    ranks: Sequence[int | None] | None = None,
    each_tick: Callable[[float, NDArray[np.float64]], None] = lambda time, poses: None,
) -> Outcome:
    """Run robots that start at (n, 3) poses in a region until all have finished or failed.

    `ranks`, if given, are what the first robots know of their ranks from the beginning; the others
    only stand there. `each_tick(time, poses)` may move those.
    """
    count = len(starts)
    brains = [Brain(settings(i), np.random.default_rng([seed, i]).random) for i in range(count)]
    for brain, rank in zip(brains, ranks or (), strict=False):
        if rank is not None:
            below, above = rank - 1, brain.settings.robots - rank
            brain.memory.bounds.below, brain.memory.bounds.above = (below, below), (above, above)
    scene = Scene()
    walls = scene.add_entity(color=RED)
    scene.add_segments(walls, np.hstack([region, np.roll(region, -1, axis=0)]))
    for start in starts:
        entity = scene.add_entity(color=GREEN, pose=start)
        scene.add_polygon(entity, SQUARE)
    poses = starts.astype(float).copy()
    velocity = np.zeros((count, 3))
    outcome = Outcome(
        0.0, [False] * count, [{} for _ in starts], [None] * count, poses, starts.copy()
    )
    outcome.said = [[] for _ in starts]
    outcome.finished = [ranks is not None and i >= len(ranks) for i in range(count)]
    times: list[float] = []
    ways: list[NDArray[np.float64]] = []
    own = np.arange(1, count + 1)
    fov = math.pi
    bearings = bearings_of(fov, 180)
    palette = np.array([0, RED, *[GREEN] * count], np.int64)
    tick = 0
    while tick * INTERVAL < duration and not all(
        f or e for f, e in zip(outcome.finished, outcome.failures, strict=True)
    ):
        time = tick * INTERVAL
        each_tick(time, poses)
        scene.poses[1:] = poses
        scene.refresh()
        ranges, _ = cast(scene, poses, own, fov, 180, 20.0)
        _, hits = cast(scene, poses, own, fov, 160, 20.0)
        wanted = np.zeros((count, 3))
        for i, brain in enumerate(brains):
            if outcome.finished[i] or outcome.failures[i]:
                continue
            dx, dy = poses[i, :2] - starts[i, :2]
            cos, sin = math.cos(starts[i, 2]), math.sin(starts[i, 2])
            yaw = math.remainder(poses[i, 2] - starts[i, 2], math.tau)
            pose = Pose(cos * dx + sin * dy, cos * dy - sin * dx, yaw)
            reading = Reading(
                time, pose, ranges[i], bearings, 20.0, blobs_of(palette[hits[i, ::-1] + 1]), 160
            )
            command = step(brain, reading)
            wanted[i] = _take(outcome, i, command, time)
        steps = np.array([ACCELERATION, ACCELERATION, TURN_ACCELERATION]) * 0.02
        for _ in range(5):
            velocity += np.clip(wanted - velocity, -steps, steps)
            cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
            poses[:, 0] += (cos * velocity[:, 0] - sin * velocity[:, 1]) * 0.02
            poses[:, 1] += (sin * velocity[:, 0] + cos * velocity[:, 1]) * 0.02
            poses[:, 2] += velocity[:, 2] * 0.02
        times.append(time + INTERVAL)
        ways.append(poses.copy())
        tick += 1
    outcome.time = tick * INTERVAL
    width, height = region.max(axis=0).tolist()
    seen = Evidence(
        [f"robot {i}" for i in range(count)],
        [SQUARE] * count,
        starts,
        np.array(times),
        np.array(ways).reshape(-1, count, 3),
        Surroundings((width, height), region),
    )
    outcome.contacts = len(contacts(seen))
    outcome.swaps = len(passings(seen, level=LEVEL, give=SAME_HEIGHT))
    return outcome


def _take(outcome: Outcome, i: int, command: Command, time: float) -> tuple[float, float, float]:
    outcome.reports[i].update(command.report)
    if command.say is not None:
        outcome.said[i].append((time, command.say))
    outcome.finished[i] = command.finished
    outcome.failures[i] = command.failure
    if command.finished or command.failure:
        return 0.0, 0.0, 0.0
    return command.motion.ahead, command.motion.left, command.motion.turn


def random_starts(
    rng: np.random.Generator,
    count: int,
    size: tuple[float, float],
    margin: float,
    headings: tuple[float, ...],
    level: int = 0,
) -> NDArray[np.float64]:
    """Random poses (n, 3) whose bodies are `margin` from each other and the walls.

    The first `level` of them stand on one height.
    """
    room = 0.5 + margin
    while True:
        xy = rng.uniform((room, room), (size[0] - room, size[1] - room), (count, 2))
        xy[1:level, 1] = xy[0, 1] if level else 0.0
        gaps = np.abs(xy[:, None, :] - xy[None, :, :]).max(axis=2) + 10.0 * np.eye(count)
        if gaps.min() >= 1.0 + margin:
            break
    yaw = rng.choice(np.array(headings), count)
    return np.column_stack([xy, yaw])
