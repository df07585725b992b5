"""Who drives one robot: its controller's state, process and connections."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from player.codes import DataMode
from player.server import Connection
from sim.result import RobotRecord

Kind = Literal["none", "program", "command", "external"]


@dataclass
class Driver:
    """One robot's controller. `since`: wall-clock time from which it keeps the others waiting."""

    robot: int
    kind: Kind
    record: RobotRecord
    drives: bool = True  # whether the robot has a drive: without one it never has a clock
    environment: dict[str, str] = field(default_factory=dict)  # by which its process is known
    asked: bool = False  # its first request has come: until then the clock stands
    ending: bool = False  # its connection is gone, its process not yet
    since: float = 0.0
    connection: Connection | None = None  # the inherited one
    clocks: list[Connection] = field(default_factory=list)
    """The controller's connections that have subscribed its position2d, earliest first."""
    clock: Connection | None = None
    """The one that the world waits for: the earliest of `clocks` that is in pull mode."""
    origins: dict[Connection, bool] = field(default_factory=dict)
    """Whether connections over TCP come from the controller's process, as far as asked."""
    commander: Connection | None = None
    """Who gave the last command, controller or not: when it goes away, the robot stops."""

    @property
    def launched(self) -> bool:
        """Whether its process is ours."""
        return self.kind in ("program", "command")

    @property
    def running(self) -> bool:
        return self.record.state == "running"

    @property
    def starting(self) -> bool:
        """Whether its controller has not come yet, or is a program that has not asked yet."""
        return not self.asked and (self.kind == "program" or self.clock is None)

    def choose_clock(self) -> None:
        """To be called whenever `clocks`, or the mode of one of them, has changed."""
        self.clock = None
        for connection in self.clocks:
            if connection.is_open and connection.session.mode is DataMode.PULL:
                self.clock = connection
                return
