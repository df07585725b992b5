"""The words of dispersal rules: directions, moves, and what a rule sees. Imports nothing.

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
