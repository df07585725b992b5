"""Robots on one line: who stays hidden behind a robot at the own height.

Where three bodies stand on one line, the outer two can never see each other, wherever on their
rows they go: what they differ in height by is less than what the middle one hides. The paper
leaves out more than two on a line [5]. Here the outer ones, once they have looked from many places
for long, take who is hidden behind a level robot to be level as well, and x decides, as for any tie
[3.1 Step 1]. This is the one place where a robot takes for true what it has not seen: a hidden
robot a little higher or lower would be taken for level. A robot between two others on a line
cannot tell how many are hidden on which side: it waits until the outer ones have gone.
"""

from __future__ import annotations

import numpy as np

from .brain import Brain
from .compute import Side
from .constants import BODY, HALF
from .geometry import Floats
from .memory import Phase
from .sight.shadows import Mask
from .sight.tracks import Track

LONG = 120.0
"""So long (s) what is known must not have changed."""

_RECENT = 5.0  # s: a look both ways takes less
_STRAYED = 1.2  # m: as far as a shadow spreads between two looks


def hidden_on_line(brain: Brain) -> bool | None:
    """Whether all unseen robots are above (true) or below (false), on a line; None if open."""
    memory, pose = brain.memory, brain.pose
    followed = memory.tracks.sure
    state = (memory.bounds.above, memory.bounds.below)
    if state != memory.known:
        memory.known, memory.known_since = state, brain.time
    if memory.phase is not Phase.OBSERVING or brain.time - memory.known_since < LONG:
        return None
    if any(track.side is Side.UNSURE for track in followed):
        return None
    places = brain.shadows.places()
    verdicts: set[bool] = set()
    open_ = np.ones(len(places), bool)
    for track in followed:
        if track.side is not Side.LEVEL or brain.time - track.seen > _RECENT:
            continue
        behind = _behind(track, places, pose.x, pose.y)
        if (behind & open_).any():
            verdicts.add(track.centre[0] > pose.x)
        open_ &= ~behind
    if open_.any() or len(verdicts) != 1:
        return None
    return verdicts.pop()


def _behind(track: Track, places: Floats, x: float, y: float) -> Mask:
    """Which places (n, 2) lie in the shadow of a robot on the row, or near that shadow."""
    side = 1.0 if track.centre[0] > x else -1.0
    distance = max(side * (track.centre[0] - x) - HALF, HALF)
    ahead = side * (places[:, 0] - x)
    width = HALF * ahead / distance
    inside: Mask = (ahead > distance + BODY - _STRAYED) & (
        np.abs(places[:, 1] - y) < width + _STRAYED
    )
    return inside
