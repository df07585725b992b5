"""A painting robot's mind, without sockets or clocks: what it is told, knows and intends.

`observe` puts into it what a reading shows, `cycle` says what it does next.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from .compute import Task
from .constants import ARENA, SPRAYER
from .geometry import Floats, Pose, Region, rectangle
from .memory import Memory
from .moves.room import Near
from .moves.twist import LIMITS, REST, Limits, Motion
from .sight.ranking import RankBounds
from .sight.scan import Patch
from .sight.shadows import Shadows
from .sight.tracks import Tracks

FAR = Near(math.inf, math.inf)

PATIENCE = 1700.0
"""For so long (s) a robot tries to come to paint before it says that it cannot."""


@dataclass(frozen=True)
class Settings:
    """What a robot is told: how many there are, the region's shape, and its own limits."""

    robots: int
    paint: bool = True
    shape: Region = field(default_factory=lambda: rectangle(*ARENA))
    jitter: float = 0.0  # s: the longest cycle; 0: every reading begins one
    limits: Limits = LIMITS
    sprayer: tuple[float, float] = SPRAYER
    patience: float = PATIENCE  # s until it gives up if it is not painting yet


@dataclass(frozen=True)
class Reading:
    """What the devices say: odometry, the laser's ranges and bearings (n,), and blobs."""

    time: float
    pose: Pose
    ranges: Floats
    bearings: Floats
    max_range: float
    blobs: Iterable[Patch]
    image_width: int


@dataclass
class Command:
    """What to do until the next reading, and what to tell."""

    motion: Motion = REST
    spray: bool = False
    say: str | None = None
    report: dict[str, Any] = field(default_factory=dict)
    warning: str | None = None
    finished: bool = False
    failure: str | None = None


class Brain:
    """One robot's mind. `draw` gives random numbers in [0, 1): for the cycles' lengths, and
    wherever robots that decide alike would stand in each other's way for ever."""

    def __init__(self, settings: Settings, draw: Any) -> None:
        self.settings = settings
        self.draw = draw
        self.memory = Memory(Tracks(settings.limits.speed), RankBounds.unknown(settings.robots))
        self.pose = Pose(0.0, 0.0, 0.0)
        self.time = 0.0
        self.moving = False
        self.nearest = FAR
        self.spacing = math.radians(1.0)  # rad between the laser's rays

    @property
    def region(self) -> Region:
        """The region in the own frame, once it is found."""
        assert self.memory.region is not None
        return self.memory.region

    @property
    def shadows(self) -> Shadows:
        """Where unseen robots could be, once the region is found."""
        assert self.memory.shadows is not None
        return self.memory.shadows

    @property
    def task(self) -> Task:
        """Strip and goal, once the rank is known."""
        assert self.memory.task is not None
        return self.memory.task

    @property
    def unseen(self) -> int:
        """How many robots there must be besides those that are followed."""
        return self.settings.robots - 1 - len(self.memory.tracks.sure)

    @property
    def seen(self) -> int:
        """How many robots it knows of at least, itself included."""
        return sum(self.memory.most) + 1
