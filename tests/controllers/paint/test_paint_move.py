"""Where a robot may turn, and where to it may step along its row."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from controllers.paint.constants import HALF, WALL_ROOM
from controllers.paint.geometry import Pose, rectangle
from controllers.paint.moves.look import row_places
from controllers.paint.moves.room import Near, can_turn, may_turn
from controllers.paint.sight.tracks import Track
from troupe.testing.outlines import separation
from troupe.testing.paint.bench import SQUARE

ROOM = rectangle(16.0, 21.0)  # its corners are (0, 0) and (16, 21)
TURNS = np.linspace(0.0, math.pi / 2, 46)  # of a square all there are, each 2 degrees


def _out_of_view(x: float, y: float) -> Track:
    return Track((x, x), (y, y), seen=1.0, looks=9, sharp=True)


@given(
    st.floats(0.74, 4.0),
    st.floats(0.74, 4.0),
    st.floats(0.55, 4.0),
    st.floats(0.55, 4.0),
)
@example(1.22, 3.18, 0.6, 2.02)  # its corner is nearer than its face
def test_who_may_turn_hits_nobody_that_is_out_of_view(
    x: float, y: float, other_x: float, other_y: float
) -> None:
    track = _out_of_view(other_x, other_y)
    if not may_turn(ROOM, Pose(x, y, 0.0), [track], 1.5, Near(math.inf, math.inf)):
        return
    others = TURNS if can_turn(ROOM, other_x, other_y) else np.zeros(1)
    own, heading = (turns.ravel() for turns in np.meshgrid(TURNS, others))
    one = np.column_stack([np.full(len(own), x), np.full(len(own), y), own])
    other = np.column_stack([np.full(len(own), other_x), np.full(len(own), other_y), heading])
    assert separation(SQUARE, one, SQUARE, other).min() >= 0.0


@given(st.floats(HALF + 0.01, 15.49))
def test_from_anywhere_on_an_empty_row_all_of_it_can_be_stepped_to(x: float) -> None:
    places = row_places(ROOM, Pose(x, 10.0, 0.0), [], 0.0)
    assert places[0] == x
    assert min(places) <= WALL_ROOM + 1e-9
    assert max(places) >= 16.0 - WALL_ROOM - 1e-9
    gaps = np.diff(sorted(places))
    assert gaps.max() <= 0.5 + 1e-9


def test_nobody_steps_past_a_robot_on_its_row() -> None:
    places = row_places(ROOM, Pose(5.0, 10.0, 0.0), [_out_of_view(9.0, 10.2)], 1.0)
    assert max(places) < 9.0 - 1.5
    assert min(places) <= WALL_ROOM + 1e-9
