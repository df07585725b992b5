"""On the way: the vertical leg, the horizontal leg, and waiting for others without hiding them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from . import look
from .compute import Act, Decision, Other, Side, decide, vertical_leg
from .constants import APART, EPSILON, HALF, HALT, INSET, WALL_ROOM
from .memory import Phase
from .move import (
    TURN_KEEP,
    can_turn,
    drive,
    free_travel,
    looks_at,
    may_turn,
    passing_height,
    turn,
)
from .poring import fine_look
from .speak import fail, say
from .task import task_of
from .tracks import is_higher

if TYPE_CHECKING:
    from .brain import Brain, Command
    from .observe import Scan

AT_GOAL = 0.01
"""A robot this near to its goal has reached it (m)."""

PATIENT = 8.0
"""After waiting this long (s) a robot steps aside to the wall, out of the others' view.

After each further while it steps to anywhere on its row: where it stands may be what hides two
others from each other, of whom it waits for one.
"""

VAGUE = 0.15
"""Bounds this wide either way (m) are taken at their middle: nearer by, they get narrower."""

_LAST_BIT = WALL_ROOM - INSET + 0.25
"""Where the goal's row is too near to a wall to turn on, the robot turns this far before it (m)."""
_BERTH = 0.4  # m: a robot that gives another berth on its row is still on it
_FINAL_TURN = (1.0, 2.3)  # m before the goal at which robots of even and odd ranks turn round


def set_out(brain: Brain, command: Command) -> None:
    """The rank is known: report it, the strip and the goal, and go."""
    memory = brain.memory
    rank = memory.bounds.rank
    assert rank is not None
    try:
        memory.task = task_of(brain.region, rank, brain.settings.robots, brain.settings.sprayer[1])
    except ValueError as error:
        fail(brain, command, str(error))
        return
    memory.phase = Phase.GOING
    brain.shadows.on_row = False
    memory.next_cycle = brain.time
    command.report["rank"] = rank
    command.report["strip"] = [round(y, 4) for y in brain.task.strip]
    command.report["goal"] = [round(v, 4) for v in brain.task.goal]
    say(brain, command, f"going: my rank is {rank}")


def others(brain: Brain) -> list[Other]:
    """The robots followed, as the compute step takes them.

    Where all that are above are told apart already, who is nearly level is below, and the other
    way round.
    """
    x, bounds = brain.pose.x, brain.memory.bounds
    counted = {True: 0, False: 0}
    for track in brain.memory.tracks.confirmed():
        higher = is_higher(x, track)
        if higher is not None:
            counted[higher] += 1
    unsure = Side.UNSURE
    if bounds.above[0] == bounds.above[1] == counted[True]:
        unsure = Side.BELOW
    elif bounds.below[0] == bounds.below[1] == counted[False]:
        unsure = Side.ABOVE
    found = []
    for track in brain.memory.tracks.all:
        ox, oy = track.centre
        roomy = can_turn(brain.region, ox, oy) and abs(ox - x) < TURN_KEEP + track.reach + 0.1
        keep = TURN_KEEP if roomy else EPSILON
        slack = track.reach + max(0.0, 0.5 * (track.y[1] - track.y[0]) - VAGUE)
        side = unsure if track.side is Side.UNSURE else track.side
        found.append(Other(ox, oy, side, keep, HALT, slack))
    return found


def unseen_limit(brain: Brain, upwards: bool) -> float:
    """The height up (down) to which no unseen robot can be nearer than EPSILON; infinite if none.

    If all robots above (below) are followed, who is unseen is on the other side.
    """
    bounds = brain.memory.bounds
    tracks = brain.memory.tracks.confirmed()
    count = sum(is_higher(brain.pose.x, track) == upwards for track in tracks)
    total = bounds.above[0] if upwards else bounds.below[0]
    if count >= total:
        return math.inf if upwards else -math.inf
    nearest = brain.shadows.nearest_height(brain.pose.y, upwards)
    return nearest - EPSILON if upwards else nearest + EPSILON


def go(brain: Brain, scan: Scan, command: Command, new_cycle: bool) -> None:
    """Carry out the legs; decide anew at each cycle, and hold where the way is no longer free."""
    memory, pose, task = brain.memory, brain.pose, brain.task
    if math.dist(pose[:2], task.goal) < AT_GOAL:
        memory.phase = Phase.AT_GOAL
        command.report["goal_time"] = round(brain.time, 3)
        command.report["looks"] = memory.looks
        command.report["waits"] = memory.waits
        say(brain, command, "at goal")
        return
    if new_cycle or memory.decision is None:
        memory.decision = _decide(brain)
        _tell(brain, command, memory.decision)
    decision = memory.decision
    if decision.act is Act.CLIMB:
        _climb(brain, command, decision)
    elif decision.act is Act.CROSS:
        _cross(brain, command)
    else:
        _wait(brain, command, decision)


def _decide(brain: Brain) -> Decision:
    memory, pose, task = brain.memory, brain.pose, brain.task
    seen = others(brain)
    if memory.row_clear:
        return Decision(Act.CROSS, task.goal)
    on_row = memory.crossing and abs(pose.y - task.goal[1]) < _BERTH
    decision = decide(pose.x, task.goal[1] if on_row else pose.y, task, seen)
    if decision.act is Act.CLIMB:
        upwards = decision.target[1] > pose.y
        limit = unseen_limit(brain, upwards)
        height = min(limit, decision.target[1]) if upwards else max(limit, decision.target[1])
        if (height - pose.y) * (1.0 if upwards else -1.0) < 1e-3:
            return Decision(Act.WAIT, (pose.x, pose.y), decision.waits_for)
        return Decision(Act.CLIMB, (pose.x, height), decision.waits_for, decision.case)
    return decision


def _tell(brain: Brain, command: Command, decision: Decision) -> None:
    memory = brain.memory
    waits = decision.act is Act.WAIT
    if waits and memory.last_act is not Act.WAIT:
        memory.waits += 1
    if waits != (memory.last_act is Act.WAIT):
        memory.waiting_since = brain.time if waits else None
        memory.step_to = None
    memory.last_act = decision.act
    if not waits:
        say(
            brain,
            command,
            f"going: {'up or down' if decision.act is Act.CLIMB else 'along my row'}",
        )
    elif decision.waits_for is None:
        say(brain, command, "waiting: I cannot see whether my way is free")
    else:
        other = decision.waits_for
        why = f" (case {decision.case.value})" if decision.case else ""
        side = {Side.ABOVE: "above", Side.BELOW: "below"}.get(other.side, "level with")
        say(brain, command, f"waiting for the robot {side} me{why}")


def turning(brain: Brain, command: Command, gaze: float) -> bool:
    """Begin or go on turning to a heading where there is room; false if there is nothing to do.

    A robot that moves comes to rest first.
    """
    if looks_at(brain.pose, gaze):
        return False
    if not may_turn(brain.region, brain.pose, brain.memory.tracks.all, brain.time, brain.nearest):
        return False
    if not brain.moving:
        command.motion = turn(brain.pose, gaze, brain.settings.limits)
    return True


def side_gaze(brain: Brain) -> float | None:
    """By a side wall the robot looks away from it: all there is, is on that side."""
    left, right = brain.region.left, brain.region.right
    if brain.pose.x - left < look.BY_WALL:
        return look.RIGHT
    if right - brain.pose.x < look.BY_WALL:
        return look.LEFT
    return None


def _climb(brain: Brain, command: Command, decision: Decision) -> None:
    memory, pose, task = brain.memory, brain.pose, brain.task
    upwards = decision.target[1] > pose.y
    side = side_gaze(brain)
    remaining = abs(task.goal[1] - pose.y)
    if side is not None:
        gaze = side
    elif brain.region.depth_at(pose.x, task.goal[1]) > WALL_ROOM or remaining > _LAST_BIT:
        gaze = look.UP if upwards else look.DOWN
    else:
        gaze = look.LEFT
    if turning(brain, command, gaze):
        return
    leg = vertical_leg(pose.x, pose.y, decision.target[1], others(brain))
    limit = unseen_limit(brain, upwards)
    height = min(limit, leg.height) if upwards else max(limit, leg.height)
    target = (_beside_edge(brain, height), height)
    if (height - pose.y) * (1.0 if upwards else -1.0) <= 0.0:
        memory.next_cycle = min(memory.next_cycle, brain.time)
        return
    travel = free_travel(brain.region, pose, target, memory.tracks.all, brain.time)
    settle = 0.2 if height == task.goal[1] else 0.5
    command.motion = drive(pose, target, travel, brain.settings.limits, settle)


def _beside_edge(brain: Brain, height: float) -> float:
    """The x at which to arrive at a height: the own, or as far in as a slanted edge demands."""
    x = brain.pose.x
    room = brain.region.standing_room(height, WALL_ROOM)
    wide = brain.region.standing_room(height, INSET)
    if wide is None or wide[0] <= x <= wide[1]:
        return x
    room = room or wide
    return min(max(x, room[0]), room[1])


def final_turn(brain: Brain) -> float:
    """How far before the goal to turn round; where strips are low, neighbours do it elsewhere."""
    low, high = brain.task.strip
    return _FINAL_TURN[brain.memory.bounds.below[0] % 2 if high - low < 2 * APART else 0]


def _cross(brain: Brain, command: Command) -> None:
    memory, pose, task = brain.memory, brain.pose, brain.task
    left = pose.x - task.goal[0]
    memory.crossing = True
    turn_at = final_turn(brain)
    gaze, aim_x = look.LEFT, task.goal[0] + turn_at
    if left <= turn_at + 0.05 or memory.row_clear:
        memory.row_clear = memory.row_clear or not hidden_on_row(brain, task.goal[0] - HALF)
        if memory.row_clear:
            gaze, aim_x = look.RIGHT, task.goal[0]
    if not looks_at(pose, gaze) and turning(brain, command, gaze):
        return
    if not memory.row_clear and hidden_on_row(brain, max(pose.x - 1.6, task.goal[0] - HALF)):
        return
    height = task.goal[1]
    if left > 0.7:
        height = passing_height(
            brain.region, pose.y, height, pose.x, task.goal[0], memory.tracks.all, task.strip
        )
    target = (aim_x, height)
    if abs(height - pose.y) > 0.02 and left > 0.7:
        target = (pose.x, height)
    travel = free_travel(brain.region, pose, target, memory.tracks.all, brain.time)
    settle = 0.2 if aim_x == task.goal[0] else 0.3
    command.motion = drive(pose, target, travel, brain.settings.limits, settle)


def hidden_on_row(brain: Brain, left: float) -> bool:
    """Whether an unseen robot could be in the way from here to the left as far as `left`."""
    return hidden_between(brain, left, brain.pose.x)


def hidden_between(brain: Brain, left: float, right: float) -> bool:
    """Whether an unseen robot could be on the own row between two places."""
    y = brain.pose.y
    return brain.unseen > 0 and brain.shadows.any_in(left, right, y - 2 * HALF, y + 2 * HALF)


def _wait(brain: Brain, command: Command, decision: Decision) -> None:
    """Look at whom it waits for; after a while step aside to the wall; else look around."""
    memory, pose = brain.memory, brain.pose
    side = side_gaze(brain)
    blocker = decision.waits_for
    if side is not None:
        turning(brain, command, side)
        return
    since = memory.waiting_since if memory.waiting_since is not None else brain.time
    if brain.time - max(since, memory.stepped_at) > PATIENT and memory.step_to is None:
        places = sorted(look.row_places(brain.region, pose, memory.tracks.all, brain.time))
        first = memory.stepped_at < since
        memory.step_to = places[0] if first else places[int(brain.draw() * len(places))]
        memory.stepped_at = brain.time
    if memory.step_to is not None:
        if abs(pose.x - memory.step_to) > 0.3 and step_aside(brain, command):
            return
        memory.step_to = None
    if blocker is not None and blocker.side is Side.UNSURE:
        if fine_look(brain, command):
            return
        wanted = look.RIGHT if blocker.x > pose.x else look.LEFT
    elif blocker is not None and looks_at(pose, memory.gaze):
        upwards = blocker.y > pose.y
        wanted = look.UP if upwards else look.DOWN
    else:
        wanted = memory.gaze
    if blocker is None and looks_at(pose, memory.gaze) and brain.time > memory.gaze_until:
        wanted = next_gaze(brain)
        memory.gaze_until = brain.time + 3.0
        memory.looks += 1
    memory.gaze = wanted
    turning(brain, command, wanted)


def next_gaze(brain: Brain) -> float:
    """Where to look next for unseen robots: the way it is going, and to the sides in turn."""
    memory, goal = brain.memory, brain.task.goal
    on_row = abs(goal[1] - brain.pose.y) < _BERTH
    ahead = look.LEFT if on_row else look.UP if goal[1] > brain.pose.y else look.DOWN
    if abs(math.remainder(memory.gaze - ahead, math.tau)) > 0.1:
        return ahead
    return (look.LEFT, look.RIGHT)[memory.looks // 2 % 2]


def step_aside(brain: Brain, command: Command) -> bool:
    """Go on with a step along the row, out of the others' view; false if that is not possible."""
    memory, pose = brain.memory, brain.pose
    assert memory.step_to is not None
    leftwards = memory.step_to < pose.x
    gaze = look.LEFT if leftwards else look.RIGHT
    if not looks_at(pose, gaze):
        return turning(brain, command, gaze)
    target = (memory.step_to, pose.y)
    travel = free_travel(
        brain.region, pose, target, memory.tracks.all, brain.time, keep=APART + 0.05
    )
    ahead = (pose.x - 1.6, pose.x) if leftwards else (pose.x, pose.x + 1.6)
    if travel < 0.05 or hidden_between(brain, *ahead):
        return False
    command.motion = drive(pose, target, travel, brain.settings.limits, 0.4)
    return True
