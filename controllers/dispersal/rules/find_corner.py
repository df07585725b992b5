"""Find-Corner Depth-First Search, as the paper has it: Algorithms 1 and 2 (section 3)."""

from controllers.dispersal.vocabulary import SETTLE, UP


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


RULES = {"fcdfs": fcdfs, "fcdfs5": fcdfs5}
