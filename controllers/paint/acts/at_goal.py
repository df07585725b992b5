"""At the goal: the check that the own strip is free, and room to turn for painting it."""

from __future__ import annotations

import math

from ..boustrophedon import lanes
from ..brain import Brain, Command
from ..compute import crowded_strip, strip_intruder
from ..constants import FINAL_TURN, WALL_ROOM
from ..memory import Phase
from ..moves import look
from ..moves.room import STAND_KEEP, free_travel
from ..moves.twist import drive, looks_at
from . import going
from .clearance import others
from .painting import CROWD
from .speak import say
from .turning import turning

TURN_DEPTH = WALL_ROOM + 0.02
"""Metres from the walls at which a robot at its goal turns: it stands there within a centimetre."""

STILL = 900.0
"""A robot at its goal begins to paint once no strip that it sees holds two robots, or after this
long (s). Those two may not know their ranks yet, and who paints beside them hides others in turn.
"""


def check_strip(brain: Brain, command: Command, new_cycle: bool) -> None:
    """At the goal: paint once no other robot is in the own strip [3.1 Move (ii)]."""
    memory = brain.memory
    if not brain.settings.paint:
        memory.phase = Phase.DONE
        if sum(memory.most) < brain.settings.robots - 1:
            counted = f"of {brain.settings.robots} robots I saw {brain.seen}"
            say(brain, command, f"at goal; {counted}")
            if brain.settings.robots <= CROWD:
                command.warning = f"{counted}; who is told not to paint looks for no more"
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
    memory.moved_at = brain.time
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
