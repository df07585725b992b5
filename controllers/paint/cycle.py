"""The computational cycle [2]: observe, compute, move, as far as one reading goes."""

from __future__ import annotations

import math

from .acts.at_goal import check_strip
from .acts.going import go, set_out
from .acts.looking import look_around, search_walls
from .acts.painting import CROWD, count, paint
from .acts.speak import fail
from .brain import Brain, Command, Reading
from .memory import Phase
from .observe import observe

DOUBT = 10.0
"""What is seen must contradict the number of robots for this long (s) before it is believed."""


def step(brain: Brain, reading: Reading) -> Command:
    """Take in one reading and say what to do."""
    command = Command()
    memory = brain.memory
    if math.isinf(memory.began):
        memory.began = reading.time
    scan = observe(brain, reading)
    if memory.region is None:
        search_walls(brain, scan, command)
        return command
    if memory.phase is not Phase.DONE:
        _carry_on(brain, command)
    return command


def _carry_on(brain: Brain, command: Command) -> None:
    """One reading's worth of whatever phase the robot is in."""
    memory = brain.memory
    if memory.phase in (Phase.OBSERVING, Phase.GOING, Phase.AT_GOAL):
        rank_open = memory.phase is Phase.OBSERVING
        doubtful = memory.doubt_since is not None and brain.time - memory.doubt_since > DOUBT
        if doubtful and (rank_open or brain.settings.robots <= CROWD):
            fail(brain, command, memory.doubt)
            return
        if brain.time - memory.began > brain.settings.patience:
            fail(brain, command, _why_not_yet(brain, rank_open))
            return
    new_cycle = brain.time >= memory.next_cycle
    if new_cycle:
        memory.next_cycle = brain.time + brain.draw() * brain.settings.jitter
    if memory.phase is Phase.OBSERVING:
        if new_cycle and memory.bounds.rank is not None and not memory.nearing:
            set_out(brain, command)
        else:
            look_around(brain, command, new_cycle)
    elif memory.phase is Phase.GOING:
        go(brain, command, new_cycle)
    elif memory.phase is Phase.AT_GOAL:
        check_strip(brain, command, new_cycle)
    elif memory.phase is Phase.PAINTING:
        paint(brain, command)
    elif memory.phase is Phase.COUNTING:
        count(brain, command)


def _why_not_yet(brain: Brain, rank_open: bool) -> str:
    robots = brain.settings.robots
    if rank_open:
        return f"my rank among {robots} robots is still open"
    return f"I cannot go on ({brain.memory.said}); are there {robots} robots?"
