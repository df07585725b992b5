"""From a rank to a task: the strip, and the goal in its lower left corner."""

from __future__ import annotations

from .compute import Task, strip_of
from .constants import EPSILON, HALF, INSET
from .geometry import Region

REACHED = 0.02
"""A robot this near to its goal's height makes the rest of it on the horizontal leg (m)."""

_FITS = HALF  # m: half of what a body needs at its goal; the lowest strips leave no more
_STEP = 0.05


def goal_in(region: Region, strip: tuple[float, float]) -> tuple[float, float]:
    """The goal: the strip's lower left corner, INSET inside in both axes [3.1 Step 2, Move].

    Where strips are so low that goals would come nearer than EPSILON it is half a strip's height.

    In a region whose edges are slanted the corner is where a body fits farthest left at that
    height, as far off the edge as in a rectangle; where none fits there (an apex), at the nearest
    height of the strip where one does.

    Raises:
        ValueError: no body fits into the strip.
    """
    low, high = strip
    steps = max(1, int((high - low) / _STEP))
    apart = 2 * (high - low - INSET)  # an N robot's goal from a P robot's in the strip below
    inset = INSET if apart > EPSILON else 0.5 * (high - low)
    heights = [low + inset, *(low + (high - low) * i / steps for i in range(steps + 1))]
    heights = [heights[0], *sorted(heights[1:], key=lambda y: abs(y - heights[0]))]
    for y in heights:
        room = region.standing_room(y, _FITS)
        if room is not None:
            return min(room[0] + INSET - _FITS, 0.5 * (room[0] + room[1])), y
    raise ValueError(f"no body fits into the strip from {low:.2f} m to {high:.2f} m")


def task_of(region: Region, rank: int, robots: int, sprayer_width: float) -> Task:
    """What a robot of that rank has to do, in its own frame."""
    strip = strip_of(rank, robots, region.bottom, region.top)
    lane = min(sprayer_width / 2, 0.5 * (strip[1] - strip[0]))
    return Task(
        strip=strip,
        goal=goal_in(region, strip),
        clearance=EPSILON - 0.05,  # halts are at EPSILON, give or take what braking takes
        margin=max(0.0, 2 * HALF + 0.1 - lane),
        reached=REACHED,
    )
