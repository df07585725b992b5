"""Seeded chance without state: one integer hash, the same in plain Python and compiled.

A draw depends on (seed, robot, step, purpose) alone. So a robot with a body and the grid model
agree on who misses which step, and a robot more or less changes nobody else's luck. The module
imports nothing, and its intermediate values stay below 2**63, so that machine integers and
Python's give the same bits.
"""

ACTIVATION = 0
"""Purpose of a draw: does the robot act in this step?"""
DIE = 1
"""Purpose of a draw: the die that a rule with chance in it sees."""

RANGE = 4294967296
"""A draw lies in [0, RANGE): 32 bits."""


def draw(seed: int, robot: int, step: int, purpose: int) -> int:
    """A uniform integer in [0, 2**32) for one robot, step and purpose.

    `seed` lies in [0, 2**63), the other arguments in [0, 2**32). The mixing is the 32-bit
    xorshift-multiply permutation with the multipliers 0x21f0aaad and 0x735a2d97 that a public
    search for low bias found (hash-prospector); both are below 2**31, so no product reaches 2**63.
    """
    mixed = 0x2545F491
    for word in (seed & 0xFFFFFFFF, seed >> 32, robot, step, purpose):
        mixed = (mixed ^ word) & 0xFFFFFFFF
        mixed = ((mixed ^ (mixed >> 16)) * 0x21F0AAAD) & 0xFFFFFFFF
        mixed = ((mixed ^ (mixed >> 15)) * 0x735A2D97) & 0xFFFFFFFF
        mixed = (mixed ^ (mixed >> 15)) + 0x1E3779B9
    return mixed & 0xFFFFFFFF


def activated(seed: int, robot: int, step: int, q: float) -> bool:
    """Whether a robot acts in a step, when each activation fails with probability `q`.

    `robot` counts from 1 in the order of entry, `step` from 1. A robot that does not act neither
    looks, computes nor moves (section 5 of the FCDFS paper).
    """
    return draw(seed, robot, step, ACTIVATION) >= q * RANGE
