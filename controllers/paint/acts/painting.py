"""Painting the own strip, and looking for robots that were never seen when that is done."""

from __future__ import annotations

import math

from ..brain import Brain, Command
from ..constants import APART
from ..memory import Phase
from ..moves import look
from ..moves.room import STAND_KEEP, free_travel
from ..moves.twist import drive
from .speak import fail, say
from .turning import side_gaze, turning

CROWD = 6
"""Of more robots than this, some may always be hidden: not to have seen them is no failure, as long
as they are fewer than half, nor is to have taken two sightings of one for two, once the own rank is
known."""

STALLED = 300.0
"""Who paints and has not moved for so long (s) gives up: it is not of those that wait for others,
but a body in its strip that will not go, or a drive that does not do what it is told."""

COUNTING = 60.0
"""For so long (s) a robot that has painted looks for robots that it never saw."""


def paint(brain: Brain, command: Command) -> None:
    """Follow the lanes; the sprayer is on from the first lane's beginning to the last one's end."""
    memory, pose, limits = brain.memory, brain.pose, brain.settings.limits
    way = memory.way
    while way and math.dist(pose[:2], way[0]) < 0.02:
        way.pop(0)
        memory.spraying = True
    if brain.moving:
        memory.moved_at = brain.time
    elif brain.time - memory.moved_at > STALLED:
        fail(brain, command, "I cannot go on painting: something is in my way, or my drive")
        return
    if not way:
        memory.phase = Phase.COUNTING
        memory.counting_since = brain.time
        command.report["done_time"] = round(brain.time, 3)
        count(brain, command)
        return
    travel = free_travel(brain.region, pose, way[0], memory.tracks.all, brain.time, keep=STAND_KEEP)
    command.spray = memory.spraying
    command.motion = drive(pose, way[0], travel, limits, 0.3)


def count(brain: Brain, command: Command) -> None:
    """After painting: say "done" if all the robots that it was told of were ever seen.

    As the order never changes, the most that were ever seen above and below at one time are
    different robots. Where some were not, it looks for them for a while, as it stands in strips too
    low to turn in: with a wrong number the robots' strips do not make up the region, and nobody
    must take it for painted.
    """
    memory, robots = brain.memory, brain.settings.robots
    seen = sum(memory.most)
    if seen >= robots - 1:
        memory.phase = Phase.DONE
        more = f"; I saw {brain.seen} robots, not {robots}" if seen >= robots else ""
        say(brain, command, f"done{more}")
        command.finished = True
        return
    low, high = brain.task.strip
    # Neighbours whose lanes are nearer to each other could not turn at the same time.
    roomy = min(high - low, brain.settings.sprayer[1]) >= APART
    looking = roomy or robots <= CROWD
    if looking and brain.time - memory.counting_since < COUNTING:
        missing = robots - 1 - seen
        say(brain, command, f"painted; looking for the robots that I never saw, {missing}")
        if roomy:
            _look_around(brain, command)
    elif robots > CROWD and 2 * brain.seen > robots:
        memory.phase = Phase.DONE
        say(brain, command, f"done; of {robots} robots I saw {brain.seen}")
        command.finished = True
    else:
        told = f"I never saw more than {brain.seen} of the {robots} robots; told wrong?"
        fail(brain, command, told)


def _look_around(brain: Brain, command: Command) -> None:
    gaze = side_gaze(brain)
    if gaze is None:
        gaze = (look.LEFT, look.RIGHT)[int(brain.time / look.LOOKING) % 2]
    turning(brain, command, gaze)
