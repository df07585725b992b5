"""Paint's parts: bounds on the rank, shadows, lanes, options."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.paint.boustrophedon import lanes
from controllers.paint.compute import crowded_strip
from controllers.paint.constants import HALF, OVERLAP, SPRAYER
from controllers.paint.geometry import Region, rectangle
from controllers.paint.options import parse
from controllers.paint.sight.ranking import RankBounds
from controllers.paint.sight.shadows import CELL, Shadows
from tests.processes import ROOT

CONVEX = Region(np.array([[3, 0.5], [13, 0.5], [15.5, 9], [13, 20.5], [5, 20.5], [0.5, 12.0]]))


@given(st.data())
def test_bounds_on_the_rank_always_hold_the_true_rank(data: st.DataObject) -> None:
    robots = data.draw(st.integers(1, 19))
    below = data.draw(st.integers(0, robots - 1))
    above = robots - 1 - below
    bounds = RankBounds.unknown(robots)
    for _ in range(data.draw(st.integers(1, 8))):
        seen_above, seen_below = data.draw(st.integers(0, above)), data.draw(st.integers(0, below))
        unsure = data.draw(st.integers(0, robots - 1 - seen_above - seen_below))
        hidden = robots - 1 - seen_above - seen_below - unsure
        unsure_above = min(unsure, above - seen_above)
        room_above = above - seen_above - unsure_above + data.draw(st.integers(0, 3))
        room_below = min(hidden, below - seen_below) + data.draw(st.integers(0, 3))
        room_above = max(room_above, min(hidden, above - seen_above))
        assert bounds.narrow(seen_above, seen_below, unsure, room_above, room_below) is None
        assert bounds.above[0] <= above <= bounds.above[1]
        assert bounds.below[0] <= below <= bounds.below[1]
        assert bounds.rank in (None, below + 1)


def test_more_robots_than_told_contradict_the_number_and_change_nothing() -> None:
    bounds = RankBounds.unknown(4)
    assert bounds.narrow(2, 2, 0, 0, 0) == "there are at least 5 robots, not 4"
    assert bounds.narrow(1, 1, 0, 0, 0) == "there are at most 3 robots, not 4"
    assert (bounds.above, bounds.below) == ((0, 3), (0, 3))


def test_nobody_unseen_crosses_the_row_of_a_robot_that_stays_on_it() -> None:
    region = rectangle(16.0, 21.0).moved(np.array([-8.0, -10.0]))
    shadows = Shadows(region, 0.5)
    shadows.possible[shadows.y > 0.0] = False
    shadows.spread(60.0)
    assert not shadows.possible[shadows.y > 0.0].any()
    assert shadows.room_above(0.0) == 0
    assert shadows.room_below(0.0) > 0
    shadows.on_row = False
    shadows.spread(62.0)  # 2 s at 0.5 m/s are 1 m, and up to one cell ahead of time
    reached = shadows.y[shadows.possible.any(axis=1)].max()
    assert 1.0 - CELL <= reached <= 1.0 + CELL


def test_nobody_unseen_crosses_the_row_when_it_moves() -> None:
    region = rectangle(16.0, 21.0).moved(np.array([-8.0, -10.0]))
    shadows = Shadows(region, 0.5)
    shadows.possible[(shadows.y > 0.0) & (shadows.y < 3.0)] = False  # who is above is far up
    for k in range(41):  # 2 m up, at 0.5 m/s, seen free
        shadows.move_row(0.05 * k)
        shadows.possible[(shadows.y > 0.05 * k) & (shadows.y < 3.0)] = False
        shadows.spread(0.1 * k)
    assert shadows.room_above(2.0) > 0
    below = shadows.possible[shadows.y < 2.0]
    assert below.any()
    shadows.possible[shadows.y > 2.0] = False
    shadows.spread(60.0)
    assert shadows.room_above(2.0) == 0  # those below stay below


@pytest.mark.parametrize(
    ("heights", "strip"),
    [([1.0, 6.0, 12.0, 17.0], None), ([1.0, 5.24, 12.0], 1), ([1.0, 5.26, 12.0], None)],
)
def test_a_strip_is_crowded_where_two_robots_are_in_it(
    heights: list[float], strip: int | None
) -> None:
    assert crowded_strip(heights, 4, 0.0, 21.0) == strip
    shifted = [y - 7.0 for y in heights]
    assert crowded_strip(shifted, 4, -7.0, 14.0) == strip


@given(st.floats(1.0, 15.0), st.floats(1.0, 20.0), st.floats(0.0, math.tau), st.floats(0.0, 10.0))
def test_who_drives_at_full_speed_never_leaves_the_places_where_it_may_be(
    x: float, y: float, heading: float, seconds: float
) -> None:
    shadows = Shadows(rectangle(16.0, 21.0), 0.5)
    shadows.on_row = False
    shadows.possible[:] = False
    shadows.admit(x, y, 0.01)
    for k in range(1, int(seconds * 10) + 1):
        shadows.spread(0.1 * k)
    travel = 0.5 * 0.1 * int(seconds * 10)
    ex, ey = x + travel * math.cos(heading), y + travel * math.sin(heading)
    if HALF <= ex <= 16.0 - HALF and HALF <= ey <= 21.0 - HALF:
        assert shadows.any_in(ex - 1e-6, ex + 1e-6, ey - 1e-6, ey + 1e-6)


@pytest.mark.parametrize("robots", [1, 3, 4, 8, 12, 16, 19])
@pytest.mark.parametrize("region", [rectangle(16.0, 21.0), CONVEX], ids=["rectangle", "convex"])
def test_on_every_lane_the_body_stays_inside_and_paints_its_own_strip(
    region: Region, robots: int
) -> None:
    height = (region.top - region.bottom) / robots
    for rank in range(1, robots + 1):
        strip = region.bottom + (rank - 1) * height, region.bottom + rank * height
        way = lanes(region, strip, SPRAYER)
        assert way
        for x, y in way:
            corners = np.array([[x + a, y + b] for a in (-HALF, HALF) for b in (-HALF, HALF)])
            assert region.depth(corners).min() > 0.0
            if height >= SPRAYER[1]:
                outside = max(strip[0] - (y - SPRAYER[1] / 2), y + SPRAYER[1] / 2 - strip[1])
                assert outside <= OVERLAP + 1e-9


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--robots", "0"], "there is at least one"),
        (["--robots", "20"], "at most 19 robots"),
        (["--arena", "5"], "takes two numbers"),
        (["--arena", "16", "21", "--corners", "0,0", "1,0", "0,1"], "give one of them"),
        (["--corners", "0,0", "4,4", "4,0", "0,4"], "convex"),
        (["--corners", "3,6", "5,0", "0,4", "6,4", "1,0"], "more than once"),
        (["--jitter", "-0.1"], "at least 0"),
        (["--corners", "1;2"], "is not a corner"),
        (["--speed", "-1"], "is not a number above 0"),
    ],
)
def test_options_that_make_no_sense_are_refused_with_a_reason(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as stop:
        parse(words)
    assert stop.value.code == 2
    assert message in capsys.readouterr().err


def test_the_document_tells_all_options(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        parse(["--help"])
    options = set(re.findall(r"--[a-z-]+", capsys.readouterr().out)) - {"--help"}
    told = (ROOT / "docs" / "paint.md").read_text(encoding="utf-8")
    assert options == set(re.findall(r"`(--[a-z-]+)", told))


def test_a_sprayer_with_which_neighbours_would_touch_is_refused(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit):
        parse(["--robots", "4", "--sprayer", "1", "1"])
    assert "at least 1.11 m" in capsys.readouterr().err
    assert parse(["--robots", "1", "--sprayer", "1", "1"]).sprayer == (1.0, 1.0)
