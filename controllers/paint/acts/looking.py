"""Before the rank is known: searching the walls, and looking around from where it sees most."""

from __future__ import annotations

import math

from ..brain import Brain, Command
from ..constants import APART
from ..moves import look
from ..moves.room import free_travel, may_turn
from ..moves.twist import drive, looks_at, turn
from ..sight.scan import Scan
from . import nearing
from .poring import fine_look
from .speak import fail, say

NO_FIT = (
    "the walls do not fit the arena's shape that I was told, as I stand or turned by 180 degrees"
)


def search_walls(brain: Brain, scan: Scan, command: Command) -> None:
    """Turn until enough of the walls has been seen to know where they are."""
    say(brain, command, "looking for the walls")
    memory = brain.memory
    if brain.time - memory.began > 60.0:
        fail(brain, command, NO_FIT)
        return
    if brain.time - memory.began > 0.5 and float(scan.ranges.min()) > 0.75:
        memory.gaze += 0.0 if not looks_at(brain.pose, memory.gaze) else math.pi / 2
        command.motion = turn(brain.pose, memory.gaze, brain.settings.limits)


def look_around(brain: Brain, command: Command, new_cycle: bool) -> None:
    """Look around, and step aside where looking alone does not tell the rank."""
    memory, pose, limits = brain.memory, brain.pose, brain.settings.limits
    region = brain.region
    tracks = memory.tracks.all
    low, high = memory.bounds.below
    say(brain, command, f"observing: {low} to {high} robots are below me")
    if memory.nearing:
        nearing.go_on(brain, command)
        return
    if memory.step_to is not None:
        target = (memory.step_to, memory.row)
        direction = look.RIGHT if target[0] > pose.x else look.LEFT
        far = not looks_at(pose, direction) and abs(target[0] - pose.x) > 0.3
        if far and may_turn(region, pose, tracks, brain.time, brain.nearest):
            command.motion = turn(pose, direction, limits)
            return  # where there is no room to turn, it slides to where it knows nobody to be
        travel = free_travel(region, pose, target, tracks, brain.time, keep=APART)
        if travel < 0.05 or row_hidden(brain, direction):
            memory.step_to = None
            return
        command.motion = drive(pose, target, travel, limits, 0.4)
        return
    if not looks_at(pose, memory.gaze):
        if may_turn(region, pose, tracks, brain.time, brain.nearest):
            command.motion = turn(pose, memory.gaze, limits)
            memory.gaze_until = brain.time + look.DWELL
        elif new_cycle:
            memory.gaze = pose.yaw
        return
    if brain.time < memory.gaze_until or not new_cycle:
        return
    if fine_look(brain, command):
        return
    memory.looks += 1
    if nearing.begin(brain):
        return
    if memory.looks % 3 == 0:
        xs = look.row_places(region, pose, tracks, brain.time)
        if not may_turn(region, pose, tracks, brain.time, brain.nearest):
            shut = [row_hidden(brain, side) for side in (look.LEFT, look.RIGHT)]
            xs = [x for x in xs if x == pose.x or not shut[x > pose.x]]
        memory.step_to = look.step_for_view(
            pose, xs, tracks, brain.shadows, (True, True), brain.draw()
        )
        if memory.step_to is not None:
            return
    memory.gaze = look.DOWN if math.sin(memory.gaze) > 0.0 else look.UP
    if memory.looks > look.PLAIN_LOOKS:
        memory.gaze += (brain.draw() - 0.5) * brain.spacing


def row_hidden(brain: Brain, direction: float) -> bool:
    """Whether an unseen robot could be on the row just ahead, left or right."""
    x, y = brain.pose.x, brain.pose.y
    ahead = (x, x + 1.6) if direction == look.RIGHT else (x - 1.6, x)
    return brain.shadows.any_in(*ahead, y - 1.0, y + 1.0)
