"""Which movers could meet anything within a tick: only these are in Chipmunk's space.

The others, far from all else, are most of a large sparse world. They are moved by what drives or
brakes them alone (see `drive.lead`): Chipmunk, which walks over all bodies in each of its steps,
knows nothing of them, and how finely it has to step does not concern them.
"""

from __future__ import annotations

import math
from typing import Any

from sim.stage.compiled import bare, compiled, inlined
from sim.stage.distance_field import clear_of
from sim.stage.substeps import sort_by_x

CALM = 20
"""Ticks that a mover must have been far from everything before it is taken out of the space: to
take it out and put it back costs more than to keep it for a while."""


@inlined
def comes(mover: Any) -> bool:
    """Whether a mover that is out of the space must be in it now."""
    return mover.calm == 0 and not mover.inside


@inlined
def leaves(mover: Any) -> bool:
    """Whether a mover in the space need not be there any more."""
    return mover.calm >= CALM and mover.inside and not (mover.standing or mover.gripped)


@compiled
def count_calm_ticks(
    state: Any, movers: Any, count: int, order: Any, cells: Any, frame: Any, interval: float
) -> tuple[int, float]:
    """Count for each mover the ticks since it last could meet anything (`calm`, 0 for now).

    Bodies are taken for their circles, and each for as fast as the fastest may be: who is pushed
    goes as fast as who pushes. Returns how many movers must come into the space or leave it, and
    that speed in m/s: should anything go faster, look again.
    """
    state, movers, order, cells = bare(state), bare(movers), bare(order), bare(cells)
    sort_by_x(order, state, count)
    fastest, widest = 0.0, 0.0
    for i in range(count):
        mover = movers[i]
        body = state[i]
        mover.calm += 1
        speed = max(mover.max_speed if mover.driven else 0.0, math.hypot(body[3], body[4]))
        fastest, widest = max(fastest, speed), max(widest, mover.reach)
    way = fastest * interval
    widest += way
    for i in range(count):
        mover = movers[order[i]]
        body = state[order[i]]
        wide = mover.reach + (0.0 if mover.standing else way)
        if mover.levels == 0:
            continue
        if not mover.standing and clear_of(cells, frame, body[0], body[1]) <= wide:
            mover.calm = 0
        for j in range(i + 1, count):
            other = movers[order[j]]
            there = state[order[j]]
            if there[0] - body[0] > wide + widest:
                break
            if (mover.standing and other.standing) or mover.levels & other.levels == 0:
                continue
            least = wide + other.reach + (0.0 if other.standing else way)
            if math.hypot(there[0] - body[0], there[1] - body[1]) <= least:
                mover.calm = 0
                other.calm = 0
    changes = 0
    for i in range(count):
        mover = movers[i]
        if comes(mover) or leaves(mover):
            changes += 1
    return changes, fastest
