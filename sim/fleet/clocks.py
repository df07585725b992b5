"""Whom the world waits for: every robot's clock, and whether it has asked for data."""

from __future__ import annotations

from time import monotonic
from typing import Literal

from player.server import Connection
from sim.fleet.driver import Driver
from sim.fleet.sleeping import Sleeping

ClockMode = Literal["all", "any", "free"]


class Clocks:
    """The robots' clocks, and those of them that the world waits for.

    `mode`: with `all` the world waits for every clock; with `any`, one that asks for data is enough
    for it to move on, once all have come; with `free` nobody waits for clients from outside.
    """

    def __init__(self, mode: ClockMode = "all") -> None:
        self.mode = mode
        self.behind: dict[int, Driver] = {}  # robots whose controllers are waited for
        self.clocked: dict[int, Driver] = {}  # robots that have a clock
        self.unasked: dict[int, Driver] = {}  # robots whose controllers have not asked yet
        self.driven: dict[Connection, dict[int, Driver]] = {}  # by controllers' connections
        self.sleeping: Sleeping | None = None  # looks for clients that sleep, where that matters

    def enter(self, driver: Driver) -> None:
        """A robot has entered: its controller is waited for until its first request."""
        driver.free = self.mode == "free" and not driver.launched
        self.unasked[driver.robot] = driver
        if not driver.free:
            self.wait_for(driver)

    def ready(self) -> bool:
        """Whether nobody is waited for any more."""
        if not self.behind:
            return True
        if self.mode != "any" or any(d.starting or d.ending for d in self.behind.values()):
            return False
        return any(driver.asking for driver in self.clocked.values())

    def next_round(self) -> None:
        """Data has been published: every clock that has been served is waited for again."""
        now = monotonic()
        behind = self.behind
        for robot, driver in self.clocked.items():
            if not driver.asking:
                driver.since = now
                behind[robot] = driver

    def wait_for(self, driver: Driver) -> None:
        """The world does not move on before this controller has asked, from now on."""
        driver.since = monotonic()
        self.behind[driver.robot] = driver

    def has_asked(self, driver: Driver) -> None:
        """The world need not wait for this controller, this time."""
        driver.asked = True
        if self.unasked:
            self.unasked.pop(driver.robot, None)
        self.behind.pop(driver.robot, None)

    def asked(self, connection: Connection) -> None:
        """A connection waits for data."""
        drives = self.driven.get(connection)
        if drives is None:
            return
        for driver in drives.values():
            if connection in driver.readers:
                if self.sleeping is not None:
                    self.sleeping.asked(driver)
                self.has_asked(driver)

    def join(self, connection: Connection, driver: Driver, drives: bool) -> None:
        """A controller's connection has come; `drives`: it has subscribed the robot's drive."""
        if connection not in driver.clocks:
            self.driven.setdefault(connection, {})[driver.robot] = driver
            driver.clocks.append(connection)
        if drives:
            driver.driving.add(connection)
        driver.ending = False
        self.choose(driver)

    def undrive(self, connection: Connection, driver: Driver) -> None:
        """A connection has unsubscribed the robot's drive: it is still the controller's."""
        if connection in driver.driving:
            driver.driving.discard(connection)
            self.choose(driver)

    def leave(self, connection: Connection, driver: Driver) -> None:
        """It is not one of the controller's any more."""
        if connection not in driver.clocks:
            return
        driver.clocks.remove(connection)
        driver.driving.discard(connection)
        drives = self.driven[connection]
        del drives[driver.robot]
        if not drives:
            del self.driven[connection]
        self.choose(driver)

    def choose(self, driver: Driver) -> None:
        """Find a robot's clock anew: its controller's connections, or their modes, have changed."""
        before = driver.readers
        driver.choose_readers()
        if driver.readers:
            self.clocked[driver.robot] = driver
            if driver.asking:
                self.has_asked(driver)
            elif driver.readers != before:
                self.wait_for(driver)
            return
        self.clocked.pop(driver.robot, None)
        if driver.pushed:
            self.has_asked(driver)
        elif not driver.launched:
            if driver.asked:
                self.behind.pop(driver.robot, None)
        elif driver.running and driver.robot not in self.behind:
            self.wait_for(driver)  # between two connections, or two subscriptions

    def retire(self, driver: Driver) -> None:
        """A controller's run is over: nobody waits for it, whatever is still connected."""
        driver.ending = False
        for connection in list(driver.clocks):
            self.leave(connection, driver)
        driver.came.clear()
        self.has_asked(driver)
