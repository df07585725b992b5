"""Where robots start: never overlapping, by the seed alone, and a clear mistake if they cannot."""

from __future__ import annotations

import math
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stage_worlds import corners, overlap, robot, world

from sim.stage.layout import build_layout
from sim.stage.placement import check_start, place, spaced
from sim.worldfile.mistakes import Mistake, WorldError
from sim.worldfile.robots import expanded

OBSTACLES = [
    {"shape": "box", "size": (1, 3), "pose": (5, 5, 20)},
    {"shape": "circle", "radius": 0.6, "pose": (8, 2, 0), "movable": True},
]


def poses_of(run_seed: int = 1, **keys: Any) -> tuple[np.ndarray, Any, list[np.ndarray]]:
    """Start poses, the layout, and the robots' outlines."""
    keys.setdefault("models", {"a": robot(), "b": robot("circle"), "c": robot("polygon")})
    made = world(**keys)
    layout = build_layout(made, Path())
    robots = expanded(enumerate(made.robots))
    poses = place(layout, robots, made.models, run_seed)
    outlines = [
        corners(made.models[spec.model].body, pose)
        for spec, pose in zip(robots, poses, strict=True)
    ]
    return poses, layout, outlines


def apart(one: np.ndarray, two: np.ndarray, margin: float) -> bool:
    """Whether an outline may be shifted by a margin in 8 directions without an overlap."""
    turns = np.arange(8) * math.tau / 8
    ways = margin * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    return all(overlap(one + way, two) == 0.0 for way in ways)


@settings(max_examples=25)
@given(seed=st.integers(0, 10**6), count=st.integers(1, 12), shape=st.sampled_from("abc"))
def test_random_placements_overlap_nothing(seed: int, count: int, shape: str) -> None:
    robots = [
        {"model": "a", "pose": (1, 1, 45)},
        {"model": shape, "count": count, "placement": "random"},
        {"model": "b", "count": 3, "placement": {"margin": 0.3}},
    ]
    poses, layout, outlines = poses_of(seed, robots=robots, obstacles=OBSTACLES)
    assert poses[0] == pytest.approx([1, 1, math.pi / 4])
    standing = [*(solid.vertices for solid in layout.solids), *layout.obstacles]
    for index, outline in enumerate(outlines):
        for other in [*outlines[:index], *standing]:
            assert overlap(outline, other) == 0.0
        assert outline.min() > 0
        assert outline.max() < 10


@settings(max_examples=8)
@given(seed=st.integers(0, 10**6), margin=st.floats(0.0, 0.6))
def test_a_margin_is_kept_to_everything(seed: int, margin: float) -> None:
    robots = [{"model": "b", "count": 6, "placement": {"margin": margin}}]
    _, layout, outlines = poses_of(seed, robots=robots, obstacles=OBSTACLES)
    standing = [*(solid.vertices for solid in layout.solids), *layout.obstacles]
    for index, outline in enumerate(outlines):
        for other in [*outlines[:index], *standing]:
            # 2 mm: placement takes a circle for a polygon of its area, the test for one within.
            assert apart(outline, other, max(0.0, margin - 0.002))


@settings(max_examples=20)
@given(seed=st.integers(0, 10**6))
def test_headings_are_drawn_from_their_set(seed: int) -> None:
    robots = [{"model": "a", "count": 8, "placement": "random", "headings": (0, 180)}]
    poses, _, _ = poses_of(seed, robots=robots)
    assert set(np.round(poses[:, 2], 12)) <= {0.0, round(math.pi, 12)}


@settings(max_examples=20)
@given(seed=st.integers(0, 10**6), count=st.integers(1, 7))
def test_robots_on_one_line_share_their_y(seed: int, count: int) -> None:
    rule = {"same_y": True, "margin": 0.4}
    robots = [{"model": "a", "count": count, "placement": rule, "headings": (0, 90, 180)}]
    poses, layout, outlines = poses_of(seed, robots=robots, obstacles=OBSTACLES)
    assert len(set(poses[:, 1])) == 1
    standing = [*(solid.vertices for solid in layout.solids), *layout.obstacles]
    for index, outline in enumerate(outlines):
        for other in [*outlines[:index], *standing]:
            assert apart(outline, other, 0.399)


@pytest.mark.parametrize("same_y", [True, False])
def test_headings_in_turn_are_given_out_evenly_from_any_on(same_y: bool) -> None:
    rule = {"same_y": same_y, "margin": 0.4, "in_turn": True}
    robots = [{"model": "a", "count": 4, "placement": rule, "headings": (0, 180)}]
    firsts = set()
    for seed in range(20):
        yaws = np.round(np.degrees(poses_of(seed, robots=robots)[0][:, 2])).tolist()
        assert yaws in ([0, 180, 0, 180], [180, 0, 180, 0])
        firsts.add(yaws[0])
    assert firsts == {0, 180}


def test_lines_and_orders_differ_from_seed_to_seed() -> None:
    robots = [{"model": "a", "count": 4, "placement": {"same_y": True}}]
    found = [poses_of(seed, robots=robots)[0] for seed in range(20)]
    assert len({poses[0, 1] for poses in found}) == 20
    assert len({tuple(np.argsort(poses[:, 0])) for poses in found}) > 5


def test_a_placement_depends_on_the_seed_and_the_entries_alone() -> None:
    robots = [{"model": "a", "count": 5, "placement": "random"}]
    first, _, _ = poses_of(7, robots=robots)
    again, _, _ = poses_of(7, robots=robots, name="other", duration=1.0, seed=99)
    other, _, _ = poses_of(8, robots=robots)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


REGION = ((2.0, 1.0), (8.0, 1.5), (9.0, 6.0), (5.0, 9.0))


@settings(max_examples=20)
@given(seed=st.integers(0, 10**6), shape=st.sampled_from(["size", "region"]))
def test_robots_are_placed_within_the_region(seed: int, shape: str) -> None:
    robots = [{"model": "a", "count": 10, "placement": "random"}]
    _, _, outlines = poses_of(seed, robots=robots, region=REGION, boundary={"shape": shape})
    region = np.array(REGION)
    for outline in outlines:
        for start, end in zip(region, np.roll(region, -1, axis=0), strict=True):
            (dx, dy), away = end - start, outline - start
            assert (dx * away[:, 1] - dy * away[:, 0]).min() > 0.0


def test_a_world_that_is_just_full_is_filled() -> None:
    models = {"a": robot(size=(1.0, 1.0))}
    entry = {"model": "a", "count": 81, "placement": "random", "headings": (0,)}
    poses, _, _ = poses_of(robots=[entry], models=models)
    # 9 x 9 robots of 1 m with ten margins of 0.1 m on 10 m: there is one way to place them.
    assert sorted(set(np.round(poses[:, 0], 6))) == pytest.approx(0.6 + 1.1 * np.arange(9))


@pytest.mark.parametrize(
    "entry",
    [
        {"model": "a", "count": 400, "placement": "random"},
        {"model": "a", "count": 16, "placement": {"same_y": True, "margin": 0.2}, "headings": (0,)},
        {"model": "a", "placement": {"margin": 6.0}},
    ],
)
def test_robots_that_cannot_fit_are_a_mistake_of_their_entry(entry: Any) -> None:
    with pytest.raises(WorldError, match="do not fit") as caught:
        poses_of(robots=[{"model": "b", "pose": (1, 1, 0)}, entry])
    (mistake,) = caught.value.mistakes
    assert mistake.where == ("robots", 1)


def test_robots_stay_out_of_the_way_of_doors() -> None:
    door = {"name": "s", "at": (5.0, 5.0), "model": "a", "period": 4.0}
    for seed in range(10):
        robots = [{"model": "a", "count": 40, "placement": "random"}]
        _, layout, outlines = poses_of(seed, robots=robots, doors=[door])
        assert all(overlap(outline, layout.doors[0].rectangle) == 0.0 for outline in outlines)


def mistakes_of(robots: Any, **keys: Any) -> list[Mistake]:
    made = world(models={"a": robot(), "b": robot("circle")}, robots=robots, **keys)
    return check_start(build_layout(made, Path()), expanded(enumerate(made.robots)), made.models)


def test_robots_that_start_in_walls_or_each_other_are_mistakes() -> None:
    found = mistakes_of(
        [
            {"model": "a", "pose": (5, 5, 20)},  # in the box
            {"model": "a", "pose": (2, 2, 0)},
            {"model": "b", "name": "two", "pose": (2.3, 2.1, 0)},  # in the one before
            {"model": "a", "pose": (0.1, 8, 0)},  # in the boundary
            {"model": "a", "pose": (30, 8, 0)},  # off the world
            {"model": "b", "pose": (8, 2, 0)},  # in the movable circle
            {"model": "a", "pose": (2.5, 8, 0)},
        ],
        obstacles=OBSTACLES,
    )
    assert [mistake.where[1] for mistake in found] == [0, 2, 3, 4, 5]
    assert "in robot a2" in found[1].what
    assert "outside" in found[3].what


def test_to_touch_at_the_start_is_no_mistake() -> None:
    assert not mistakes_of(
        [{"model": "a", "pose": (0.25, 5, 0)}, {"model": "a", "pose": (0.75, 5, 180)}]
    )


@settings(deadline=None)
@given(
    first=st.floats(-100, 100),
    extent=st.floats(-1, 50),
    step=st.floats(0.01, 5),
)
def test_a_lattice_is_spaced_as_numpy_would_do_it(first: float, extent: float, step: float) -> None:
    last = first + extent
    assert list(spaced(first, last, step)) == np.arange(first, last + 1e-9, step).tolist()


def test_a_lattice_of_billions_of_places_needs_no_room() -> None:
    assert list(islice(spaced(0.0, 1e9, 0.1), 3)) == [0.0, 0.1, 0.2]
