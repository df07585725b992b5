"""All that a painting robot knows and intends from one cycle to the next, in one place, and why.

What `Brain` holds besides is of the last reading only: its time, its pose, the nearest point.

The paper's robots keep nothing [2, Oblivious]: they are points that see everything at once. These
have bodies that hide each other and look one way at a time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from .compute import Act, Decision, Task
from .geometry import Floats, Region
from .sight.ranking import RankBounds
from .sight.shadows import Shadows
from .sight.tracks import Tracks


class Phase(Enum):
    """What the robot is about. It only ever goes forward."""

    LOCATING = "locating"
    OBSERVING = "observing"
    GOING = "going"
    AT_GOAL = "at goal"
    PAINTING = "painting"
    COUNTING = "counting"
    DONE = "done"
    FAILED = "failed"


@dataclass
class Memory:
    """What is kept, and why."""

    tracks: Tracks
    """Who was seen where: while the robot looks one way it cannot see the other."""

    bounds: RankBounds
    """Bounds on the own rank: looks add up, and with all keeping order no bound expires."""

    began: float = math.inf
    """The time of the first reading: a robot may join a world that runs."""

    most: tuple[int, int] = (0, 0)
    """The most robots seen above and below: if all were ever seen, the number told is right."""

    known: object = None
    known_since: float = 0.0
    """Since when the bounds are what they are: see `lined`."""

    phase: Phase = Phase.LOCATING
    """Painting is uninterruptible [2], and what was done need not be done again."""

    region: Region | None = None
    """Where the walls are in the own frame: a priori knowledge, found once."""

    wall_points: list[Floats] = field(default_factory=list)
    """The points on walls until the region is found: one look may show too little of it."""

    shift: Floats = field(default_factory=lambda: np.zeros(2))
    turn: float = 0.0
    """By how much odometry was found to be off: its drift is not seen in one reading."""

    next_correction: float = 0.0
    """When odometry is compared with the walls next."""

    shadows: Shadows | None = None
    """Where unseen robots could be: knowing that somebody is nowhere takes more than one look."""

    task: Task | None = None
    """Strip and goal: the rank never changes, so neither do they."""

    decision: Decision | None = None
    """The last cycle's decision: it is carried out until the next cycle, however far off."""

    next_cycle: float = 0.0
    """When the next cycle begins: clocks of their own."""

    gaze: float = 0.0
    """The heading to look at, in the own frame: a turn takes many readings."""

    gaze_until: float = 0.0
    """When a look in that direction has lasted long enough."""

    looks: int = 0
    """Looks taken (half turns), to know when looking from here has shown all it can."""

    poring_since: float | None = None
    """Since when it has looked exactly at a robot that is nearly level, so as to end some time."""

    fine_looks: int = 0
    """Exact looks taken: upper and lower corner are looked at in turn."""

    spell_ends: float = 0.0
    holds_still: bool = False
    """Whether it holds still to be looked at exactly, and until when: see `poring`."""

    row: float = 0.0
    """The height of its row while its rank is open: side-steps stay on it, level robots level."""

    nearing: bool = False
    """Whether it is on its way up or down while its rank is open: it ends at rest."""

    step_to: float | None = None
    """Where a side-step goes to (x), until it is made."""

    stepped_at: float = 0.0
    """When it last thought of stepping aside, or, waiting, came to stand where it stepped to."""

    stepped: bool = False
    """Whether it has stepped aside on this row: first it steps to the wall, then elsewhere."""

    counting_since: float = 0.0
    """Since when it has painted and looks for robots that it never saw."""

    waiting_since: float | None = None
    """Since when it has waited: after a while it steps out of the others' view."""

    passing_since: float | None = None
    """Since when it has let others pass beside its goal's row: not for ever."""

    least_left: float = math.inf
    nearer_at: float = 0.0
    """How near to its goal it has come (m, along both legs), and when: see `stalled`."""

    careful_from: float | None = None
    gives_up: bool = False
    careful_again: float = 0.0
    """From which heading it turns carefully, whether it turns back, and when it may try again."""

    held_since: float | None = None
    """Since when somebody beside its row has held it up on its way along it."""

    climbed_at: float = math.inf
    """When it was last on its way up or down to its goal's row."""

    off_wall: bool = False
    """Whether it has left its row along a wall to turn: it is on that row all the same."""

    giving_way: float | None = None
    """The height to which it leaves a line of level robots, for the others to see each other."""

    opens_to: float | None = None
    """The height to which it leaves the row of a nearly level robot, to open the view to it."""

    opened_at: float = -math.inf
    """When it last began to leave such a row: where it was no good it tries again after a while."""

    waits: int = 0
    """How often it had to wait, for the report."""

    crossing: bool = False
    """The goal's height was reached: giving somebody berth does not begin the legs anew."""

    row_clear: bool = False
    """The way to the goal on its row was seen free: nobody may come within epsilon of it since."""

    arrived: float = 0.0
    """When it reached its goal: it does not wait there for ever for others to come out of one."""

    way: list[tuple[float, float]] = field(default_factory=list)
    """What is left of the way over the strip."""

    moved_at: float = 0.0
    """When it last moved while it paints: it does not stand there for ever."""

    spraying: bool = False
    """Whether the way over the strip has been begun: from there on the sprayer is on."""

    doubt_since: float | None = None
    """Since when what is seen has contradicted the number of robots: a glitch is no proof."""

    doubt: str = ""
    """What the contradiction is."""

    said: str = ""
    """What it said last, so as to speak only when something changes."""

    last_act: Act | None = None
    """The act of the last decision, to count waits."""
