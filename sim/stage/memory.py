"""A body's numbers where Chipmunk keeps them: compiled code reads and writes them in place.

Nine doubles lie in a row in the struct of a body: where it is, how it moves, and the force and
torque that act on it for one step. `chipmunk.state_of` tells where they begin, and looks whether
they lie so.
"""

from __future__ import annotations

from typing import Any

from sim.stage.compiled import bare, compiled
from sim.stage.intrinsics import floats_at

PLACE, VELOCITY, FORCE, ANGLE, SPIN, TORQUE = 0, 2, 4, 6, 7, 8
"""Where each begins: the first three have an x and a y."""


@compiled
def read_bodies(state: Any, movers: Any, count: int) -> None:
    """Fill state (count, 6): x, y, angle, vx, vy and angular velocity of the movers' bodies."""
    state, movers = bare(state), bare(movers)
    for i in range(count):
        body = floats_at(movers[i].body)
        state[i, 0], state[i, 1], state[i, 2] = body[PLACE], body[PLACE + 1], body[ANGLE]
        state[i, 3], state[i, 4], state[i, 5] = body[VELOCITY], body[VELOCITY + 1], body[SPIN]
