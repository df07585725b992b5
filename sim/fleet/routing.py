"""The way of clients' messages: to the devices, and to whoever waits for the clients.

Rules: an event of one connection is handled before the next. Who is waited for follows from what
clients say and from where they come, never from when. What a client sends may cost it its
connection, and nobody else anything.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable
from time import monotonic
from typing import assert_never

from player.codes import Interface
from player.events import (
    Command,
    DataRequested,
    Ignored,
    Malformed,
    ModeChanged,
    Request,
    Subscribed,
    Unsubscribed,
)
from player.server import Connected, Connection, Disconnected, ServerEvent
from sim.devices.switchboard import Switchboard
from sim.fleet.driver import Driver
from sim.fleet.drivers import Drivers

MOVING = frozenset((int(Interface.POSITION2D), int(Interface.DIO)))
"""Interfaces whose commands go on to have an effect after their client has gone."""


class Router:
    """Takes what a server has heard. `say(line)` is given what is meant for people."""

    def __init__(
        self, switchboard: Switchboard, drivers: Drivers, say: Callable[[str], None]
    ) -> None:
        self.switchboard = switchboard
        self.drivers = drivers
        self.clocks = drivers.clocks
        self.say = say
        self.expelled: set[Connection] = set()  # nothing more is taken from them
        self.paused_at = 0.0  # wall-clock time

    def take(self, events: Iterable[tuple[Connection, ServerEvent]]) -> None:
        """Obey and answer what clients have sent."""
        for connection, event in events:
            if connection in self.expelled:
                continue
            try:
                self.route(connection, event)
            except Exception as error:
                self.expel(connection, error)

    def route(self, connection: Connection, event: ServerEvent) -> None:
        """Obey or answer one message, or take note of where a connection has come to."""
        match event:
            case DataRequested(served=False):
                self.clocks.asked(connection)
                if self.clocks.unasked:
                    self.first_reading(connection)
            case Command():
                self.command(connection, event)
            case Request():
                self.switchboard.request(connection, event)
            case Subscribed():
                self.subscribed(connection, event)
            case Unsubscribed():
                self.unsubscribed(connection, event)
            case ModeChanged():
                for driver in self.clocks.driven.get(connection, {}).values():
                    self.clocks.choose(driver)
            case Disconnected():
                self.disconnected(connection, event.reason)
            case DataRequested() | Connected() | Ignored() | Malformed():
                pass  # it has its data already; it has said nothing yet, or nothing to us
            case never:
                assert_never(never)

    def expel(self, connection: Connection, error: Exception) -> None:
        """What a client has sent has led to an error of ours: it loses its connection, no more.

        A controller that has lost it so is `lost` in the result, once its process has ended.
        """
        self.expelled.add(connection)
        what = f"what it sent has led to an error in the simulator ({error!r})"
        trace = "".join(traceback.format_exception(error)).rstrip()
        self.say(f"{connection.peer}: {what}: its connection is closed\n{trace}")
        if not connection.is_open:
            return
        for driver in self.clocks.driven.get(connection, {}).values():
            driver.lost = what  # read when its process has ended, if that is ours
        self.close(connection)

    def close(self, connection: Connection) -> None:
        """Close a connection from our side."""
        connection.close()
        self.disconnected(connection, "closed by the simulator")

    # -- one event each ---------------------------------------------------------------------

    def command(self, connection: Connection, event: Command) -> None:
        """A command goes to its device, and who gave it commands the robot."""
        paused_by = self.switchboard.paused_by
        device = self.switchboard.command(connection, event)
        if self.switchboard.paused_by is not paused_by:
            self.paused_at = monotonic()
        if event.addr.interf in MOVING:
            device.robot.driver.commander = connection

    def first_reading(self, connection: Connection) -> None:
        """A program may read what is not its robot's own; an outsider that does, looks on."""
        if connection in self.clocks.driven:
            return
        for robot in self.switchboard.port(connection).robots:
            driver = self.clocks.unasked.get(robot.index)
            if driver is None or driver.clocks:
                continue
            if driver.kind == "external" and driver.drives:
                continue  # its client is the one that will drive it
            if not self.drivers.is_own(driver, connection):
                continue
            if driver.launched:
                self.clocks.join(connection, driver, drives=False)
            else:
                self.clocks.has_asked(driver)

    def subscribed(self, connection: Connection, event: Subscribed) -> None:
        """A connection has subscribed a device; it may be one of the robot's controller."""
        device = self.switchboard.subscribe(connection, event.addr)
        driver = device.robot.driver
        drives = event.addr.interf == Interface.POSITION2D
        if (drives or driver.launched) and self.drivers.is_own(driver, connection):
            if driver.kind == "external" and driver.record.state in ("lost", "hung"):
                driver.record.state, driver.record.error = "running", None
                self.say(f"{driver.record.name}: a client has come ({connection.peer})")
            self.clocks.join(connection, driver, drives)
        if connection in driver.clocks or not (driver.drives or driver.launched):
            devices = self.switchboard.port(connection).devices
            own = [a for a in connection.session.subscribed if devices[a].robot is device.robot]
            note_devices(driver, map(str, own))

    def unsubscribed(self, connection: Connection, event: Unsubscribed) -> None:
        """A connection has done with a device; if that was the drive, with the robot too."""
        device = self.switchboard.unsubscribe(connection, event.addr)
        if event.addr.interf == Interface.POSITION2D:
            self.clocks.undrive(connection, device.robot.driver)
            self.drivers.release(connection, device.robot.driver)

    def disconnected(self, connection: Connection, reason: str) -> None:
        """A connection is gone, and with it the commands that it has given."""
        if "not Player's protocol" in reason:
            self.say(f"{connection.peer}: {reason}")
        drove = list(self.clocks.driven.get(connection, {}).values())
        self.switchboard.forget(connection)
        for robot in self.switchboard.port(connection).robots:
            driver = robot.driver
            driver.origins.pop(connection, None)
            left = driver in drove or connection is driver.connection
            alone = all(other is connection for other in driver.clocks)
            ends = left and alone and driver.launched and driver.running
            driver.ending |= ends
            self.clocks.leave(connection, driver)
            self.drivers.release(connection, driver)
            if ends:
                # which comes first, the end of the connection or that of the process, must not
                # depend on the machine's load: the world stands until both are known
                self.clocks.wait_for(driver)
        for driver in drove:
            if driver.kind == "external" and driver.running and not driver.clocks:
                self.drivers.end(driver, "lost", None, f"{connection.peer}: {reason}")


def note_devices(driver: Driver, names: Iterable[str]) -> None:
    """Put down, for the result, which devices a controller has subscribed."""
    driver.record.devices += [name for name in names if name not in driver.record.devices]
