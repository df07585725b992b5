"""Who drives one robot: its controller's state, process and connections."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Literal

from player.codes import DataMode, DeviceAddr
from player.server import Connection
from sim.result import RobotRecord

Kind = Literal["none", "program", "command", "external", "function"]


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
    """The controller's connections, earliest first: those of the processes that were started for
    the robot, whatever they subscribe; of outsiders, see `sim.fleet.outsiders`."""
    driving: set[Connection] = field(default_factory=set)
    """Those of them that have subscribed its position2d."""
    readers: list[Connection] = field(default_factory=list)
    """Those that the world waits for, until one of them waits for data: see `choose_readers`."""
    origins: dict[Connection, int] = field(default_factory=dict)
    """The process that a connection over TCP comes from, as far as asked; 0: not the robot's."""
    lost: str | None = None
    """Why its connection has been closed, though its process goes on."""
    came: dict[Connection, float] = field(default_factory=dict)
    """Outsiders that read something of the robot, and from which simulated time on; those of its
    last controller are forgotten when that has ended."""
    free: bool = False  # an outsider for whom nobody waits, whatever its mode
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

    @property
    def clock(self) -> Connection | None:
        """The first connection that the world waits for, if there is any."""
        return self.readers[0] if self.readers else None

    @property
    def asking(self) -> bool:
        """Whether the controller waits for data, at one of its connections."""
        for reader in self.readers:  # noqa: SIM110 - a generator for each robot and tick costs
            if reader.session.waiting:
                return True
        return False

    @property
    def pushed(self) -> bool:
        """Whether the controller is sent its data without asking."""
        return not self.readers and any(
            connection.session.subscribed for connection in self.clocks if connection.is_open
        )

    def note_devices(self, addresses: Iterable[DeviceAddr]) -> None:
        """Put down, for the result, which devices the controller has subscribed."""
        had = self.record.devices
        had += [name for name in map(str, addresses) if name not in had]

    def choose_readers(self) -> None:
        """To be called whenever `clocks`, or the mode of one of them, has changed.

        An outsider is waited for at the earliest of its connections that is in pull mode, unless it
        is free. A program is waited for until it waits itself, at whichever connection: a process
        that reads several in turn cannot ask at the others meanwhile. Where some of its processes
        drive, the others look on.
        """
        open_ones = [connection for connection in self.clocks if connection.is_open]
        pulling = [one for one in open_ones if one.session.mode is DataMode.PULL]
        if not self.launched:
            self.readers = [] if self.free else pulling[:1]
            return
        drivers = {self.origins.get(one) for one in open_ones if one in self.driving}
        self.readers = [one for one in pulling if not drivers or self.origins.get(one) in drivers]
