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
    asked: bool = False  # its first request has come: until then the clock stands
    ending: bool = False  # its connection is gone, its process not yet
    since: float = 0.0
    clocks: list[Connection] = field(default_factory=list)  # have subscribed its position2d
    connection: Connection | None = None  # the inherited one

    @property
    def launched(self) -> bool:
        """Whether its process is ours."""
        return self.kind in ("program", "command")

    @property
    def running(self) -> bool:
        return self.record.state == "running"

    def clock(self) -> Connection | None:
        """The earliest live pull-mode connection that has subscribed the robot's position2d."""
        for connection in self.clocks:
            if connection.is_open and connection.session.mode == DataMode.PULL:
                return connection
        return None
