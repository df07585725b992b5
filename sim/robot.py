"""A robot of a run: who it is, and all that is known of it one by one.

Rules: every robot stands once in the run's list, at its index, from its entry to the end. What is
computed for all robots at once (poses, velocities, readings, odometry) is in arrays by that index,
and nowhere here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from sim.result import RobotRecord
from sim.view.figure import Figure

if TYPE_CHECKING:
    from sim.devices.switchboard import Port
    from sim.fleet.driver import Driver
    from sim.worldfile import schema


@dataclass
class MountedSprayer:
    """One of a robot's sprayers: how it is mounted, and whether it is on."""

    mount: schema.Sprayer
    on: bool = False


@dataclass(eq=False)
class Robot:
    """One robot. `entity` is its body in the sensors' scene."""

    index: int
    name: str
    model_name: str
    model: schema.Model
    entity: int
    record: RobotRecord
    driver: Driver
    open_port: Callable[[Robot], Port] = field(repr=False)
    color: int  # 0xRRGGBB, of its body
    fiducial: int  # the id that it carries, 0 for none
    sprayers: list[MountedSprayer]
    drawings: list[Figure] = field(default_factory=list)  # all that shows of the two below
    drawn: list[Figure] = field(default_factory=list)  # by its program
    paddles: dict[int, list[Figure]] = field(default_factory=dict)  # of its grippers
    property_names: set[str] = field(default_factory=set)  # of all that it was told to be
    raw_properties: dict[str, bytes] = field(default_factory=dict)  # those that are no JSON

    @cached_property
    def port(self) -> Port:
        """Where its devices are: they are made when somebody first asks for them."""
        return self.open_port(self)

    def show_drawings(self) -> None:
        """Let everybody see what its program has drawn by now, and where its paddles are."""
        paddles = [one for number in sorted(self.paddles) for one in self.paddles[number]]
        self.drawings = [*paddles, *self.drawn]
