"""Looking exactly at a robot that is nearly level, until its side is known."""

from __future__ import annotations

import math

from ..brain import Brain, Command
from ..moves import look
from ..moves.twist import turn

PORING = 15.0
"""For so long (s) a robot looks exactly at another that is nearly level before it looks around."""

SPELL = 1.0
"""So long (s) it aims rays at the other's corners, or holds still, as a coin says.

Both of a pair look at each other, and each turns the corners that the other aims at. Who holds
still is measured twice as exactly with every reading.
"""


def fine_look(brain: Brain, command: Command) -> bool:
    """Look exactly at a robot that is nearly level, until its side is known; false if none is.

    Not for longer than PORING at a time: meanwhile others move.
    """
    memory = brain.memory
    level = look.nearly_level(memory.tracks.all, brain.time)
    if level is None:
        memory.poring_since = None
        return False
    if memory.poring_since is None:
        memory.poring_since = brain.time
    if brain.time - memory.poring_since > PORING:
        memory.poring_since = None
        return False
    if brain.time >= memory.spell_ends:
        memory.spell_ends = brain.time + SPELL
        memory.holds_still = brain.draw() < 0.5
    if memory.holds_still:
        return True
    memory.fine_looks += 1
    gaze = look.fine_gaze(brain.pose, level, brain.spacing, memory.fine_looks % 2 == 1)
    if gaze is not None:
        memory.gaze = gaze
        memory.gaze_until = brain.time
        error = math.remainder(gaze - brain.pose.yaw, math.tau)
        command.motion = turn(brain.pose, brain.pose.yaw + 2.0 * error, brain.settings.limits)
    return True
