"""One synchronous step of the paper's model (section 2), compiled: look, compute, move, enter.

The grid is flat and framed by walls. A cell holds what it adds to a neighbour's look: FREE,
STANDING (a wall or a settled robot) or ACTIVE. All robots look at the beginning of the step;
then all move; then a new robot enters at each door where nobody stood at the beginning.

The work of a step grows with the active robots alone, not with the region or the settled ones.
"""

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from controllers.dispersal import chance, vocabulary
from gridworld import compiled
from gridworld.compiled import RULE_TYPE, draw, keyed

FREE = 0
STANDING = 1
ACTIVE = 1 | 1 << 8
"""Shifted by a direction these are bits 0-7 and 8-15 of what a robot sees."""

# Counters of a run: indices into one int64 array, which the compiled step and Python share.
STEP = 0  # steps done
ENTERED = 1  # robots that have come in
AT_WORK = 2  # active robots
MAKESPAN = 3  # first step at whose end every cell is occupied, 0 before
PROGRESS = 4  # last step in which a robot entered or settled
COLLISIONS = 5  # times that a robot came to a cell where another was, or came too
OUTSIDE = 6  # moves into a wall
STATUS = 7  # one of the following
WHERE = 8  # cell of the first collision or move into a wall
COUNTERS = 9

RUNNING = 0
COMPLETE = 1  # every cell holds a settled robot
COLLIDED = 2
LEFT_REGION = 3
STUCK = 4  # nobody is active, nobody can enter, cells are free
CIRCLING = 5  # nobody has entered or settled for `patience` steps

NOBODY = np.int8(-1)
BY_DOOR = np.int8(4)


def _advance(
    rule: Any,  # (state, seen) -> (state, move)
    senses: int,
    cells: NDArray[np.uint16],  # per framed cell: FREE, STANDING, ACTIVE
    first_by: NDArray[np.int8],  # per cell: direction of the first entry, BY_DOOR, NOBODY (TALK)
    left_to: NDArray[np.int8],  # per cell: 1 + direction of the last leaving, 0 for none (TALK)
    offsets: NDArray[np.int32],  # of the eight cells around, as in `seen`
    doors: NDArray[np.int32],  # cells
    counters: NDArray[np.int64],
    active: NDArray[np.int32],  # robots, counted from 0, in the order of entry
    position: NDArray[np.int32],  # per robot: its cell
    state: NDArray[np.int64],
    entered: NDArray[np.int32],  # step at whose end it came in
    settled: NDArray[np.int32],  # step at whose end it was settled, 0 before
    moves: NDArray[np.int32],  # steps in which it changed its cell
    door_of: NDArray[np.int32],
    next_state: NDArray[np.int64],  # room for the robots' decisions, per place in `active`
    next_move: NDArray[np.int8],
    region_cells: int,
    seed: int,
    fails_below: int,  # an activation fails if its draw is less: ceil(q * 2**32)
    loser_stays: int,
    patience: int,
    steps: int,
) -> None:
    """Do at most `steps` steps; fewer if the run ends, which `counters[STATUS]` says."""
    talk, dice = senses & vocabulary.TALK, senses & vocabulary.DICE
    lights = senses & vocabulary.LIGHTS
    look_mask = 0xFFFF if lights else 0xFF
    n_doors = doors.size
    at_work = counters[AT_WORK]
    step = counters[STEP]
    last = step + steps
    while step < last and counters[STATUS] == RUNNING:
        step += 1
        # Which doors are free at the beginning, one bit each.
        free_doors = 0
        for d in range(n_doors):
            if cells[doors[d]] == FREE:
                free_doors |= 1 << d

        # Look and compute.
        for place in range(at_work):
            robot = active[place]
            if fails_below > 0 and draw(seed, robot + 1, step, chance.ACTIVATION) < fails_below:
                next_move[place] = vocabulary.STAY
                next_state[place] = state[robot]
                continue
            cell = position[robot]
            seen = np.int64(0)
            for k in range(8):
                seen |= np.int64(cells[cell + offsets[k]]) << k
            seen &= look_mask
            if talk:
                for k in range(4):
                    neighbour = cell + offsets[k]
                    if first_by[neighbour] == NOBODY and cells[neighbour] == FREE:
                        seen |= 1 << (16 + k)
                    elif first_by[neighbour] == k:
                        seen |= 1 << (20 + k)
                seen |= np.int64(left_to[cell]) << 24
                by = first_by[cell]
                parent = cell if by == BY_DOOR else cell - offsets[by]
                if by == BY_DOOR or cells[parent] != FREE:
                    seen |= 1 << 27
                by = first_by[parent]
                if by == BY_DOOR or cells[parent - offsets[by]] != FREE:
                    seen |= 1 << 28
            if dice:
                seen |= (draw(seed, robot + 1, step, chance.DIE) >> 16) << 32
            next_state[place], next_move[place] = rule(state[robot], seen)
            if talk and next_move[place] < vocabulary.STAY:
                # It tells the others where it goes: that cell is new to nobody after it.
                wanted = cell + offsets[next_move[place]]
                if cells[wanted] == FREE and first_by[wanted] == NOBODY:
                    first_by[wanted] = next_move[place]

        # Take the wanted cells. Of several robots the one that came in first gets a cell.
        for place in range(at_work):
            move = next_move[place]
            if move >= vocabulary.STAY:
                continue
            wanted = position[active[place]] + offsets[move]
            if cells[wanted] == FREE:
                cells[wanted] = ACTIVE
                continue
            if talk or loser_stays:
                next_move[place] = vocabulary.STAY
                next_state[place] = state[active[place]]
                continue
            if cells[wanted] == STANDING:
                counters[OUTSIDE] += 1
                counters[STATUS] = LEFT_REGION
            else:
                counters[COLLISIONS] += 1
                counters[STATUS] = COLLIDED
            if counters[WHERE] == 0:
                counters[WHERE] = wanted
            next_move[place] = vocabulary.STAY

        # Move and settle.
        still_at_work = 0
        for place in range(at_work):
            robot = active[place]
            move = next_move[place]
            cell = position[robot]
            state[robot] = next_state[place]
            if move == vocabulary.SETTLE:
                cells[cell] = STANDING
                settled[robot] = step
                counters[PROGRESS] = step
                continue
            if move != vocabulary.STAY:
                cells[cell] = FREE
                if talk:
                    left_to[cell] = 1 + move
                cell += offsets[move]
                position[robot] = cell
                moves[robot] += 1
            active[still_at_work] = robot
            still_at_work += 1
        at_work = still_at_work

        # Enter.
        door_blocked = True
        for d in range(n_doors):
            if (free_doors >> d) & 1:
                door_blocked = False
                cell = doors[d]
                if cells[cell] != FREE:  # a robot came to the door in this step
                    if not (talk or loser_stays):
                        counters[COLLISIONS] += 1
                        counters[STATUS] = COLLIDED
                        if counters[WHERE] == 0:
                            counters[WHERE] = cell
                    continue
                robot = counters[ENTERED]
                counters[ENTERED] += 1
                cells[cell] = ACTIVE
                position[robot] = cell
                entered[robot] = step
                door_of[robot] = d
                active[at_work] = robot
                at_work += 1
                counters[PROGRESS] = step
                if talk and first_by[cell] == NOBODY:
                    first_by[cell] = BY_DOOR
            elif cells[doors[d]] == FREE:
                door_blocked = False

        if counters[STATUS] == RUNNING:
            if counters[ENTERED] == region_cells:
                if counters[MAKESPAN] == 0:
                    counters[MAKESPAN] = step
                if at_work == 0:
                    counters[STATUS] = COMPLETE
            elif at_work == 0 and door_blocked:
                counters[STATUS] = STUCK
            if counters[STATUS] == RUNNING and step - counters[PROGRESS] >= patience:
                counters[STATUS] = CIRCLING
    counters[STEP] = step
    counters[AT_WORK] = at_work


_i1 = numba.types.Array(numba.int8, 1, "C")
_i4 = numba.types.Array(numba.int32, 1, "C")
_i8 = numba.types.Array(numba.int64, 1, "C")
_u2 = numba.types.Array(numba.uint16, 1, "C")
_int = numba.int64

advance: Any = compiled.compiled(
    numba.void(
        *(RULE_TYPE, _int, _u2, _i1, _i1, _i4, _i4, _i8),
        *(_i4, _i4, _i8, _i4, _i4, _i4, _i4, _i8, _i1),
        *(_int, _int, _int, _int, _int, _int),
    ),
    keyed(_advance, chance, compiled, vocabulary),
)
"""`_advance`, compiled for every rule at once: the rule is a function value."""
