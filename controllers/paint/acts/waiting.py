"""Waiting without hiding others: looking at whom it waits for, stepping aside along its row."""

from __future__ import annotations

import math

from ..brain import Brain, Command
from ..compute import Decision, Other, Side
from ..constants import APART, BODY, HALT, WALL_ROOM
from ..moves import look
from ..moves.room import free_travel
from ..moves.twist import drive, looks_at
from .clearance import beside_limit, hidden_between, may_be_backed_into
from .poring import fine_look
from .turning import side_gaze, turning
from .yielding import OPENS, give_way

PATIENT = 8.0
"""After waiting this long (s) a robot steps aside to the wall, out of the others' view.

After each further while it steps to anywhere on its row: where it stands may be what hides two
others from each other, of whom it waits for one.
"""

MEASURED = 24.0
"""A robot that waits for one at its own height gives that one so long (s) to measure it, and one
that waits by a side wall, where it hides the least, stays there so long."""

AWAY = 2.0 / 3.0
"""So often a robot that waits for one on its own row goes to the far end of it."""

STUCK = 100.0
"""Who has not come up or down for so long (s) goes off the wall along its row, to turn round."""

ROW_BREADTH = 0.02
"""A robot that has not gone up or down yet is this near to its row (m), and comes back to it with
each step: level robots have to stay level."""


def wait(brain: Brain, command: Command, decision: Decision) -> None:
    """Look at whom it waits for; after a while step aside to the wall; else look around."""
    memory, pose = brain.memory, brain.pose
    side = side_gaze(brain)
    blocker = decision.waits_for
    since = memory.waiting_since if memory.waiting_since is not None else brain.time
    if give_way(brain, command, blocker, since):
        return
    level = blocker is not None and blocker.side is Side.LEVEL
    patience = MEASURED if level or side is not None else PATIENT
    if brain.time - max(since, memory.stepped_at) > patience and memory.step_to is None:
        memory.step_to = _where_to_wait(brain, not memory.stepped, blocker)
        memory.stepped, memory.stepped_at = True, brain.time
    if memory.step_to is not None:
        if abs(pose.x - memory.step_to) > 0.3 and step_aside(brain, command):
            return
        memory.step_to = None
        memory.stepped_at = brain.time  # it stands there a while, for the others to look
    if side is not None:
        turning(brain, command, side)
        return
    if blocker is not None and blocker.side is Side.UNSURE:
        if fine_look(brain, command):
            return
        wanted = look.RIGHT if blocker.x > pose.x else look.LEFT
    elif blocker is not None and looks_at(pose, memory.gaze):
        # Who waits for a level robot holds still to be measured, and looks the way it will go.
        upwards = (brain.task.goal[1] if level else blocker.y) > pose.y
        wanted = look.UP if upwards else look.DOWN
    else:
        wanted = memory.gaze
    if blocker is None and looks_at(pose, memory.gaze) and brain.time > memory.gaze_until:
        wanted = _next_gaze(brain)
        memory.gaze_until = brain.time + 3.0
        memory.looks += 1
    memory.gaze = wanted
    turning(brain, command, wanted)


def make_room(brain: Brain, command: Command) -> None:
    """Between others it cannot turn, or not go on: step aside along its row, to anywhere."""
    memory, pose = brain.memory, brain.pose
    if memory.step_to is None and brain.time - memory.stepped_at > PATIENT:
        memory.stepped_at = brain.time
        places = look.row_places(brain.region, pose, memory.tracks.all, brain.time)
        memory.step_to = places[int(brain.draw() * len(places))]
    if memory.step_to is not None and (
        abs(pose.x - memory.step_to) < 0.3 or not step_aside(brain, command)
    ):
        memory.step_to = None


def _where_to_wait(brain: Brain, first: bool, blocker: Other | None) -> float | None:
    """Where on its row to step to: to the wall, to anywhere, or for the best view of its way.

    From who is on its row itself it goes away as far as it can, or as near as it can: a coin says
    which, because there may be others on its row, on either side. After long it goes to where it
    can leave its row as well.
    """
    pose, tracks = brain.pose, brain.memory.tracks.all
    places = look.row_places(brain.region, pose, tracks, brain.time)
    if blocker is None:
        upwards = brain.task.goal[1] > pose.y
        return look.step_for_view(
            pose, places, tracks, brain.shadows, (upwards, not upwards), brain.draw()
        )
    # Far from the other nothing fits behind it that the other cannot see; near it, nothing that
    # those on its other side cannot see.
    if not first and abs(blocker.y - pose.y) < BODY:
        late = brain.time - (brain.memory.waiting_since or 0.0) > OPENS
        inner = [x for x in places if late and not may_be_backed_into(brain, x)]
        if inner and brain.draw() < AWAY:
            return inner[int(brain.draw() * len(inner))]
        end = max if brain.draw() < AWAY else min
        return end(places, key=lambda x: abs(x - blocker.x))
    return min(places) if first else sorted(places)[int(brain.draw() * len(places))]


def _next_gaze(brain: Brain) -> float:
    """Where to look next for unseen robots: the way it is going, and to the sides in turn."""
    memory = brain.memory
    ahead = look.UP if brain.task.goal[1] > brain.pose.y else look.DOWN
    if abs(math.remainder(memory.gaze - ahead, math.tau)) > 0.1:
        return ahead
    return (look.LEFT, look.RIGHT)[memory.looks // 2 % 2]


def step_aside(brain: Brain, command: Command) -> bool:
    """Go on with a step along the row, out of the others' view; false if that is not possible."""
    memory, pose = brain.memory, brain.pose
    assert memory.step_to is not None
    leftwards = memory.step_to < pose.x
    gaze = look.LEFT if leftwards else look.RIGHT
    if not looks_at(pose, gaze) and (turning(brain, command, gaze) or _off_wall(brain, command)):
        return True  # where there is no room to turn, it slides to where it knows nobody to be
    on_start = abs(pose.y - memory.row) < ROW_BREADTH
    target = (memory.step_to, memory.row if on_start else pose.y)
    travel = free_travel(
        brain.region, pose, target, memory.tracks.all, brain.time, keep=APART + 0.05
    )
    ahead = (pose.x - 1.6, pose.x) if leftwards else (pose.x, pose.x + 1.6)
    if travel < 0.05 or hidden_between(brain, *ahead):
        return False
    command.motion = drive(pose, target, travel, brain.settings.limits, 0.4)
    return True


def _off_wall(brain: Brain, command: Command) -> bool:
    """One reading's worth of the way off the wall along its row, to turn round there.

    Else it would only ever step on. It goes back towards the height where it started: of those
    that it does not see nobody is between. In low strips it stays: an unseen neighbour on the next
    row could be too near for it to turn.
    """
    memory, pose, region = brain.memory, brain.pose, brain.region
    low, high = brain.task.strip
    upwards = pose.y < 0.0
    off = WALL_ROOM + 0.02 - region.depth_at(pose.x, pose.y)
    target = (pose.x, pose.y + (off if upwards else -off))
    if (
        brain.time - memory.climbed_at < STUCK
        or high - low < HALT
        or not 0.0 < off < abs(pose.y)
        or region.depth_at(*target) < WALL_ROOM
        or (target[1] < beside_limit(brain, upwards)) is not upwards
    ):
        return False
    travel = free_travel(region, pose, target, memory.tracks.all, brain.time)
    if travel < 0.01:
        return False
    memory.off_wall = True
    command.motion = drive(pose, target, travel, brain.settings.limits, 0.3)
    return True
