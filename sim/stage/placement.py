"""Where robots start: fixed poses that are checked, and random ones that depend on the seed."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby, islice
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.stage.fits import ROUNDING, FreeSpace
from sim.stage.geometry import Floats, least_width, outline, placed
from sim.stage.layout import Layout
from sim.worldfile.mistakes import Mistake, WorldError

if TYPE_CHECKING:
    from sim.worldfile.robots import RobotSpec
    from sim.worldfile.schema import Model

TRIES = 500
"""Random poses tried for a robot before the places on a lattice are looked through."""
LINES = 50
"""Random lines tried for robots that start on the same y."""
MOST_ROWS = 400
"""Lines of a lattice tried for them after that."""
MOST_PLACES = 2_000_000
"""Of a lattice; where it is a sliver of a huge world, the search must end some time."""
APART = 1e-6
"""m between robots that are asked to keep no margin: to touch would be a contact."""
TOUCH = 1e-6
"""m of overlap at the start that rounding of degrees and sums in a world file may make."""


def place(
    layout: Layout, robots: Sequence[RobotSpec], models: Mapping[str, Model], seed: int
) -> Floats:
    """The start poses (n, 3) of robots in their order: x, y, yaw in radians.

    Robots with a pose keep it; then the others are drawn entry by entry, each at least its
    margin away from all that is there. The numbers come from numpy's generator, seeded with
    the run's seed and a constant: nothing else of the run changes them. Raises WorldError
    where an entry's robots cannot all be placed.
    """
    rng = np.random.default_rng([seed, zlib.crc32(b"placement")])
    poses = np.zeros((len(robots), 3))
    room = FreeSpace(layout)
    for index, robot in enumerate(robots):
        if robot.pose is not None:
            poses[index] = robot.pose
            body = models[robot.model].body
            room.add_body(body, robot.pose, layout.levels.of(body))
    drawn = [index for index, robot in enumerate(robots) if robot.pose is None]
    for _, group in groupby(drawn, key=lambda index: robots[index].entry):
        entry = list(group)
        levels = layout.levels.of(models[robots[entry[0]].model].body)
        chosen = _place_entry(room, [robots[index] for index in entry], models, levels, rng)
        poses[entry] = chosen
    return poses


def _place_entry(
    room: FreeSpace,
    robots: list[RobotSpec],
    models: Mapping[str, Model],
    levels: int,
    rng: np.random.Generator,
) -> Floats:
    """Poses (k, 3) for the robots of an entry; they are in the room afterwards."""
    rule = robots[0].placement
    margin = 0.1 if rule is None else rule.margin
    shape = outline(models[robots[0].model].body)
    start = room.mark()
    found: list[Floats] | None = None
    for attempt in _attempts(room, robots, shape, margin, rng, rule is not None and rule.same_y):
        found = _fill(room, robots, shape, margin, levels, attempt)
        if found is not None:
            break
        room.back_to(start)
    if found is None:
        what = f"{len(robots)} robot(s) of model {robots[0].model} do not fit here"
        allowed = "fewer robots, a smaller margin, or a larger world"
        given = f"margin: {margin:g}" + (", on one line" if rule and rule.same_y else "")
        raise WorldError([Mistake(("robots", robots[0].entry), what, given, allowed)])
    return np.array(found)


Attempt = Callable[[int], Iterator[Floats]]
"""The poses to try for the i-th robot of an entry, in this order."""


def _attempts(
    room: FreeSpace,
    robots: list[RobotSpec],
    shape: Floats,
    margin: float,
    rng: np.random.Generator,
    same_y: bool,
) -> Iterator[Attempt]:
    """Ways to place an entry: at random, and where that fails as close as a lattice allows."""
    if room.too_small_for(len(robots), shape, margin):
        return
    if not same_y:
        yield _scattered(room, robots, shape, margin, rng)
        close = _lattice(room, robots[0], shape, margin, None)
        yield lambda index: close
        return
    narrowest = least_width(shape)
    if robots[0].headings is not None:
        turned = [placed(shape, (0.0, 0.0, yaw))[:, 0] for yaw in robots[0].headings]
        narrowest = min(float(np.ptp(x)) for x in turned)
    if len(robots) * (narrowest + margin) + margin > room.high[0] - room.low[0] + ROUNDING:
        return
    low, high = room.low[1], room.high[1]
    for _ in range(LINES):
        line = _spread(room, robots, shape, margin, rng, float(rng.uniform(low, high)))
        if line is not None:
            yield lambda index, line=line: iter([line[index]])  # type: ignore[misc]
    rows = min(max(2, math.ceil((high - low) / (narrowest / 4.0))), MOST_ROWS)
    for y in np.linspace(low, high, rows).tolist():
        row = _lattice(room, robots[0], shape, margin, y)
        yield lambda index, row=row: row  # type: ignore[misc]


def _scattered(
    room: FreeSpace, robots: list[RobotSpec], shape: Floats, margin: float, rng: np.random.Generator
) -> Attempt:
    """Random poses; once a robot has found none, a lattice for it and those after it.

    All robots of an entry go through one and the same lattice: a place that was taken for one
    is taken for the next.
    """
    lattice = _lattice(room, robots[0], shape, margin, None)
    jammed = False

    def poses(index: int) -> Iterator[Floats]:
        nonlocal jammed
        for _ in range(0 if jammed else TRIES):
            yield np.array([*rng.uniform(room.low, room.high), _heading(robots[index], rng)])
        jammed = True
        # Not `yield from`: that would end the lattice together with the robot's search.
        while (pose := next(lattice, None)) is not None:
            yield pose

    return poses


def _fill(
    room: FreeSpace,
    robots: list[RobotSpec],
    shape: Floats,
    margin: float,
    levels: int,
    attempt: Attempt,
) -> list[Floats] | None:
    """Place all robots of an entry in the first poses of an attempt that fit, or None.

    Where they get the headings in turn, the first one's is the pose's, and the others' follow.
    """
    rule, headings = robots[0].placement, robots[0].headings
    in_turn = headings if rule is not None and rule.in_turn else None
    found: list[Floats] = []
    for index in range(len(robots)):
        for pose in attempt(index):
            if in_turn is not None and found:
                begin = in_turn.index(float(found[0][2]))
                pose[2] = in_turn[(begin + index) % len(in_turn)]
            vertices = placed(shape, pose)
            if room.fits(vertices, margin, levels):
                room.occupy(vertices, margin, levels)
                found.append(pose)
                break
        else:
            return None
    return found


def _heading(robot: RobotSpec, rng: np.random.Generator) -> float:
    if robot.headings is None:
        return float(rng.uniform(-math.pi, math.pi))
    return robot.headings[int(rng.integers(len(robot.headings)))]


def _spread(
    room: FreeSpace,
    robots: list[RobotSpec],
    shape: Floats,
    margin: float,
    rng: np.random.Generator,
    y: float,
) -> list[Floats] | None:
    """Robots in random order on the line of height y, what room is left shared out at random.

    The free length is cut at sorted uniform numbers, which draws evenly from all ways to lay
    intervals side by side. None where the line is too short.
    """
    yaws = [_heading(robot, rng) for robot in robots]
    turned = [placed(shape, (0.0, 0.0, yaw)) for yaw in yaws]
    lowest = np.array([vertices[:, 0].min() for vertices in turned])
    widths = np.array([vertices[:, 0].max() for vertices in turned]) - lowest
    below = min(float(vertices[:, 1].min()) for vertices in turned) - margin
    above = max(float(vertices[:, 1].max()) for vertices in turned) + margin
    ends = [room.chord(y + below), room.chord(y + above)]
    left, right = max(end[0] for end in ends), min(end[1] for end in ends)
    free = right - left - float(widths.sum()) - margin * (len(robots) + 1)
    order = rng.permutation(len(robots))
    gaps = np.sort(rng.uniform(0.0, 1.0, len(robots)))
    if free < 0.0:
        return None
    poses = [np.zeros(3)] * len(robots)
    edge = left
    for place_number, robot in enumerate(order.tolist()):
        gap = free * gaps[place_number]
        start = edge + margin + gap - lowest[robot]
        poses[robot] = np.array([start, y, yaws[robot]])
        edge += margin + widths[robot]
    return poses


def _lattice(
    room: FreeSpace, robot: RobotSpec, shape: Floats, margin: float, y: float | None
) -> Iterator[Floats]:
    """Poses row by row and column by column, as close as a body and its margin need it."""
    headings = (0.0, math.pi / 2) if robot.headings is None else robot.headings
    for yaw in dict.fromkeys(headings):
        turned = placed(shape, (0.0, 0.0, yaw))
        lowest, highest = turned.min(axis=0), turned.max(axis=0)
        margin = max(margin, APART)
        step = highest - lowest + margin
        first = room.low - lowest + margin
        last = room.high - highest - margin
        for part in (1.0, 0.25):
            rows = spaced(first[1], last[1], step[1] * part) if y is None else iter([y])
            places = (
                (column, row)
                for row in rows
                for column in spaced(first[0], last[0], step[0] * part)
            )
            for column, row in islice(places, MOST_PLACES):
                yield np.array([column, row, yaw])


def spaced(first: float, last: float, step: float) -> Iterator[float]:
    """The numbers of `np.arange(first, last + 1e-9, step)`, one by one: there may be billions."""
    apart = (first + step) - first  # as numpy rounds it
    for index in range(max(0, math.ceil((last + 1e-9 - first) / step))):
        yield first + index * apart


def check_start(
    layout: Layout, robots: Sequence[RobotSpec], models: Mapping[str, Model]
) -> list[Mistake]:
    """Mistakes for robots with a pose that are off the world, in a wall or in each other.

    Touching is no mistake. The place of a mistake is the robot's entry: the later of two.
    """
    room = FreeSpace(layout, doors=False)
    mistakes: list[Mistake] = []
    owners: list[str] = []  # of each outline that was added
    first = room.mark()
    for robot in robots:
        if robot.pose is None or robot.model not in models:
            continue
        where: tuple[str | int, ...] = ("robots", robot.entry, "pose")
        body: Any = models[robot.model].body
        given = f"robot {robot.name} at [{robot.pose[0]:g}, {robot.pose[1]:g}]"
        centre = np.array([robot.pose[:2]])
        if not room.holds(centre):
            allowed = f"within {layout.size[0]:g} x {layout.size[1]:g} m"
            if layout.arena is layout.region:
                allowed += ", and within the region, whose edges are walls"
            mistakes.append(Mistake(where, "the robot starts outside of the world", given, allowed))
            continue
        levels = layout.levels.of(body)
        other = room.hit_by(body, robot.pose, TOUCH, levels)  # the first one tells enough
        if other is not None:
            what = "a wall or an obstacle" if other < first else f"robot {owners[other - first]}"
            what = f"the robot starts in {what}"
            mistakes.append(Mistake(where, what, given, "a free place"))
        room.add_body(body, robot.pose, levels)
        owners += [robot.name] * (room.mark() - first - len(owners))
    return mistakes
