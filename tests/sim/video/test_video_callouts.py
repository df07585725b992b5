"""Names and balloons: beside their robots, not on each other and over nobody's body."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.video.callouts import CROWD, SHORT, Callout, named, place_callouts, speakers
from sim.video.snapshot import Snapshot
from sim.video.text import LONGEST, Lettering

FIELD = (640, 814)
RADIUS = 20.0

places = st.lists(st.tuples(st.integers(0, 639), st.integers(0, 813)), max_size=20)


def boxes(centres: list[tuple[int, int]]) -> np.ndarray:
    middle = np.array(centres, float).reshape(-1, 2)
    return np.concatenate([middle - RADIUS, middle + RADIUS], axis=1)


def callouts(centres: list[tuple[int, int]], unit: float = 1.0) -> list[Callout]:
    """All robots have names and say something."""
    count = len(centres)
    names = [f"painter{k}" for k in range(count)]
    said = [(k, "settled in step 62") for k in range(count)]
    bodies = boxes(centres)
    return place_callouts(names, said, bodies, [RADIUS] * count, FIELD, Lettering(unit))


def apart(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    """Whether two boxes (left, top, right, bottom) share no pixel."""
    return a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]


def edges(callout: Callout) -> tuple[int, int, int, int]:
    left, top, width, height = callout.box
    return left, top, left + width, top + height


@settings(deadline=None)
@given(places, st.sampled_from([1.0, 1.5]))
def test_no_two_texts_lie_on_each_other(centres: list[tuple[int, int]], unit: float) -> None:
    for one, other in combinations(callouts(centres, unit), 2):
        assert apart(edges(one), edges(other))


@settings(deadline=None)
@given(places)
def test_every_text_lies_inside_the_field(centres: list[tuple[int, int]]) -> None:
    for left, top, right, bottom in map(edges, callouts(centres)):
        assert left >= 0
        assert top >= 0
        assert right <= FIELD[0]
        assert bottom <= FIELD[1]


@settings(deadline=None)
@given(places)
def test_a_balloon_covers_no_body_and_a_name_at_most_an_edge(
    centres: list[tuple[int, int]],
) -> None:
    for callout in callouts(centres):
        left, top, right, bottom = edges(callout)
        slack = 0 if callout.kind == "balloon" else 0.16 * (bottom - top)
        for body in boxes(centres).tolist():
            assert apart((left, top + slack, right, bottom - slack), tuple(body))


def test_where_there_is_room_all_is_shown() -> None:
    centres = [(100 + 150 * (k % 4), 100 + 150 * (k // 4)) for k in range(16)]
    shown = callouts(centres)
    assert sorted(callout.robot for callout in shown if callout.kind == "name") == list(range(16))
    assert sorted(callout.robot for callout in shown if callout.kind == "balloon") == list(
        range(16)
    )


def test_where_there_is_none_the_latest_is_heard_first() -> None:
    said = [(0, "first"), (1, "second")]
    bodies = boxes([(50, 30), (50, 80)])
    shown = place_callouts([], said, bodies, [RADIUS] * 2, (100, 104), Lettering())
    assert [callout.text for callout in shown] in ([], ["second"])


def test_a_balloon_points_into_its_own_body() -> None:
    centres = [(320, 400), (320, 350), (20, 30), (620, 790)]
    for callout in callouts(centres):
        if callout.kind == "balloon":
            left, top, right, bottom = boxes(centres)[callout.robot]
            assert left < callout.tip[0] < right
            assert top < callout.tip[1] < bottom


@pytest.mark.parametrize(("robots", "longest"), [(CROWD, LONGEST), (CROWD + 1, SHORT)])
def test_what_is_said_in_a_crowd_is_cut_shorter(robots: int, longest: int) -> None:
    bodies = boxes([(100 + 60 * k, 700) for k in range(robots)])
    said = [(0, "waiting for the robot below me to go away from where I am")]
    (balloon,) = place_callouts([], said, bodies, [RADIUS] * robots, FIELD, Lettering())
    assert balloon.text.endswith("...")
    assert len(balloon.text) <= longest


def test_what_was_said_long_ago_is_not_heard() -> None:
    snapshot = Snapshot(
        100.0, np.zeros((3, 3)), [0] * 3, said=["a", "b", ""], said_at=[99.0, 50.0, 0.0]
    )
    assert speakers(snapshot, 30.0) == [(0, "a")]
    assert speakers(snapshot, 60.0) == [(1, "b"), (0, "a")]


def test_small_robots_and_crowds_are_not_named() -> None:
    assert named(["a"] * 3, [2.0] * 3) == ["a"] * 3
    assert named(["a"] * 30, [2.0] * 29 + [9.0]) == [""] * 29 + ["a"]
    assert named(["a"] * 100, [9.0] * 100) == []
