"""Into how many substeps a step is cut, so that bodies which meet in it overlap by little.

Chipmunk sees a contact only when bodies overlap already, and by then they may have moved into
one another by their closing speed times the step. So before each step of physics the pairs
that could meet in it are looked at, and the step is cut until the overlap stays small.

Its solver goes from contact to contact, and in a round a light body hands on only as much of a
push as it could have made itself. What holds a heavy body against a light one against a wall is
found in about as many rounds as the one is heavier than the other; what presses meanwhile gains way
with the square of the step. So unequal masses and strong drives ask for more rounds and shorter
substeps.
"""

from __future__ import annotations

import math
from typing import Any

from sim.stage.compiled import bare, compiled, inlined
from sim.stage.distance_field import clear_of
from sim.stage.drive import impulse
from sim.stage.limits import DEEPEST, MOST_RATIO, MOST_SUBSTEPS

GIVE = 0.005
"""m that a drive's force may press bodies into one another before the solver holds against it."""
ROUNDS = 15
"""Rounds of the solver in a step where bodies of equal mass may meet; one does where none can."""
FEWEST = 8
"""... and in each of the substeps that share them: what one has found the next begins with."""
EVEN = 15.0
"""Ratio of masses up to which ROUNDS are enough. Beyond it rounds go up with the ratio, and
substeps with its root: together with the speed of closing this kept overlaps below 0.01 m in 30
crowds of robots of all shapes with masses from 1 to 1000 and drives of 100 m/s2."""


@inlined
def then(body: Any, mover: Any, dt: float) -> tuple[float, float, float]:
    """The velocity (m/s, world) and turn rate (rad/s) that a body's drive can give it in a step.

    Within the step its velocity is one between that which it has and this one.
    """
    if mover.standing:
        return 0.0, 0.0, 0.0
    vx = mover.wanted_x * mover.axis_x - mover.wanted_y * mover.axis_y
    vy = mover.wanted_x * mover.axis_y + mover.wanted_y * mover.axis_x
    dx, dy, turn = impulse(body, mover, vx, vy, dt)
    return body[3] + dx, body[4] + dy, body[5] + turn


@inlined
def _fastest(body: Any, mover: Any, vx: float, vy: float, turn: float) -> tuple[float, float]:
    """How fast a body is at the most in a step at whose end it has these, in m/s.

    And how fast its outline is by its turning alone.
    """
    spin = max(abs(body[5]), abs(turn)) * mover.lever
    return max(math.hypot(body[3], body[4]), math.hypot(vx, vy)), spin


@inlined
def _closing(body: Any, vx: float, vy: float, there: Any, vx2: float, vy2: float) -> float:
    """How fast (m/s) two bodies' centres close at the most, which shall have these velocities.

    Velocities lie between what they are and what they shall be, so their difference is largest at
    one of the four ends.
    """
    best = math.hypot(body[3] - there[3], body[4] - there[4])
    best = max(best, math.hypot(vx - there[3], vy - there[4]))
    best = max(best, math.hypot(body[3] - vx2, body[4] - vy2))
    return max(best, math.hypot(vx - vx2, vy - vy2))


@compiled
def sort_by_x(order: Any, state: Any, count: int) -> None:
    """Insertion sort of movers by x: nearly sorted already, as bodies move little in a step."""
    order, state = bare(order), bare(state)
    for i in range(1, count):
        k = order[i]
        x = state[k, 0]
        j = i - 1
        while j >= 0 and state[order[j], 0] > x:
            order[j + 1] = order[j]
            j -= 1
        order[j + 1] = k


@inlined
def _beyond(
    corners: Any, sides: int, pose: Any, others: Any, other_sides: int, there: Any, radius: float
) -> float:
    """The largest gap across an edge of a polygon at `pose` to another body `there`.

    corners (sides, 2) and others (other_sides, 2) in their bodies' frames; a body without sides
    is a circle of `radius`. Where this is positive it is a lower bound of the distance.
    """
    most = -math.inf
    cosine, sine = math.cos(pose[2]), math.sin(pose[2])
    turn = there[2] - pose[2]
    cosine2, sine2 = math.cos(turn), math.sin(turn)
    dx, dy = there[0] - pose[0], there[1] - pose[1]
    x0, y0 = dx * cosine + dy * sine, dy * cosine - dx * sine
    for i in range(sides):
        j = i + 1 if i + 1 < sides else 0
        ex, ey = corners[j, 0] - corners[i, 0], corners[j, 1] - corners[i, 1]
        length = math.hypot(ex, ey)
        nx, ny = ey / length, -ex / length
        gap = nx * (x0 - corners[i, 0]) + ny * (y0 - corners[i, 1]) - radius
        if other_sides > 0:
            least = math.inf
            for k in range(other_sides):
                x, y = others[k, 0], others[k, 1]
                along = nx * (x * cosine2 - y * sine2) + ny * (x * sine2 + y * cosine2)
                least = min(least, along)
            gap += least
        most = max(most, gap)
    return most


@inlined
def _gap(one: Any, two: Any, mover: Any, other: Any, outlines: Any, sides: Any) -> float:
    """A lower bound of the distance in metres between two bodies' outlines."""
    n, m = sides[mover.shape], sides[other.shape]
    radius = other.reach if m == 0 else 0.0
    best = _beyond(outlines[mover.shape], n, one, outlines[other.shape], m, two, radius)
    radius = mover.reach if n == 0 else 0.0
    back = _beyond(outlines[other.shape], m, two, outlines[mover.shape], n, one, radius)
    apart = math.hypot(two[0] - one[0], two[1] - one[1]) - mover.reach - other.reach
    return float(max(best, back, apart))


@compiled
def count_substeps(
    state: Any,
    movers: Any,
    count: int,
    order: Any,
    cells: Any,
    frame: Any,
    outlines: Any,
    sides: Any,
    dt: float,
) -> tuple[int, int, float]:
    """Into how many substeps to cut a step of `dt`; 0 where no two bodies can meet in it.

    Besides how many rounds the solver shall make in each, and how fast (m/s) the fastest of those
    looked at is; negative where there is nothing that could move.

    state (count, 6): the movers'. order (count,): the movers by x, kept from step to step.
    cells, frame: the distance field of what stands. outlines (s, k, 2) with sides (s,): the movers'
    shapes in their own frames, no sides for a circle.

    Only what is in Chipmunk's space is looked at: nothing else can meet anything in this tick.
    """
    state, movers, order = bare(state), bare(movers), bare(order)
    cells, outlines, sides = bare(cells), bare(outlines), bare(sides)
    sort_by_x(order, state, count)
    fastest, largest, quickest = 0.0, 0.0, -1.0
    for i in range(count):
        mover = movers[i]
        if not mover.inside:
            continue
        body = state[i]
        largest = max(largest, mover.reach)
        if mover.standing:
            continue
        speed, spin = _fastest(body, mover, *then(body, mover, dt))
        quickest = max(quickest, math.hypot(body[3], body[4]))
        fastest = max(fastest, speed + spin)
    needed = -1.0
    heaviest, lightest, strongest = 0.0, math.inf, 0.0
    for i in range(count):
        mover = movers[order[i]]
        if not mover.inside:
            continue
        body = state[order[i]]
        vx, vy, turn = then(body, mover, dt)
        speed, spin = _fastest(body, mover, vx, vy, turn)
        own = speed + spin
        if not mover.standing and own > 0.0 and mover.levels != 0:
            clear = clear_of(cells, frame, body[0], body[1])
            if clear - mover.reach < own * dt:
                needed = max(needed, own * dt / min(DEEPEST, mover.girth / 2.0))
        for j in range(i + 1, count):
            other = movers[order[j]]
            there = state[order[j]]
            if there[0] - body[0] > mover.reach + largest + (own + fastest) * dt:
                break
            if (mover.standing and other.standing) or not other.inside:
                continue
            if mover.levels & other.levels == 0:
                continue
            # Side by side at the same velocity bodies do not close, whatever their speed.
            vx2, vy2, turn2 = then(there, other, dt)
            closing = spin + max(abs(there[5]), abs(turn2)) * other.lever
            closing += _closing(body, vx, vy, there, vx2, vy2)
            apart = math.hypot(there[0] - body[0], there[1] - body[1])
            if apart - mover.reach - other.reach >= closing * dt:
                continue
            if _gap(body, there, mover, other, outlines, sides) < closing * dt:
                closest = min(DEEPEST, (mover.girth + other.girth) / 2.0)
                needed = max(needed, closing * dt / closest)
                if not mover.standing:
                    heaviest, lightest = max(heaviest, mover.mass), min(lightest, mover.mass)
                    strongest = max(strongest, mover.strength)
                if not other.standing:
                    heaviest, lightest = max(heaviest, other.mass), min(lightest, other.mass)
                    strongest = max(strongest, other.strength)
    if needed < 0.0:
        return 0, 1, quickest
    rounds, fewest = float(ROUNDS), float(FEWEST)
    if heaviest > 0.0:
        ratio = min(heaviest / lightest, MOST_RATIO)
        if ratio > EVEN:
            rounds = fewest = max(rounds, ratio / 4.0)
            needed = max(needed, 3.0 * math.sqrt(ratio / EVEN))
        needed = max(needed, dt * math.sqrt(strongest / lightest / fewest / GIVE))
    cuts = min(MOST_SUBSTEPS, max(1, math.ceil(needed)))
    return cuts, math.ceil(max(fewest, rounds / cuts)), quickest
