"""Leader-Follower, depth first and breadth first: the algorithms of Hsiang et al."""

from controllers.dispersal.vocabulary import DICE, LIGHTS, SETTLE, STAY, TALK, UP


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


RULES = {"dflf": dflf, "bflf": bflf}
SENSES = {"dflf": LIGHTS | TALK | DICE, "bflf": LIGHTS | TALK | DICE}
