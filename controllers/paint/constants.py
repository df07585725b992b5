"""The numbers of algorithm Paint: the paper's, and those that a body of 1 m x 1 m adds.

Lengths in metres. The paper is "Simulation of a distributed algorithm for painting a priori
known rectangular region by swarm of mobile robots"; its sections are in brackets.
"""

from __future__ import annotations

import math

BODY = 1.0
"""The edge of a robot's square body [4.1]."""

HALF = BODY / 2

TURNING = BODY / math.sqrt(2.0)
"""The radius that a square body sweeps when it turns on the spot."""

ARENA = (16.0, 21.0)
"""The paper's world, width and height [4.2]."""

INSET = 0.6
"""How far inside its strip's corner a robot's goal lies, in both axes.

This is the paper's sensing radius T [2, 3.1 Move]: "it is sufficient to reach a height which is
at a distance T away from the final destination". A body's centre cannot reach a corner; 0.6
leaves a tenth of a metre between the body and the walls.
"""

EPSILON = 1.1
"""The paper's epsilon [3.1 Compute]: how far below (above) another's height a robot halts.

More than a body, so that rows of robots never touch. Two goals on either side of a strip's
border are 2 INSET apart (in the lowest strips a strip's height, see `task`), and that must be more
than EPSILON, or the second robot to come would halt short of its goal for ever.
"""

HALT = 1.65
"""Where a robot has to halt anyway, it halts this far off, so that both can still turn.

More than APART, because both may come to a halt at the same time.
"""

APART = 1.5
"""Centres this far apart may both turn: more than 2 TURNING = 1.414."""

WALL_ROOM = 0.73
"""A centre this far from a wall has room to turn: more than TURNING."""

FINAL_TURN = (1.0, 2.3)
"""So far before their goals (m) robots of even and of odd ranks turn round; the rest they go
backwards, without looking. It is seen free before, by EPSILON to either side of the row."""

LEVEL = 0.002
"""Two robots whose heights differ by less are at the same height, and x decides [3.1 Step 1].

As small as it can be measured by looking again and again at a robot that leans by up to AIMED (in
`moves.twist`) while it looks back; half of it leaves level robots in the worlds undecided. Random
heights must not be taken for equal ones: with four robots of random heights on 20 m, two are
nearer than this once in 800 placements, with twelve once in 75.
"""

SPRAYER = (1.5, 1.5)
"""Length and width of what the sprayer paints: lanes at WALL_ROOM from a wall reach the wall."""

OVERLAP = 0.02
"""How far the outermost lanes paint beyond the strip's borders, so that no seam stays bare."""
