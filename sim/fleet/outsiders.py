"""Clients from outside: which of them is a robot's clock, and what a robot is when they have gone.

Rules: the first that asks for data of a robot without a clock is its clock, whatever it has
subscribed; who is pushed its data asks all the time. Who has subscribed the drive comes before
those who only read, from its own first request on; all others look on. A clock that has
unsubscribed all of the robot's devices has finished; one that breaks off, or goes before it had a
reading, is lost.
"""

from __future__ import annotations

from collections.abc import Callable

from player.codes import DataMode, Interface
from player.server import Connection
from sim.devices.switchboard import Switchboard
from sim.fleet.driver import Driver
from sim.fleet.drivers import Drivers
from sim.robot import Robot

SILENT = frozenset(map(int, (Interface.SIMULATION, Interface.SPEECH, Interface.GRAPHICS2D)))
"""Interfaces that send no data: who has subscribed nothing else asks in vain."""


class Outsiders:
    """The comings and goings of clients at robots that are `external`."""

    def __init__(
        self, switchboard: Switchboard, drivers: Drivers, say: Callable[[str], None]
    ) -> None:
        self.switchboard = switchboard
        self.drivers = drivers
        self.clocks = drivers.clocks
        self.say = say
        self.late: set[Connection] = set()
        """Who has subscribed a drive while a client that only reads is the clock."""

    @property
    def expected(self) -> bool:
        """Whether some robot is without a clock, or may get another one."""
        return bool(self.clocks.unasked or self.late)

    def reads(self, connection: Connection, robot: Robot) -> bool:
        """Whether a connection has subscribed something of the robot that sends data."""
        addresses = self.switchboard.addresses(connection, robot)
        return any(addr.interf not in SILENT for addr in addresses)

    # -- they come --------------------------------------------------------------------------

    def subscribed(self, connection: Connection, robot: Robot, drives: bool) -> None:
        """A connection has subscribed a device of the robot; `drives`: its drive."""
        driver = robot.driver
        if not self.reads(connection, robot):
            return
        if not driver.running:
            driver.asked = False  # it may come back
            self.clocks.unasked[robot.index] = driver
        if driver.free:
            connection.session.keep_newest()  # it may sleep: it is to read how things are now
        driver.came.setdefault(connection, self.switchboard.context.time)
        pushed = connection.session.mode is DataMode.PUSH
        clock = driver.clock
        if drives:
            if pushed or clock is None or clock is connection or clock in driver.driving:
                self.dismiss_readers(connection, driver)
            else:
                self.late.add(connection)
            self.come(connection, driver, drives=True)
        elif pushed and robot.index in self.clocks.unasked and not driver.clocks:
            self.come(connection, driver, drives=False)

    def asks(self, connection: Connection) -> None:
        """A connection asks for data, while somebody is expected."""
        if connection in self.late:
            self.take_over(connection)
        for robot in self.switchboard.port(connection).robots:
            driver = robot.driver
            if (
                driver.kind == "external"
                and robot.index in self.clocks.unasked
                and not driver.clocks
                and connection in driver.came
            ):
                self.come(connection, driver, drives=False)

    def turned(self, connection: Connection) -> None:
        """A connection has changed its mode: who is pushed its data need not ask for it."""
        if connection.session.mode is not DataMode.PUSH:
            return
        if connection in self.late:
            self.take_over(connection)
        if self.clocks.unasked:
            self.asks(connection)

    def take_over(self, connection: Connection) -> None:
        """A client that drives asks for the first time: those who only read look on from now."""
        self.late.discard(connection)
        for driver in list(self.clocks.driven.get(connection, {}).values()):
            if connection in driver.driving:
                self.dismiss_readers(connection, driver)

    def dismiss_readers(self, driving: Connection, driver: Driver) -> None:
        """Those who only read are not the robot's controller: another one drives."""
        for connection in list(driver.clocks):
            if connection is not driving and connection not in driver.driving:
                self.clocks.leave(connection, driver)

    def come(self, connection: Connection, driver: Driver, drives: bool) -> None:
        """A connection is the robot's controller, or one of several."""
        if not driver.running:
            driver.record.state = "running"
            self.say(f"{driver.record.name}: a client has come ({connection.peer})")
        driver.record.error = None
        driver.note_devices(
            self.switchboard.addresses(connection, self.drivers.robots[driver.robot])
        )
        self.clocks.join(connection, driver, drives)

    # -- they go ----------------------------------------------------------------------------

    def unsubscribed(self, connection: Connection, robot: Robot) -> None:
        """A connection has unsubscribed a device of the robot."""
        if self.reads(connection, robot):
            return
        driver = robot.driver
        unserved = connection.session.waiting and self.is_new(connection, driver)
        left = self.leave(connection, driver)
        if left and driver.asked and unserved:
            self.drivers.end(driver, "lost", None, self.early(connection, "it has unsubscribed"))
        elif left and driver.asked:
            self.drivers.end(driver, "finished", None, None)
        elif robot.index in self.clocks.unasked and not driver.clocks:
            self.note(connection, driver, "it has unsubscribed")

    def disconnected(self, connection: Connection, robot: Robot, reason: str) -> None:
        """A connection is gone."""
        driver = robot.driver
        known, new = connection in driver.came, self.is_new(connection, driver)
        if self.leave(connection, driver):
            error = self.early(connection, reason) if new else f"{connection.peer}: {reason}"
            self.drivers.end(driver, "lost", None, error)
        elif known and robot.index in self.clocks.unasked and not driver.clocks:
            self.note(connection, driver, reason)

    def leave(self, connection: Connection, driver: Driver) -> bool:
        """Whether the robot's controller has gone with this connection."""
        driver.came.pop(connection, None)
        was_one = connection in driver.clocks
        self.clocks.leave(connection, driver)
        if connection not in self.clocks.driven:
            self.late.discard(connection)
        return was_one and driver.running and not driver.clocks

    def is_new(self, connection: Connection, driver: Driver) -> bool:
        """Whether no simulated time has passed since a connection came."""
        return driver.came.get(connection) == self.switchboard.context.time

    def early(self, connection: Connection, reason: str) -> str:
        """What is to be told of a client that went without a reading."""
        return f"{connection.peer} went away before its robot's first tick: {reason}"

    def note(self, connection: Connection, driver: Driver, reason: str) -> None:
        """A client went before it asked for anything: the robot waits for another."""
        driver.record.error = self.early(connection, reason)
        self.say(f"{driver.record.name}: {driver.record.error}")
