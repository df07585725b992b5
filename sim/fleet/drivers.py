"""Who drives which robot: how a controller comes, lets its robot go, and ends.

Rules: a robot that nobody drives any more stops. A controller ends once; only a client from outside
may come back.
"""

from __future__ import annotations

from collections.abc import Callable

from player.server import Connection
from sim.fleet.clocks import Clocks
from sim.fleet.driver import Driver
from sim.fleet.origin import origin
from sim.result import ControllerState
from sim.robot import Robot

FAILURES = ("failed", "hung", "lost")


class Drivers:
    """The drivers of a run's robots. `stop(robot)` is called when nobody drives one any more.

    `fail_fast`: the first that fails makes the whole run `failed`.
    """

    def __init__(
        self,
        robots: list[Robot],
        clocks: Clocks,
        stop: Callable[[Robot], None],
        *,
        fail_fast: bool = False,
    ) -> None:
        self.robots = robots
        self.clocks = clocks
        self.stop = stop
        self.fail_fast = fail_fast
        self.ends = 0  # how often a controller has ended
        self.failed = False  # and nobody is to be waited for any more
        self._one_running: Driver | None = None  # one that had not ended when it was looked for

    @property
    def any_running(self) -> bool:
        """Whether there is a controller that has not ended."""
        if self._one_running is None or not self._one_running.running:
            running = (robot.driver for robot in self.robots if robot.driver.running)
            self._one_running = next(running, None)
        return self._one_running is not None

    def enter(self, robot: Robot) -> None:
        """A robot has entered; its controller, if any, is waited for until its first request."""
        if robot.driver.kind not in ("none", "function"):
            self.clocks.enter(robot.driver)

    def is_own(self, driver: Driver, connection: Connection) -> bool:
        """Whether a connection is that of a process of ours, and not of somebody who looks on."""
        if driver.kind == "program":
            return driver.running and connection is driver.connection
        if connection not in driver.origins:
            driver.origins[connection] = origin(connection, driver.environment)
        return driver.running and driver.origins[connection] != 0

    def release(self, connection: Connection, driver: Driver) -> None:
        """A connection does not drive a robot any more."""
        if driver.commander is connection:
            driver.commander = None
            self.stop(self.robots[driver.robot])

    def end(
        self, driver: Driver, state: ControllerState, code: int | None, error: str | None
    ) -> None:
        """A controller's run is over; its robot stops, for good unless a client may come back."""
        self.ends += 1
        robot = self.robots[driver.robot]
        if driver.kind == "external":
            self.stop(robot)  # while it counts as running: it is not to become a body
        driver.record.state = state
        driver.record.exit_code = code
        driver.record.error = error
        self.failed |= self.fail_fast and state in FAILURES
        driver.commander = None
        self.clocks.retire(driver)
        if driver.kind != "external":
            self.stop(robot)
