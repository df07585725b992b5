"""On the way: the vertical leg, the horizontal leg, and waiting for others without hiding them."""

from __future__ import annotations

import math

from ..brain import Brain, Command
from ..compute import Act, Decision, Side, decide
from ..constants import APART, FINAL_TURN, HALF, INSET, WALL_ROOM
from ..memory import Phase
from ..moves import look
from ..moves.room import free_travel, passing_height, room_to_turn
from ..moves.twist import drive, looks_at
from ..sight.tracks import Track
from ..task import task_of
from .clearance import hidden_on_row, others, reachable, unseen_limit
from .speak import fail, say
from .turning import side_gaze, stalled, turning
from .waiting import PATIENT, make_room, step_aside, wait

AT_GOAL = 0.01
"""A robot this near to its goal has reached it (m)."""

BLIND = 8.0
"""On the last bit, which it goes without looking, a robot takes into account who it saw this long
(s) ago: who turns there has done so by then, and has seen it come."""

BERTH = 0.4
"""A robot that gives another berth on its row (m) is still on it."""

PASSING = 30.0
"""For so long (s) a robot waits for others to pass along their rows beside its goal's row."""

NEARER = 0.1
"""Less than this (m) is no progress."""

_LAST_BIT = WALL_ROOM - INSET + 0.25
"""Where the goal's row is too near to a wall to turn on, the robot turns this far before it (m)."""
_NEAR, _BEGUN = 2.0, 0.1  # m before the goal's height at which it steps aside to where it can turn


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
    memory.step_to = None
    brain.shadows.on_row = False
    memory.next_cycle = brain.time
    command.report["rank"] = rank
    command.report["strip"] = [round(y, 4) for y in brain.task.strip]
    command.report["goal"] = [round(v, 4) for v in brain.task.goal]
    say(brain, command, f"going: my rank is {rank}")


def go(brain: Brain, command: Command, new_cycle: bool) -> None:
    """Carry out the legs; decide anew at each cycle, and hold where the way is no longer free."""
    memory, pose, task = brain.memory, brain.pose, brain.task
    reached = memory.decision is not None and memory.decision.act is Act.PAINT
    if reached or math.dist(pose[:2], task.goal) < AT_GOAL:
        memory.phase = Phase.AT_GOAL
        memory.arrived = brain.time
        command.report["goal_time"] = round(brain.time, 3)
        command.report["looks"] = memory.looks
        command.report["waits"] = memory.waits
        say(brain, command, "at goal")
        return
    _note_progress(brain)
    ends_first = memory.last_act is Act.CLIMB or (memory.last_act is Act.CROSS and stalled(brain))
    steps = ends_first and memory.step_to is not None
    if memory.decision is None or (new_cycle and not steps):
        memory.decision = _decide(brain)
        _tell(brain, command, memory.decision)
    decision = memory.decision
    if decision.act is Act.CLIMB:
        _climb(brain, command, decision)
    elif decision.act is Act.CROSS:
        _cross(brain, command)
    else:
        wait(brain, command, decision)


def _note_progress(brain: Brain) -> None:
    memory, (x, y) = brain.memory, brain.task.goal
    left = abs(brain.pose.x - x) + abs(brain.pose.y - y)
    if left < memory.least_left - NEARER:
        memory.least_left, memory.nearer_at = left, brain.time


def _decide(brain: Brain) -> Decision:
    memory, pose, task = brain.memory, brain.pose, brain.task
    seen = others(brain)
    if memory.row_clear:
        return Decision(Act.CROSS, task.goal)
    on_row = (memory.crossing or memory.off_wall) and abs(pose.y - task.goal[1]) < BERTH
    decision = decide(pose.x, task.goal[1] if on_row else pose.y, task, seen)
    steps = memory.last_act is Act.WAIT and memory.step_to is not None
    if decision.act is Act.CROSS and steps and hidden_on_row(brain, task.goal[0] - HALF):
        return Decision(Act.WAIT, (pose.x, pose.y))  # on its way aside it does not see its row
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
    if waits != (memory.last_act is Act.WAIT) and not stalled(brain):
        memory.waiting_since = None
        memory.step_to = memory.giving_way = memory.opens_to = None
        memory.off_wall = False
        memory.gaze = brain.pose.yaw
    if waits and memory.waiting_since is None:
        memory.waiting_since = brain.time
    if decision.act is not memory.last_act and not stalled(brain):
        memory.held_since = None
    if decision.act is Act.CLIMB:
        memory.stepped = False
        memory.climbed_at = brain.time
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


def _climb(brain: Brain, command: Command, decision: Decision) -> None:
    memory, pose, task = brain.memory, brain.pose, brain.task
    if _aside_first(brain, command):
        return
    upwards = decision.target[1] > pose.y
    side = side_gaze(brain)
    remaining = abs(task.goal[1] - pose.y)
    if side is not None:
        gaze = side
    elif remaining > _LAST_BIT or brain.region.depth_at(pose.x, task.goal[1]) > WALL_ROOM:
        gaze = look.UP if upwards else look.DOWN
    else:
        gaze = look.LEFT
    if turning(brain, command, gaze):
        return
    height = reachable(brain, decision.target[1])
    target = (_beside_edge(brain, height), height)
    if height == pose.y:
        memory.next_cycle = min(memory.next_cycle, brain.time)
        return
    travel = free_travel(brain.region, pose, target, memory.tracks.all, brain.time)
    settle = 0.2 if height == task.goal[1] else 0.5
    command.motion = drive(pose, target, travel, brain.settings.limits, settle)


def _in_way(brain: Brain, x: float, y: float) -> list[Track]:
    """The robots beside which there is no room to turn at a place."""
    tracks = brain.memory.tracks.all
    return [track for track in tracks if not room_to_turn(brain.region, x, y, track)]


def _aside_first(brain: Brain, command: Command) -> bool:
    """Beside who stands near the goal's row it could not turn there: go up or down farther off.

    Who is on its way along its row it lets pass, for a while.
    """
    memory, pose, height = brain.memory, brain.pose, brain.task.goal[1]
    if memory.step_to is None and _NEAR > abs(height - pose.y) > _BEGUN:
        in_way = _in_way(brain, pose.x, height)
        if not in_way or brain.region.depth_at(pose.x, height) < WALL_ROOM:
            memory.passing_since = None
            return False
        if memory.passing_since is None:
            memory.passing_since = brain.time
        if brain.time - memory.passing_since < PASSING and all(
            track.crosses(brain.time) for track in in_way
        ):
            return True
        places = look.row_places(brain.region, pose, memory.tracks.all, brain.time)
        places = [
            x
            for x in places
            if brain.region.depth_at(x, height) > WALL_ROOM and not _in_way(brain, x, height)
        ]
        if places:
            memory.step_to = min(places, key=lambda x: abs(x - pose.x))
    if memory.step_to is not None:
        if abs(pose.x - memory.step_to) > 0.05 and step_aside(brain, command):
            return True
        memory.step_to = None
    return False


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
    return FINAL_TURN[brain.memory.bounds.below[0] % 2 if high - low < 2 * APART else 0]


def held_up(brain: Brain, travel: float) -> bool:
    """Whether who is beside its way, and may turn there, has kept it from crossing for long."""
    memory = brain.memory
    if travel > 0.05:
        memory.held_since = None
    elif memory.held_since is None:
        memory.held_since = brain.time
    return memory.held_since is not None and brain.time - memory.held_since > PATIENT


def _is_clear(brain: Brain) -> bool:
    """Whether the last bit is seen free: of bodies on it, and of who may turn beside it."""
    pose, goal = brain.pose, brain.task.goal
    if hidden_on_row(brain, goal[0] - HALF):
        return False
    tracks = brain.memory.tracks.all
    travel = free_travel(brain.region, pose, goal, tracks, brain.time, recent=BLIND)
    return travel > math.dist(pose[:2], goal) - AT_GOAL


def _cross(brain: Brain, command: Command) -> None:
    memory, pose, task = brain.memory, brain.pose, brain.task
    left = pose.x - task.goal[0]
    memory.crossing = True
    if memory.step_to is not None:
        memory.row_clear = False
        make_room(brain, command)
        if memory.step_to is not None:
            return
    turn_at = final_turn(brain)
    gaze, aim_x = look.LEFT, task.goal[0] + turn_at
    if left <= turn_at + 0.05 or memory.row_clear:
        memory.row_clear = memory.row_clear or _is_clear(brain)
        if memory.row_clear:
            gaze, aim_x = look.RIGHT, task.goal[0]
    if not looks_at(pose, gaze) and turning(brain, command, gaze):
        return
    if not memory.row_clear and hidden_on_row(brain, max(pose.x - 1.6, task.goal[0] - HALF)):
        if not looks_at(pose, gaze) and not brain.moving:
            make_room(brain, command)
        return
    height = task.goal[1]
    if left > 0.7:
        height = passing_height(
            brain.region, height, pose.x, task.goal[0], memory.tracks.all, task.strip
        )
    target = (aim_x, height)
    if abs(height - pose.y) > 0.02 and left > 0.7:
        target = (pose.x, height)
    recent = BLIND if memory.row_clear else 3.0
    travel = free_travel(brain.region, pose, target, memory.tracks.all, brain.time, recent=recent)
    if travel <= 0.0:  # where it gave somebody berth it goes past that one before it comes back
        target = (aim_x, pose.y)
        travel = free_travel(
            brain.region, pose, target, memory.tracks.all, brain.time, recent=recent
        )
    if held_up(brain, travel):
        memory.row_clear = False
        make_room(brain, command)
        return
    settle = 0.2 if aim_x == task.goal[0] else 0.3
    command.motion = drive(pose, target, travel, brain.settings.limits, settle)
