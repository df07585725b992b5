"""Bumpers close where the outline of their body touches, all along a flat contact."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from tests.sim.moved_world import Moved

PARTS = [[-10, 10], [10, 40], [80, 100], [170, 190], [-100, -80], [30, 60]]
WORLD = """\
size: [12, 12]
duration: 20
models:
  bumping:
    body: {body}
    drive: {{kind: omnidirectional, max_torque: 500}}
    sensors:
      - {{type: bumper}}
      - {{type: bumper, count: 12}}
      - {{type: bumper, parts: {parts}}}
  other:
    body: {{shape: box, size: [1, 1], mass: 50}}
    drive: {{kind: omnidirectional, max_torque: 500}}
robots:
  - {{name: one, model: bumping, pose: {pose}, controller: null}}
{more}
"""
SIDES = {"ahead": (1, 0), "left": (0, 1), "behind": (-1, 0), "right": (0, -1)}
BOXES = [(0.4, 0.6), (1, 1), (0.6, 0.4)]


def moved(folder: Path, body: str, pose: str, more: str = "") -> Moved:
    return Moved(folder, WORLD.format(body=body, pose=pose, more=more, parts=PARTS))


def box(size: tuple[float, float]) -> str:
    return f"{{shape: box, size: [{size[0]}, {size[1]}]}}"


def arcs(count: int) -> list[tuple[float, float]]:
    return [((k - 0.5) * 360 / count, (k + 0.5) * 360 / count) for k in range(count)]


def assert_closed(world: Moved, robot: int, stretches: Iterable[tuple[float, float]]) -> None:
    """The closed switches are those that meet a stretch, given in degrees from one end on.

    Its bearings are known to 1.5 degrees where other bodies bound it: these stand 2 to 5 mm
    nearer than they would without the overlap, seen from 0.2 m. Switches that begin or end so
    near to the end of a stretch may be either.
    """
    told = list(stretches)
    for index, switches in enumerate([arcs(4), arcs(12), PARTS]):
        bits = world.data(robot, index).bits[0]
        for (begin, end), bit in zip(switches, bits, strict=True):
            surely = any(meet(begin, end, low + 1.5, high - 1.5) for low, high in told)
            maybe = any(meet(begin, end, low - 1.5, high + 1.5) for low, high in told)
            assert surely <= bit <= maybe, (index, begin, end, told)


def meet(begin: float, end: float, low: float, high: float) -> bool:
    """Whether two arcs meet; a point that was shortened to less is its middle."""
    low, high = min(low, (low + high) / 2), max(high, (low + high) / 2)
    return any(low + turn <= end and high + turn >= begin for turn in (-720, -360, 0, 360, 720))


def flat(length: float, width: float, side: str) -> tuple[float, float]:
    """The bearings of a whole side of a box."""
    half = math.degrees(math.atan2(width, length))
    return {
        "ahead": (-half, half),
        "left": (half, 180 - half),
        "behind": (180 - half, 180 + half),
        "right": (180 + half, 360 - half),
    }[side]


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("size", BOXES)
@pytest.mark.parametrize("heading", [0, 90, -170])
def test_a_side_flat_on_a_wall_closes_every_switch_along_it(
    size: tuple[float, float], side: str, heading: int, tmp_path: Path
) -> None:
    more = "obstacles: [{shape: box, size: [%s, 4], pose: [%s, %s, %s]}]"
    way = np.radians(heading) + math.atan2(SIDES[side][1], SIDES[side][0])
    x, y = 6 + 2.0 * math.cos(way), 6 + 2.0 * math.sin(way)
    world = moved(tmp_path, box(size), f"[6, 6, {heading}]", more % (2, x, y, math.degrees(way)))
    world.drive([(0.5 * SIDES[side][0], 0.5 * SIDES[side][1], 0)], 2.5)
    low, high = flat(*size, side)
    assert_closed(world, 0, [(low, high)])
    assert world.data(0, 0).bits[0][list(SIDES).index(side)]
    # The side's ends are the body's own corners, so a switch that begins there is closed, too.
    if size == (1, 1):
        order = list(SIDES)
        opposite = order[(order.index(side) + 2) % 4]
        closed = [name for name, bit in zip(order, world.data(0, 0).bits[0], strict=True) if bit]
        assert closed == [name for name in order if name != opposite]


@pytest.mark.parametrize("size", BOXES)
def test_a_part_of_a_side_closes_the_switches_along_that_part(
    size: tuple[float, float], tmp_path: Path
) -> None:
    for what in (
        "obstacles: [{shape: box, size: [1, 1], pose: [5, 3.55, 0]}]",
        "obstacles: [{shape: box, size: [1, 1], pose: [5, 3.55, 0], movable: true, mass: 90}]",
        "  - {name: two, model: other, pose: [5, 3.55, 0], controller: null}",
    ):
        world = moved(tmp_path, box(size), "[3.6, 3, 0]", what)
        world.drive([(0.3, 0, 0), (0, 0, 0)][: len(world.names)], 3)
        assert world.poses[0, 2] == pytest.approx(0, abs=0.01)
        low = math.degrees(math.atan2(3.05 - world.poses[0, 1], size[0] / 2))
        assert_closed(world, 0, [(low, flat(*size, "ahead")[1])])
        assert not world.data(0, 0).bits[0][2]


@pytest.mark.parametrize("size", BOXES)
def test_a_body_in_a_corner_closes_the_switches_along_both_walls(
    size: tuple[float, float], tmp_path: Path
) -> None:
    world = moved(tmp_path, box(size), "[11, 11, 0]")
    world.drive([(0.4, 0.4, 0)], 4)
    assert_closed(world, 0, [flat(*size, "ahead"), flat(*size, "left")])
    assert world.data(0, 0).bits[0][:2].all()


@pytest.mark.parametrize("size", BOXES)
def test_a_body_between_two_others_closes_the_switches_on_both_sides(
    size: tuple[float, float], tmp_path: Path
) -> None:
    more = """\
  - {name: two, model: other, pose: [7.2, 6, 180], controller: null}
  - {name: three, model: other, pose: [4.8, 6, 0], controller: null}"""
    world = moved(tmp_path, box(size), "[6, 6, 0]", more)
    world.drive([(0, 0, 0), (0.4, 0, 0), (0.4, 0, 0)], 4)
    assert_closed(world, 0, [flat(*size, "ahead"), flat(*size, "behind")])
    assert world.data(0, 0).bits[0][[0, 2]].all()


def test_a_corner_of_a_body_closes_the_switches_of_its_own_bearing_alone(tmp_path: Path) -> None:
    corner = math.degrees(math.atan2(0.4, 0.6))
    world = moved(tmp_path, box((0.6, 0.4)), f"[11, 6, {-corner}]")
    turned = math.radians(corner)
    world.drive([(0.4 * math.cos(turned), 0.4 * math.sin(turned), 0)], 3)
    assert world.data(0, 0).bits[0].tolist() == [True, False, False, False]
    assert np.flatnonzero(world.data(0, 1).bits[0]).tolist() == [1]
    assert np.flatnonzero(world.data(0, 2).bits[0]).tolist() == [1, 5]


@pytest.mark.parametrize("way", [0, 50, 95, 181, -77])
def test_a_round_body_closes_the_switch_that_faces_what_it_touches(
    way: float, tmp_path: Path
) -> None:
    turn = math.radians(way)
    x, y = 6 + 2 * math.cos(turn), 6 + 2 * math.sin(turn)
    for shape in ("shape: circle, radius: 1", "shape: box, size: [2, 2]"):
        world = moved(
            tmp_path,
            "{shape: circle, radius: 0.3}",
            "[6, 6, 0]",
            f"obstacles: [{{{shape}, pose: [{x}, {y}, {way}]}}]",
        )
        world.drive([(0.4 * math.cos(turn), 0.4 * math.sin(turn), 0)], 3)
        for index, switches in enumerate([arcs(4), arcs(12), PARTS]):
            bits = world.data(0, index).bits[0].tolist()
            assert bits == [meet(begin, end, way, way) for begin, end in switches]


def test_a_polygons_side_closes_the_switches_along_it(tmp_path: Path) -> None:
    # A pentagon with a blunt front of 0.3 m and a slanted side.
    points = "[[0.4, -0.15], [0.4, 0.15], [0, 0.4], [-0.3, 0], [0, -0.4]]"
    body = f"{{shape: polygon, points: {points}}}"
    world = moved(tmp_path, body, "[11, 6, 0]")
    world.drive([(0.4, 0, 0)], 3)
    blunt = math.degrees(math.atan2(0.15, 0.4))
    assert_closed(world, 0, [(-blunt, blunt)])
    slanted = math.atan2(0.4, 0.25)  # the direction square to the slanted side
    world = moved(tmp_path, body, f"[11, 6, {-math.degrees(slanted)}]")
    world.drive([(0.4 * math.cos(slanted), 0.4 * math.sin(slanted), 0)], 3)
    assert_closed(world, 0, [(blunt, 90)])
    assert world.data(0, 0).bits[0].tolist() == [True, True, False, False]


def test_a_flat_side_over_the_seams_of_a_map_is_closed_all_along(tmp_path: Path) -> None:
    rows = ["........", "....####", "....###.", "....####", "....##..", "........"]
    more = "map: {file: cells.txt, cell: 0.5}"
    text = WORLD.format(body=box((1, 1)), pose="[1, 1.5, 0]", more=more, parts=PARTS)
    world = Moved(tmp_path, text.replace("size: [12, 12]\n", ""), **{"cells.txt": "\n".join(rows)})
    world.drive([(0.4, 0, 0)], 3)
    assert_closed(world, 0, [(-45, 45)])
    assert world.data(0, 2).bits[0].tolist() == [True, True, False, False, False, True]
