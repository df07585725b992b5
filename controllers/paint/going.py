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
from .speak import fail, say
from .task import task_of

if TYPE_CHECKING:
    from .brain import Brain, Command
    from .observe import Scan

AT_GOAL = 0.01
"""A robot this near to its goal has reached it (m)."""

PATIENT = 8.0
"""After waiting this long (s) a robot steps aside to the wall, out of the others' view."""

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
    memory.next_cycle = brain.time
    command.report["rank"] = rank
    command.report["strip"] = [round(y, 4) for y in brain.task.strip]
    command.report["goal"] = [round(v, 4) for v in brain.task.goal]
    say(brain, command, f"going: my rank is {rank}")


def others(brain: Brain) -> list[Other]:
    """The robots followed, as the compute step takes them."""
    x = brain.pose.x
    found = []
    for track in brain.memory.tracks.all:
        ox, oy = track.centre
        roomy = can_turn(brain.region, ox, oy) and abs(ox - x) < TURN_KEEP + track.reach + 0.1
        keep = TURN_KEEP if roomy else EPSILON
        slack = track.reach + 0.5 * (track.y[1] - track.y[0])
        found.append(Other(ox, oy, track.side, keep, HALT, slack))
    return found


def unseen_limit(brain: Brain, upwards: bool) -> float:
    """The height up (down) to which no unseen robot can be nearer than EPSILON; infinite if none.

    If all robots above (below) are followed, who is unseen is on the other side.
    """
    bounds = brain.memory.bounds
    side = Side.ABOVE if upwards else Side.BELOW
    count = sum(
        track.side is side
        or (track.side is Side.LEVEL and (track.centre[0] > brain.pose.x) == upwards)
        for track in brain.memory.tracks.confirmed()
    )
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
        side = "above" if other.y > brain.pose.y else "below"
        say(
            brain, command, f"waiting for the robot {side} me, at {other.x:.0f}, {other.y:.0f}{why}"
        )


def turning(brain: Brain, command: Command, gaze: float) -> bool:
    """Begin or go on turning to a heading where there is room; false if there is nothing to do.

    A robot that moves comes to rest first.
    """
    if looks_at(brain.pose, gaze):
        return False
    if not may_turn(brain.region, brain.pose, brain.memory.tracks.all, brain.time):
        return False
    if not brain.moving:
        command.motion = turn(brain.pose, gaze, brain.settings.limits)
    return True


def _side_gaze(brain: Brain) -> float | None:
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
    side = _side_gaze(brain)
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
    target = (pose.x, height)
    if (height - pose.y) * (1.0 if upwards else -1.0) <= 0.0:
        memory.next_cycle = min(memory.next_cycle, brain.time)
        return
    travel = free_travel(brain.region, pose, target, memory.tracks.all, brain.time)
    settle = 0.2 if height == task.goal[1] else 0.5
    command.motion = drive(pose, target, travel, brain.settings.limits, settle)


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
    if abs(height - pose.y) > 0.01 and abs(aim_x - pose.x) > 0.3:
        target = (pose.x - abs(height - pose.y), height)
    travel = free_travel(brain.region, pose, target, memory.tracks.all, brain.time)
    settle = 0.2 if aim_x == task.goal[0] else 0.3
    command.motion = drive(pose, target, travel, brain.settings.limits, settle)


def hidden_on_row(brain: Brain, left: float) -> bool:
    """Whether an unseen robot could be in the way from here to the left as far as `left`."""
    x, y = brain.pose.x, brain.pose.y
    return brain.unseen > 0 and brain.shadows.any_in(left, x, y - 2 * HALF, y + 2 * HALF)


def _wait(brain: Brain, command: Command, decision: Decision) -> None:
    """Look at whom it waits for; after a while step aside to the wall; else look around."""
    memory, pose = brain.memory, brain.pose
    side = _side_gaze(brain)
    blocker = decision.waits_for
    if side is not None:
        turning(brain, command, side)
        return
    since = memory.waiting_since if memory.waiting_since is not None else brain.time
    if brain.time - since > PATIENT and memory.step_to is None and brain.time > memory.gaze_until:
        places = look.row_places(brain.region, pose, memory.tracks.all, brain.shadows, brain.time)
        memory.step_to = min(places)
        memory.gaze_until = brain.time + PATIENT
    if memory.step_to is not None and pose.x - memory.step_to > 0.3:
        if not looks_at(pose, look.LEFT):
            turning(brain, command, look.LEFT)
            return
        target = (memory.step_to, pose.y)
        travel = free_travel(brain.region, pose, target, memory.tracks.all, brain.time)
        if hidden_on_row(brain, pose.x - 1.6):
            travel = 0.0
        command.motion = drive(pose, target, travel, brain.settings.limits, 0.4)
        if travel > 0.0:
            return
    if memory.step_to is not None and pose.x - memory.step_to <= 0.3:
        memory.step_to = None
    if blocker is not None and looks_at(pose, memory.gaze):
        upwards = blocker.y > pose.y
        wanted = look.UP if upwards else look.DOWN
    else:
        wanted = memory.gaze
    if blocker is None and looks_at(pose, memory.gaze) and brain.time > memory.gaze_until:
        wanted = look.LEFT if math.cos(memory.gaze) > 0.0 else look.RIGHT
        memory.gaze_until = brain.time + 3.0
        memory.looks += 1
    memory.gaze = wanted
    turning(brain, command, wanted)
