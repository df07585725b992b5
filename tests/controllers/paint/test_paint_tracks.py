"""Robots followed from scan to scan: never more are counted than there are."""

from __future__ import annotations

import itertools

from hypothesis import given
from hypothesis import strategies as st

from controllers.paint.sight.pairing import paired, swapped
from controllers.paint.sight.squares import Square
from controllers.paint.sight.tracks import STANDING, Tracks

SPEED = 0.5


def _square(x: float, y: float, vague: float = 0.0, certain: bool = True) -> Square:
    return Square((x - vague, x + vague), (y - vague, y + vague), True, certain, 0.0)


def _followed(*scans: list[Square]) -> Tracks:
    tracks = Tracks(0.5)
    for k, squares in enumerate(scans):
        tracks.update(squares, 0.1 * k, 0.0)
    tracks.tell_apart()
    return tracks


def test_two_tracks_nearer_than_two_bodies_can_be_count_as_one() -> None:
    seen = [_square(3.0, 2.0), _square(3.3, 2.55)]
    tracks = _followed(seen, seen, seen, seen)
    assert len(tracks.sure) == 1
    assert len(tracks.doubtful) == 1
    seen = [_square(3.0, 2.0), _square(3.0, 3.05)]
    tracks = _followed(seen, seen, seen, seen)
    assert len(tracks.sure) == 2


def test_a_sliver_never_takes_the_track_of_a_robot_in_full_view() -> None:
    robot, sliver = _square(-6.6, -0.6), _square(-5.3, 0.0, 0.7, certain=False)
    tracks = _followed([robot], [robot], [robot], [sliver, robot], [sliver, robot])
    (track,) = tracks.sure
    assert track.centre == (-6.6, -0.6)
    assert len(tracks.all) == 2
    assert not tracks.all[1].confirmed  # slivers do not count, however often they are seen


def test_who_was_taken_for_another_out_of_view_is_not_counted_twice() -> None:
    # Two robots go 2.9 m to the right while nobody looks. The first that is seen again is nearer to
    # where the second was; when the second is seen, where it was taken from must not make a third.
    tracks = Tracks(SPEED)
    lower, upper = (1.94, -2.8), (2.99, -1.24)
    for k in range(4):
        tracks.update([_square(*lower), _square(*upper)], 0.1 * k, 0.0)
    time = 0.3 + 2.9 / SPEED
    tracks.update([_square(lower[0] + 2.9, lower[1])], time, 0.0)
    for k in range(1, 6):
        both = [_square(lower[0] + 2.9, lower[1]), _square(upper[0] + 2.9, upper[1])]
        tracks.update(both, time + 0.1 * k, 0.0)
    tracks.tell_apart()
    assert len(tracks.sure) == 2


def test_a_robot_crosses_while_it_goes_along_its_row_and_a_little_longer() -> None:
    tracks = Tracks(SPEED)
    for k in range(11):
        tracks.update([_square(3.0 + 0.05 * k, 2.0)], 0.1 * k, 0.0)
    assert tracks.all[0].crosses(1.0)
    for k in range(11, 12 + int(STANDING / 0.1)):
        tracks.update([_square(3.5, 2.0)], 0.1 * k, 0.0)
    assert not tracks.all[0].crosses(1.1 + STANDING)
    for k in range(10):
        time = 1.2 + STANDING + 0.1 * k
        tracks.update([_square(3.5, 2.0 + 0.05 * k)], time, 0.0)
    assert not tracks.all[0].crosses(time)


@given(
    st.lists(st.lists(st.integers(0, 4), unique=True, max_size=4), max_size=5),
)
def test_as_many_sightings_are_paired_as_can_be(options: list[list[int]]) -> None:
    pairs = paired(options, [True] * len(options))
    assert len(set(pairs.values())) == len(pairs)
    assert all(i in options[j] for j, i in pairs.items())
    choices = itertools.product(*([None, *robots] for robots in options))
    used = ([i for i in choice if i is not None] for choice in choices)
    assert len(pairs) == max(len(robots) for robots in used if len(set(robots)) == len(robots))


@given(
    st.lists(st.lists(st.integers(0, 4), unique=True, max_size=4), max_size=5),
)
def test_swapped_are_those_that_another_pairing_as_large_leaves_out(
    options: list[list[int]],
) -> None:
    pairs = paired(options, [True] * len(options))
    for robot in set(range(5)).difference(pairs.values()):
        others = set()
        known = {robot, *pairs.values()}
        for choice in itertools.product(*(options[j] for j in pairs)):
            if len(set(choice)) == len(choice) and robot in choice and known.issuperset(choice):
                others |= known.difference(choice)
        assert swapped(robot, options, pairs) == others
