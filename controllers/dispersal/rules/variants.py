"""What the papers make of FCDFS: other first directions, a hand on the wall, missed steps."""

from controllers.dispersal.vocabulary import DICE, LIGHTS, SETTLE, STAY, UP


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


RULES = {"symmetric": symmetric, "left_hand": left_hand, "light": light}
SENSES = {"symmetric": DICE, "light": LIGHTS}
