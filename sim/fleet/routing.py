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
from sim.fleet.drivers import Drivers
from sim.fleet.outsiders import Outsiders

MOVING = frozenset((int(Interface.POSITION2D), int(Interface.DIO)))
"""Interfaces whose commands go on to have an effect after their client has gone."""


class Router:
    """Takes what a server has heard. `say(line)` is given what is meant for people, and
    `show_again(connection)` hands a client the present readings while the world stands.
    """

    def __init__(
        self,
        switchboard: Switchboard,
        drivers: Drivers,
        say: Callable[[str], None],
        show_again: Callable[[Connection], None],
    ) -> None:
        self.switchboard = switchboard
        self.drivers = drivers
        self.clocks = drivers.clocks
        self.say = say
        self.show_again = show_again
        self.outsiders = Outsiders(switchboard, drivers, say)
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
            case DataRequested():
                if connection is self.switchboard.paused_by:
                    self.answer_pauser(connection)
                if self.outsiders.expected:
                    self.first_reading(connection)
                if not event.served and connection.session.waiting:
                    self.clocks.asked(connection)
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
                self.outsiders.turned(connection)
            case Disconnected():
                self.disconnected(connection, event.reason)
            case Connected() | Ignored() | Malformed():
                pass  # it has said nothing yet, or nothing to us
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
            if self.switchboard.paused_by is connection:
                self.answer_pauser(connection)
        if event.addr.interf in MOVING:
            device.robot.driver.commander = connection

    def answer_pauser(self, connection: Connection) -> None:
        """Who has stopped the clock is no wait for: it has the present reading, if it asks.

        It could not end the pause else. The world waits for it again when it goes on.
        """
        if not connection.session.waiting:
            return
        self.show_again(connection)
        for driver in self.clocks.driven.get(connection, {}).values():
            if connection in driver.readers:
                self.clocks.wait_for(driver)

    def first_reading(self, connection: Connection) -> None:
        """It may be a controller's first; a program may read what is not its robot's own."""
        self.outsiders.asks(connection)
        if connection in self.clocks.driven:
            return
        for robot in self.switchboard.port(connection).robots:
            driver = self.clocks.unasked.get(robot.index)
            if driver is None or driver.clocks or not driver.launched:
                continue
            if self.drivers.is_own(driver, connection):
                self.clocks.join(connection, driver, drives=False)

    def subscribed(self, connection: Connection, event: Subscribed) -> None:
        """A connection has subscribed a device; it may be one of the robot's controller."""
        device = self.switchboard.subscribe(connection, event.addr)
        driver = device.robot.driver
        drives = event.addr.interf == Interface.POSITION2D
        if driver.kind == "external":
            self.outsiders.subscribed(connection, device.robot, drives)
        elif driver.launched and self.drivers.is_own(driver, connection):
            self.clocks.join(connection, driver, drives)
        if connection in driver.clocks:
            driver.note_devices(self.switchboard.addresses(connection, device.robot))

    def unsubscribed(self, connection: Connection, event: Unsubscribed) -> None:
        """A connection has done with a device; an outsider perhaps with the robot too."""
        device = self.switchboard.unsubscribe(connection, event.addr)
        driver = device.robot.driver
        if event.addr.interf == Interface.POSITION2D:
            self.clocks.undrive(connection, driver)
            self.drivers.release(connection, driver)
        if driver.kind == "external":
            self.outsiders.unsubscribed(connection, device.robot)

    def disconnected(self, connection: Connection, reason: str) -> None:
        """A connection is gone, and with it the commands that it has given."""
        if "not Player's protocol" in reason:
            self.say(f"{connection.peer}: {reason}")
        drove = list(self.clocks.driven.get(connection, {}).values())
        self.switchboard.forget(connection)
        for robot in self.switchboard.port(connection).robots:
            driver = robot.driver
            if driver.kind == "external":
                self.drivers.release(connection, driver)
                self.outsiders.disconnected(connection, robot, reason)
                continue
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
