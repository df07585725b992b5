"""What the robot does in each phase: search the walls, observe, go, check the strip, paint."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from . import going, look, nearing
from .boustrophedon import lanes
from .clearance import others
from .compute import crowded_strip, strip_intruder
from .constants import APART, FINAL_TURN, WALL_ROOM
from .memory import Phase
from .move import STAND_KEEP, drive, free_travel, looks_at, may_turn, turn
from .observe import Scan
from .poring import fine_look
from .speak import fail, say
from .turning import side_gaze, turning

if TYPE_CHECKING:
    from .brain import Brain, Command

TURN_DEPTH = WALL_ROOM + 0.02
"""Metres from the walls at which a robot at its goal turns: it stands there within a centimetre."""

COUNTING = 60.0
"""For so long (s) a robot that has painted looks for robots that it never saw."""

CROWD = 6
"""Of more robots than this, some may always be hidden: not to have seen them is no failure, nor is
to have taken two sightings of one for two, once the own rank is known."""

STILL = 900.0
"""A robot at its goal begins to paint once no strip that it sees holds two robots, or after this
long (s). Those two may not know their ranks yet, and who paints beside them hides others in turn.
"""

DOUBT = 10.0
"""What is seen must contradict the number of robots for this long (s) before it is believed."""


def _why_not_yet(brain: Brain, rank_open: bool) -> str:
    robots = brain.settings.robots
    if rank_open:
        return f"my rank among {robots} robots is still open"
    return f"I cannot go on ({brain.memory.said}); are there {robots} robots?"


def search_walls(brain: Brain, scan: Scan, command: Command) -> None:
    """Turn until enough of the walls has been seen to know where they are."""
    say(brain, command, "looking for the walls")
    memory = brain.memory
    if brain.time - memory.began > 60.0:
        fail(brain, command, "the walls do not fit the arena's shape that I was told")
        return
    if brain.time - memory.began > 0.5 and float(scan.ranges.min()) > 0.75:
        memory.gaze += 0.0 if not looks_at(brain.pose, memory.gaze) else math.pi / 2
        command.motion = turn(brain.pose, memory.gaze, brain.settings.limits)


def carry_on(brain: Brain, command: Command) -> None:
    """One reading's worth of whatever phase the robot is in."""
    memory = brain.memory
    if memory.phase in (Phase.OBSERVING, Phase.GOING, Phase.AT_GOAL):
        rank_open = memory.phase is Phase.OBSERVING
        doubtful = memory.doubt_since is not None and brain.time - memory.doubt_since > DOUBT
        if doubtful and (rank_open or brain.settings.robots <= CROWD):
            fail(brain, command, memory.doubt)
            return
        if brain.time - memory.began > brain.settings.patience:
            fail(brain, command, _why_not_yet(brain, rank_open))
            return
    new_cycle = brain.time >= memory.next_cycle
    if new_cycle:
        memory.next_cycle = brain.time + brain.draw() * brain.settings.jitter
    if memory.phase is Phase.OBSERVING:
        if new_cycle and memory.bounds.rank is not None and not memory.nearing:
            going.set_out(brain, command)
        else:
            observe(brain, command, new_cycle)
    elif memory.phase is Phase.GOING:
        going.go(brain, command, new_cycle)
    elif memory.phase is Phase.AT_GOAL:
        check_strip(brain, command, new_cycle)
    elif memory.phase is Phase.PAINTING:
        paint(brain, command)
    elif memory.phase is Phase.COUNTING:
        count(brain, command)


def observe(brain: Brain, command: Command, new_cycle: bool) -> None:
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


def check_strip(brain: Brain, command: Command, new_cycle: bool) -> None:
    """At the goal: paint once no other robot is in the own strip [3.1 Move (ii)]."""
    memory = brain.memory
    if not brain.settings.paint:
        memory.phase = Phase.DONE
        if sum(memory.most) < brain.settings.robots - 1:
            say(brain, command, f"at goal; of {brain.settings.robots} robots I saw {_seen(brain)}")
        command.finished = True
        return
    task = brain.task
    if not looks_at(brain.pose, look.RIGHT):
        back_off_to_turn(brain, command)
        return
    if math.dist(brain.pose[:2], task.goal) > going.AT_GOAL:
        approach_goal(brain, command)
        return
    if not new_cycle:
        return
    intruder = strip_intruder(task.strip, others(brain), task.margin)
    if intruder is not None:
        say(brain, command, f"waiting: a robot is in my strip at height {intruder.y:.1f}")
        return
    low, high = task.strip[0] - task.margin, task.strip[1] + task.margin
    if brain.shadows.any_in(brain.region.left, brain.region.right, low, high):
        say(brain, command, "waiting: I cannot see all of my strip")
        return
    heights = [brain.pose.y, *(other.y for other in others(brain))]
    crowded = crowded_strip(heights, brain.settings.robots, brain.region.bottom, brain.region.top)
    if crowded is not None and brain.time - memory.arrived < STILL:
        say(brain, command, f"waiting: two robots are in strip {crowded}, and may still look")
        return
    memory.way = lanes(brain.region, task.strip, brain.settings.sprayer)
    memory.phase = Phase.PAINTING
    command.report["paint_time"] = round(brain.time, 3)
    say(brain, command, "painting")


def back_off_to_turn(brain: Brain, command: Command) -> None:
    """At the goal with the wall before its nose: go back along the row to where it can turn.

    That happens where a neighbour was too near to turn on the way, or where the row lies along a
    wall. The row behind is the one that it came along, and nobody may have come within epsilon of
    it since; who has to leave it does so past its neighbour's goal.
    """
    pose, goal = brain.pose, brain.task.goal
    if turning(brain, command, look.RIGHT):
        return
    low, high = brain.task.strip
    x = goal[0] + going.final_turn(brain)
    off = TURN_DEPTH - brain.region.depth_at(x, goal[1])
    if off > 0.0 and high - low - off < STAND_KEEP:
        x = goal[0] + max(FINAL_TURN)
    target = (x, goal[1])
    if off > 0.0 and pose.x > x - 0.05:
        beside = [(x, goal[1] + off), (x, goal[1] - off)]
        target = max(beside, key=lambda place: brain.region.depth_at(*place))
    travel = free_travel(brain.region, pose, target, brain.memory.tracks.all, brain.time)
    command.motion = drive(pose, target, travel, brain.settings.limits, 0.3)


def approach_goal(brain: Brain, command: Command) -> None:
    """Go back to the goal after turning."""
    goal, pose = brain.task.goal, brain.pose
    travel = free_travel(brain.region, pose, goal, brain.memory.tracks.all, brain.time)
    command.motion = drive(pose, goal, travel, brain.settings.limits, 0.2)


def paint(brain: Brain, command: Command) -> None:
    """Follow the lanes; the sprayer is on from the first lane's beginning to the last one's end."""
    memory, pose, limits = brain.memory, brain.pose, brain.settings.limits
    way = memory.way
    while way and math.dist(pose[:2], way[0]) < 0.02:
        way.pop(0)
        memory.spraying = True
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
        more = f"; I saw {_seen(brain)} robots, not {robots}" if seen >= robots else ""
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
    elif robots > CROWD:
        memory.phase = Phase.DONE
        say(brain, command, f"done; of {robots} robots I saw {_seen(brain)}")
        command.finished = True
    else:
        told = f"I never saw more than {_seen(brain)} of the {robots} robots; told wrong?"
        fail(brain, command, told)


def _look_around(brain: Brain, command: Command) -> None:
    gaze = side_gaze(brain)
    if gaze is None:
        gaze = (look.LEFT, look.RIGHT)[int(brain.time / look.LOOKING) % 2]
    turning(brain, command, gaze)


def _seen(brain: Brain) -> int:
    """How many robots it knows of at least, itself included."""
    return sum(brain.memory.most) + 1
