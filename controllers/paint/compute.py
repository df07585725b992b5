"""The compute step of algorithm Paint, a pure function of what was observed.

Everything is in one robot's own frame: x to its right, y upwards, in any unit of length (all
lengths, epsilon and the inset included, may be multiplied by one factor without changing a
decision). Sections of the paper are in brackets. Two repairs make it work (both needed, neither
changes who goes where): the goal lies an inset inside the strip, with 2 inset > epsilon, and a
robot that has to halt stays where it is and never backs off.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum


class Side(Enum):
    """Where another robot is by height."""

    BELOW = -1
    LEVEL = 0
    ABOVE = 1
    UNSURE = 2  # too nearly level to say yet: nothing that depends on it may be done


@dataclass(frozen=True)
class Other:
    """Another robot as observed: its position, and how its height compares.

    `slack` is by how much it may be nearer than `y` says; `keep` the distance in height at which
    the goal may be from it, `halt` that at which to stop where the goal is farther on.
    """

    x: float
    y: float
    side: Side
    keep: float
    halt: float
    slack: float = 0.0


class Case(Enum):
    """The four cases of two robots at one height [3.1 Move (ii)]."""

    A = "A"  # the rank is greater, the destination upwards: goes first
    B = "B"  # the rank is less, the destination downwards: goes first
    C = "C"  # the rank is greater, the destination downwards: waits
    D = "D"  # the rank is less, the destination upwards: waits


@dataclass(frozen=True)
class Vertical:
    """The vertical leg: the height to go to, and what it stops for.

    `height` is the goal's, or that of the paper's secondary destination. `blocked_by` is the
    robot that it waits for, `case` the tie case if that robot is level.
    """

    height: float
    blocked_by: Other | None = None
    case: Case | None = None


def side_of(y: float, other_y: float, tolerance: float = 0.0) -> Side:
    """How the height `other_y` compares with `y`, where differences up to `tolerance` are none."""
    difference = other_y - y
    if abs(difference) <= tolerance:
        return Side.LEVEL
    return Side.ABOVE if difference > 0.0 else Side.BELOW


def is_lower(x: float, side: Side, other_x: float) -> bool | None:
    """Whether another has a lower rank than one at `x` [3.1 Step 1]: by height, by x where level.

    None if its height is too uncertain to compare.
    """
    if side is Side.UNSURE:
        return None
    if side is Side.LEVEL:
        return other_x < x
    return side is Side.BELOW


def rank_among(x: float, others: Iterable[Other]) -> int:
    """The rank, 1 for the lowest, of a robot at `x` that sees all others [3.1 Step 1].

    Raises:
        ValueError: the height of one of them is too uncertain to compare.
    """
    rank = 1
    for other in others:
        lower = is_lower(x, other.side, other.x)
        if lower is None:
            raise ValueError(f"the robot at x = {other.x} may be higher or lower")
        rank += lower
    return rank


def strip_of(rank: int, robots: int, bottom: float, top: float) -> tuple[float, float]:
    """The strip's lower and upper height [3.1 Step 2]: f + (k-1)(s-f)/N to f + k(s-f)/N."""
    height = (top - bottom) / robots
    return bottom + (rank - 1) * height, bottom + rank * height


def tie_case(is_higher: bool, upwards: bool) -> Case:
    """Which of the cases A to D holds for a robot that is level with another [3.1 Move (ii)]."""
    if is_higher:
        return Case.A if upwards else Case.C
    return Case.D if upwards else Case.B


def vertical_leg(x: float, y: float, goal_height: float, others: Sequence[Other]) -> Vertical:
    """How far a robot at (x, y) may go towards its goal's height without passing anybody's.

    It halts short of the first robot whose height it would come too near to: the secondary
    destination [3.1 Compute, figure 2]. Level robots are the cases A to D. At the goal's height
    there is no leg, and nothing blocks it.
    """
    if goal_height == y:
        return Vertical(y)
    upwards = goal_height > y
    sign = 1.0 if upwards else -1.0
    leg = Vertical(goal_height)
    for other in others:
        if other.side is Side.UNSURE:
            return Vertical(y, other)
        if other.side is Side.LEVEL:
            case = tie_case(other.x < x, upwards)
            if case in (Case.C, Case.D):
                return Vertical(y, other, case)
        elif (other.side is Side.ABOVE) == upwards:
            nearest = other.y - sign * other.slack
            if sign * (nearest - goal_height) < other.keep:
                halt = nearest - sign * other.halt
                if sign * (halt - leg.height) < 0.0:
                    leg = Vertical(halt, other)
    if sign * (leg.height - y) < 0.0:
        return Vertical(y, leg.blocked_by)  # halting means staying, never backing off
    return leg


def row_blocker(
    x: float, y: float, goal_x: float, others: Iterable[Other], clearance: float
) -> Other | None:
    """The nearest robot that stands in the way of the horizontal leg from (x, y) to (goal_x, y).

    In the way is who is less than `clearance` off the row, and not behind.
    """
    towards = 1.0 if goal_x > x else -1.0
    ahead = [
        other
        for other in others
        if abs(other.y - y) - other.slack < clearance
        and towards * (other.x - x) > 0.0
        and towards * (other.x - goal_x) < clearance
    ]
    return min(ahead, key=lambda other: abs(other.x - x), default=None)


def strip_intruder(
    strip: tuple[float, float], others: Iterable[Other], margin: float = 0.0
) -> Other | None:
    """A robot that is in the strip [3.1 Move (ii)], or nearer to it than `margin`; None if free.

    The strip is open: a robot on its border (margin 0) is not in it.
    """
    low, high = strip[0] - margin, strip[1] + margin
    return next((other for other in others if low < other.y < high), None)


def crowded_strip(heights: Iterable[float], robots: int, bottom: float, top: float) -> int | None:
    """The rank of the lowest strip that two of these heights lie in; None if none does."""
    strips = sorted(int((y - bottom) / (top - bottom) * robots) for y in heights)
    return next((a + 1 for a, b in itertools.pairwise(strips) if a == b), None)


class Act(Enum):
    """What the move step is to do."""

    CLIMB = "climb"  # the vertical leg, up or down
    CROSS = "cross"  # the horizontal leg, to the goal
    WAIT = "wait"
    PAINT = "paint"


@dataclass(frozen=True)
class Task:
    """What a robot of known rank has to do: its strip and goal, and the lengths that matter."""

    strip: tuple[float, float]
    goal: tuple[float, float]
    clearance: float  # who is less than this off the row is in the horizontal leg's way
    margin: float  # who is nearer to the strip than this keeps it from being painted
    reached: float  # the goal's height and the goal are reached at this distance


@dataclass(frozen=True)
class Decision:
    """The outcome of a compute step: what to do, to which point, and for whom it waits."""

    act: Act
    target: tuple[float, float]
    waits_for: Other | None = None
    case: Case | None = None


def decide(x: float, y: float, task: Task, others: Sequence[Other]) -> Decision:
    """The compute step of a robot at (x, y) that knows its rank [3.1].

    First the vertical leg, to the goal's height or to a secondary destination; at the goal's
    height the horizontal leg; at the goal the check that the own strip is free.
    """
    goal_x, goal_y = task.goal
    if abs(goal_y - y) > task.reached:
        leg = vertical_leg(x, y, goal_y, others)
        if leg.height == y:
            return Decision(Act.WAIT, (x, y), leg.blocked_by, leg.case)
        return Decision(Act.CLIMB, (x, leg.height), leg.blocked_by, leg.case)
    if abs(goal_x - x) > task.reached:
        blocker = row_blocker(x, y, goal_x, others, task.clearance)
        if blocker is not None:
            return Decision(Act.WAIT, (x, y), blocker)
        return Decision(Act.CROSS, (goal_x, y))
    intruder = strip_intruder(task.strip, others, task.margin)
    if intruder is not None:
        return Decision(Act.WAIT, (x, y), intruder)
    return Decision(Act.PAINT, (x, y))
