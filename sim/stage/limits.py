"""Limits of the physics: what the stage cuts its steps for, and what world files may ask of it."""

DEEPEST = 0.015
"""m that bodies may close in a substep. With the slop of 0.005 m that Chipmunk leaves
between bodies that rest on each other, this keeps overlaps below 0.02 m. Bodies so small that they
would pass through something in one may close by half of what they are wide."""
SLOP = 0.005
"""m that bodies which rest on each other may overlap."""
MOST_SUBSTEPS = 4000
"""Of a step, against a run that would never end."""
MOST_RATIO = 1000.0
"""Of the masses of two bodies that move."""
MOST_PUSH = 1e5
"""m/s2: the largest force of a drive over the mass of the lightest body; 100 m/s2 on one that is
MOST_RATIO times as heavy."""
