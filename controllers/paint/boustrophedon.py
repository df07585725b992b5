"""The way over a strip: lanes back and forth, as far as the body can go.

The sprayer is larger than the body, so that lanes on which the body still has room beside a wall
reach the wall. Where the region's edge is slanted, the ends of a lane follow it: the robot goes
along the edge over the lane's breadth, and the sprayer's corner sweeps what the lane leaves bare.
The lane itself is level.
"""

from __future__ import annotations

import math

from .constants import HALF, OVERLAP
from .geometry import Region

CLEARANCE = 0.05
"""What is left between the body and a wall beside it (m)."""

_SLANTED = 0.15  # m: a lane's end that differs by more over its breadth is followed


def lane_heights(
    strip: tuple[float, float], width: float, lowest: float, highest: float
) -> list[float]:
    """The heights of the lanes, from the strip's lower border up (m).

    As few lanes as cover the strip with a sprayer of that width, evenly spaced, the outermost
    `OVERLAP` beyond the borders. No lane is below `lowest` or above `highest`, where a body
    cannot go.
    """
    bottom, top = strip
    need = top - bottom + 2.0 * OVERLAP
    count = max(1, math.ceil(need / width - 1e-9))
    if count == 1:
        heights = [0.5 * (bottom + top)]
    else:
        first, last = bottom - OVERLAP + width / 2, top + OVERLAP - width / 2
        heights = [first + (last - first) * i / (count - 1) for i in range(count)]
    return [min(max(y, lowest), highest) for y in heights]


def lanes(
    region: Region, strip: tuple[float, float], sprayer: tuple[float, float]
) -> list[tuple[float, float]]:
    """The corners (x, y) of the way over a strip, from its lower left to its last lane's end.

    `sprayer` is its length (along x) and width (m). Only points at which the body stands inside
    the region, `CLEARANCE` off its edges, are on the way.
    """
    room = HALF + CLEARANCE
    low, high = region.bottom + room, region.top - room
    heights = lane_heights(strip, sprayer[1], low, high)
    breadth = heights[1] - heights[0] if len(heights) > 1 else 0.0
    way: list[tuple[float, float]] = []
    leftwards = False
    for height in heights:
        levels = [max(heights[0], height - breadth / 2), height]
        levels.append(min(heights[-1], height + breadth / 2))
        spots = [
            (span[0], span[1], y)
            for y in levels
            if (span := _ends(region, y, room, sprayer[0])) is not None
        ]
        if spots:
            begin, end = (1, 0) if leftwards else (0, 1)
            first, last = _end_of_lane(spots, begin, height), _end_of_lane(spots, end, height)
            way += [*first, *_back(first, height), *_back(last, height), *last]
            leftwards = not leftwards
    return way


def _end_of_lane(
    spots: list[tuple[float, float, float]], side: int, height: float
) -> list[tuple[float, float]]:
    """One end of a lane: a point, or the points along a slanted edge, upwards."""
    places = [spot[side] for spot in spots]
    if max(places) - min(places) > _SLANTED:
        return [(spot[side], spot[2]) for spot in spots]
    middle = min(spots, key=lambda spot: abs(spot[2] - height))
    return [(middle[side], middle[2])]


def _back(points: list[tuple[float, float]], height: float) -> list[tuple[float, float]]:
    """The lane's own end, if its ends follow an edge: the lane itself is level."""
    return [min(points, key=lambda point: abs(point[1] - height))] if len(points) > 1 else []


def _ends(region: Region, y: float, room: float, length: float) -> tuple[float, float] | None:
    """How far left and right a body may go on a height; from an upright wall no nearer than the
    sprayer needs to reach it."""
    span = region.standing_room(y, room)
    chords = region.chord(y), region.chord(y - room), region.chord(y + room)
    if span is None or chords[0] is None or chords[1] is None or chords[2] is None:
        return None
    spare = max(0.0, length / 2 - OVERLAP - room)
    ends = [span[0], span[1]]
    for side, inwards in ((0, spare), (1, -spare)):
        if max(c[side] for c in chords if c) - min(c[side] for c in chords if c) < 0.05:
            ends[side] += inwards
    if ends[0] > ends[1]:
        return 0.5 * (span[0] + span[1]), 0.5 * (span[0] + span[1])
    return ends[0], ends[1]
