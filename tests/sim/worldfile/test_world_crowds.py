"""Robots that cannot fit are told by their area, and robots that can are never refused by it."""

from __future__ import annotations

from math import pi

import pytest

from sim.worldfile.crowds import crowd_mistakes
from sim.worldfile.robots import RobotSpec
from sim.worldfile.schema import Body, Box, Circle, Model, PlacementRule, Polygon


def robots(count: int, margin: float, *, fixed: int = 0) -> list[RobotSpec]:
    rule = PlacementRule(margin=margin)
    placed = [RobotSpec(f"p{i}", "a", None, 0, None, rule, None) for i in range(count)]
    return placed + [RobotSpec(f"f{i}", "a", None, 1, (0, 0, 0), None, None) for i in range(fixed)]


def fits(body: Body, count: int, margin: float, size: tuple[float, float], fixed: int = 0) -> bool:
    specs = robots(count, margin, fixed=fixed)
    return crowd_mistakes(specs, {"a": Model(body=body)}, size) == []


@pytest.mark.parametrize("margin", [0, 0.1, 0.5, 2])
@pytest.mark.parametrize(("columns", "rows"), [(1, 1), (4, 3), (20, 20)])
def test_boxes_in_rows_with_their_margins_are_never_refused(
    columns: int, rows: int, margin: float
) -> None:
    box = Box(shape="box", size=(1.0, 0.5))
    size = (columns * (1 + margin) + margin, rows * (0.5 + margin) + margin)
    assert fits(box, columns * rows, margin, size)
    assert not fits(box, 2 * columns * rows + 2, margin, size)


def test_area_counts_in_all_three_shapes() -> None:
    shapes: list[tuple[Body, float]] = [
        (Box(shape="box", size=(2.0, 1.0)), 2),
        (Circle(shape="circle", radius=1.0), pi),
        (Polygon(shape="polygon", points=((0.0, 0.0), (2.0, 0.0), (0.0, 3.0))), 3),
    ]
    for body, area in shapes:
        assert fits(body, 10, 0, (10 * area * 1.001, 1))
        assert not fits(body, 10, 0, (10 * area * 0.999, 1))


def test_robots_with_a_pose_take_room_too() -> None:
    box = Box(shape="box", size=(1.0, 1.0))
    assert fits(box, 5, 0, (10, 1), fixed=5)
    assert not fits(box, 5, 0, (10, 1), fixed=6)
    assert fits(box, 0, 0, (1, 1), fixed=6)  # their overlaps are told one by one
