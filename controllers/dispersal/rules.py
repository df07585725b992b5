"""Rules of uniform dispersal: plain functions from (state, seen) to (state, move), on integers.

Sources: Amir and Bruckstein, "Minimizing Travel in the Uniform Dispersal Problem for Robotic
Sensors" (AAMAS 2019), called "the paper" below, and "Time, Travel, and Energy in the Uniform
Dispersion Problem" (2024), "the later paper"; Hsiang, Arkin, Bender, Fekete and Mitchell,
"Algorithms for Rapidly Dispersing Robot Swarms in Unknown Environments" (WAFR 2002).

This module imports nothing and no rule calls another function: a robot calls a rule, and the grid
model compiles the very same one. A new rule is one function and its line in `RULES` (and one in
`SENSES`, if it sees more than occupied cells).

Directions: 0 up, 1 right, 2 down, 3 left; clockwise is + 1 modulo 4. A move is a direction, STAY
(still active) or SETTLE (never to move again).

`state` is 0 when a robot enters. Bits 3 and 4 are its primary direction (b1 b2 of Algorithm 2).

`seen`, counted from the lowest bit; a set bit means yes:

    0-3    the cell up, right, down, left is occupied (a wall or a robot, nobody knows which)
    4-7    the diagonal cell up-right, right-down, down-left, left-up is occupied
    8-15   in that one of the eight cells stands an active robot, its light off       (LIGHTS)
    16-19  nobody has been in the cell up, right, down, left yet, and nobody who came
           in earlier goes there in this step                                         (TALK)
    20-23  that cell was first entered from this one: it is a child of this cell      (TALK)
    24-26  1 + the direction in which a robot last left this cell, 0: nobody has      (TALK)
    27     in the cell from which this one was first entered stands a robot; true at
           the door                                                                  (TALK)
    28     in the cell from which that cell was first entered stands a robot; true if
           that cell is the door                                                     (TALK)
    32-47  a die: uniform in [0, 65536)                                               (DICE)
"""

UP, RIGHT, DOWN, LEFT = 0, 1, 2, 3
STAY = 4
SETTLE = 5

LIGHTS = 1
"""Sense: tell an active robot (light off) from a settled one (light on)."""
TALK = 2
"""Sense: what neighbours can say: where robots have been, and where they went."""
DICE = 4
"""Sense: a random number in every step."""


def fcdfs(state: int, seen: int) -> tuple[int, int]:
    """Algorithm 1, Find-Corner Depth-First Search (section 3).

    State: bits 3-4 the primary direction; bits 5-7 the last move and 8-10 the one before it, as
    1 + direction, 0 for none: prev(A) and prev(prev(A)) relative to the robot. Neighbours are
    unoccupied ones. The diagonal is v - primary - secondary; in a dead end, where the paper leaves
    it undefined, the robot settles.
    """
    primary, last, before = (state >> 3) & 3, (state >> 5) & 7, (state >> 8) & 7
    if seen & 15 == 15:
        return state, SETTLE
    if last == 0:  # never moved: clockwise from up
        primary = UP
        while (seen >> primary) & 1:
            primary += 1
    secondary = (primary + 1) & 3
    move = primary
    if (seen >> primary) & 1:
        move = secondary
        if (seen >> secondary) & 1:  # at a corner or a hall
            free = ~seen & 15
            dead_end = free & (free - 1) == 0
            came_by_diagonal = (last == primary + 1 and before == secondary + 1) or (
                last == secondary + 1 and before == primary + 1
            )
            diagonal_free = (seen >> (4 + ((primary + 2) & 3))) & 1 == 0
            if dead_end or came_by_diagonal or diagonal_free:
                return state, SETTLE
            primary = (primary + 2) & 3  # a hall: on to the neighbour that is not prev(A)
            if primary == (last + 1) & 3:
                primary = (primary + 1) & 3
            move = primary
    return primary << 3 | (move + 1) << 5 | last << 8, move


def fcdfs5(state: int, seen: int) -> tuple[int, int]:
    """Algorithm 2, FCDFS with five bits (section 3.2).

    State: b1 b2 b3 b4 b5 from bit 4 down to bit 0. b1b2 primary direction; b3 the previous step
    went in the secondary direction; b4b5 is 00 at first, 10 on entering a hall and on the first
    step, and otherwise b4 = b3 of the step before and b5 = 1. "b4b5 <- b3 1" happens only in a
    step that has not written b4b5 yet; without that, or without b5 = 1 in the test of the corner,
    the algorithm fails.
    """
    primary, b3, b4b5 = state >> 3, (state >> 2) & 1, state & 3
    updated = False
    if seen & 15 == 15:
        return primary << 3 | 0b011, SETTLE
    if b4b5 == 0b00:
        primary = UP
        while (seen >> primary) & 1:
            primary += 1
        b4b5, updated = 0b10, True
    secondary = (primary + 1) & 3
    if (seen >> primary) & (seen >> secondary) & 1:
        free = ~seen & 15
        b4, b5 = b4b5 >> 1, b4b5 & 1
        dead_end = free & (free - 1) == 0
        diagonal_free = (seen >> (4 + ((primary + 2) & 3))) & 1 == 0
        if dead_end or (b5 == 1 and b3 + b4 == 1) or diagonal_free:
            return primary << 3 | 0b011, SETTLE
        previous = primary if b3 == 0 else secondary
        primary = (primary + 2) & 3
        if primary == (previous + 2) & 3:
            primary = (primary + 1) & 3
        secondary = (primary + 1) & 3
        b4b5, updated = 0b10, True
    if not updated:
        b4b5 = b3 << 1 | 1
    if (seen >> primary) & 1 == 0:
        return primary << 3 | b4b5, primary
    if (seen >> secondary) & 1 == 0:
        return primary << 3 | 0b100 | b4b5, secondary
    return primary << 3 | 0b011, SETTLE


def symmetric(state: int, seen: int) -> tuple[int, int]:
    """Section 4, figure 8: settle as soon as at a corner, first direction by chance (DICE).

    Robots with different directions do not follow each other, so "prev(prev(A)) is the diagonal"
    no longer tells a robot on the diagonal from a wall. But the diagonal was next to the previous
    cell: if it was free one step ago, what stands there now is an active robot.

    State: bits 3-4 the primary direction; 5-7 the last move, as 1 + direction, 0 for none; 8-11
    bits 0-3 of what was seen one step ago.
    """
    primary, last, memory = (state >> 3) & 3, (state >> 5) & 7, (state >> 8) & 15
    free = ~seen & 15
    if free == 0:
        return state, SETTLE
    back = (last + 1) & 3
    if last == 0:
        choices = (free & 1) + (free >> 1 & 1) + (free >> 2 & 1) + (free >> 3)
        choice = ((seen >> 32 & 65535) * choices) >> 16
        primary = UP
        while (seen >> primary) & 1 or choice > 0:
            choice -= (free >> primary) & 1
            primary += 1
    else:
        if free & (free - 1) == 0:  # a dead end
            return state, SETTLE
        for first in range(4):
            second = (first + 1) & 3
            if free == 1 << first | 1 << second:  # a corner or a hall
                other = second if first == back else first
                if (seen >> (4 + first)) & 1 == 0 or (memory >> other) & 1 == 0:
                    return state, SETTLE
    secondary = (primary + 1) & 3
    move = primary
    if (seen >> primary) & 1:
        move = secondary
        if (seen >> secondary) & 1:  # a hall
            primary = (primary + 2) & 3
            if primary == back:
                primary = (primary + 1) & 3
            move = primary
    return primary << 3 | (move + 1) << 5 | (seen & 15) << 8, move


def left_hand(state: int, seen: int) -> tuple[int, int]:
    """Section 4, figure 9: left hand on the wall, until at a corner.

    The robot goes straight until it touches a wall with its left hand or runs into one (then it
    turns right, which puts the hand on it), follows it, also to the left where the wall ends, and
    settles as soon as it is at a corner. An active robot on the diagonal is told from a wall as in
    `symmetric`.

    State: bit 0 the hand is on a wall; 3-4 the heading; 5 it has moved; 8-11 bits 0-3 of what was
    seen one step ago.
    """
    hand, heading, moved, memory = state & 1, (state >> 3) & 3, (state >> 5) & 1, state >> 8
    free = ~seen & 15
    if free == 0:
        return state, SETTLE
    if moved == 0:  # clockwise from up
        heading = UP
        while (seen >> heading) & 1:
            heading += 1
    else:
        if free & (free - 1) == 0:  # a dead end
            return state, SETTLE
        for first in range(4):
            second = (first + 1) & 3
            if free == 1 << first | 1 << second:  # a corner or a hall
                other = second if first == (heading + 2) & 3 else first
                if (seen >> (4 + first)) & 1 == 0 or (memory >> other) & 1 == 0:
                    return state, SETTLE
    left, right = (heading + 3) & 3, (heading + 1) & 3
    if hand and (seen >> left) & 1 == 0:
        heading = left
    elif (seen >> heading) & 1:
        heading = left if (seen >> right) & 1 else right
    hand = hand | (seen >> ((heading + 3) & 3)) & 1
    return (seen & 15) << 8 | 1 << 5 | heading << 3 | hand, heading


def light(state: int, seen: int) -> tuple[int, int]:
    """Asynchronous FCDFS (AsynchFCDFS of the later paper): robots miss steps (LIGHTS).

    Each has one visible bit: a light, on when it has settled. The robot decides on walls and
    settled robots alone, which makes the test of the diagonal plain, and waits while the cell it
    wants holds an active robot (section 5 asks for such a rule).

    State: bits 3-4 the primary direction; 5-7 the last move, as 1 + direction, 0 for none.
    """
    primary, last = (state >> 3) & 3, (state >> 5) & 7
    standing = seen & ~(seen >> 8) & 255
    if standing & 15 == 15:
        return state, SETTLE
    if last == 0:
        primary = UP
        while (standing >> primary) & 1:
            primary += 1
    secondary = (primary + 1) & 3
    move = primary
    if (standing >> primary) & 1:
        move = secondary
        if (standing >> secondary) & 1:
            free = ~standing & 15
            diagonal_free = (standing >> (4 + ((primary + 2) & 3))) & 1 == 0
            if free & (free - 1) == 0 or diagonal_free:
                return state, SETTLE
            primary = (primary + 2) & 3
            if primary == (last + 1) & 3:
                primary = (primary + 1) & 3
            move = primary
    if (seen >> move) & 1:
        return state, STAY
    return primary << 3 | (move + 1) << 5, move


def dflf(state: int, seen: int) -> tuple[int, int]:
    """Depth-First Leader-Follower of Hsiang et al., by interpretation (LIGHTS, TALK, DICE).

    A robot goes where its predecessor went. Where the predecessor has settled, or nobody has been
    ahead, it is the leader: it goes to a random neighbouring cell where nobody has been, and
    settles if there is none.

    State: bits 3-4 the heading.
    """
    trail = (seen >> 24) & 7
    if trail:
        if (seen >> (trail - 1)) & 1 == 0:
            return (trail - 1) << 3, trail - 1
        if (seen >> (7 + trail)) & 1:  # the predecessor has been delayed
            return state, STAY
    new = (seen >> 16) & 15
    if new == 0:
        return state, SETTLE
    choice = (
        (seen >> 32 & 65535) * ((new & 1) + (new >> 1 & 1) + (new >> 2 & 1) + (new >> 3))
    ) >> 16
    heading = UP
    while (new >> heading) & 1 == 0 or choice > 0:
        choice -= (new >> heading) & 1
        heading += 1
    return heading << 3, heading


def bflf(state: int, seen: int) -> tuple[int, int]:
    """Breadth-First Leader-Follower of Hsiang et al., by interpretation (LIGHTS, TALK, DICE).

    Every cell is the child of the cell from which it was first entered. A robot goes to a cell
    where nobody has been, or else to an empty child, to any of several by chance; but only while a
    robot stands in the parent of its cell, or in the parent's parent. So the swarm spreads on all
    fronts and no front runs ahead of it. A robot settles when no neighbour is new and every child
    has settled.

    To wait never delays the entry. Robots come in, and so follow each other, two cells apart:
    who waits goes on when the next one is two cells behind, and has left when that one arrives,
    unless it has nowhere to go; then nobody in that part of the region has.

    State: bits 3-4 the heading.
    """
    new, children = (seen >> 16) & 15, (seen >> 20) & 15
    if new == 0 and children & (~seen | seen >> 8) == 0:
        return state, SETTLE
    wanted = new if new else children & ~seen
    if wanted == 0 or (seen >> 27) & 3 == 0:
        return state, STAY
    count = (wanted & 1) + (wanted >> 1 & 1) + (wanted >> 2 & 1) + (wanted >> 3)
    choice = ((seen >> 32 & 65535) * count) >> 16
    heading = UP
    while (wanted >> heading) & 1 == 0 or choice > 0:
        choice -= (wanted >> heading) & 1
        heading += 1
    return heading << 3, heading


RULES = {
    "fcdfs": fcdfs,
    "fcdfs5": fcdfs5,
    "symmetric": symmetric,
    "left_hand": left_hand,
    "light": light,
    "dflf": dflf,
    "bflf": bflf,
}
"""Every rule by name."""

SENSES = {
    "symmetric": DICE,
    "light": LIGHTS,
    "dflf": LIGHTS | TALK | DICE,
    "bflf": LIGHTS | TALK | DICE,
}
"""What a rule sees beyond occupied cells; nothing, if it is not here."""
