"""The crew: every robot's controller, from its start to its end, and the wait for all of them.

The world moves on when every robot's clock has asked for data. What is decided here depends on
what the controllers say and do, never on which of them is quicker; the wall clock only ends the
wait for a controller that hangs.
"""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from time import monotonic
from typing import Literal

from player.codes import DataMode, Interface
from player.server import Connected, Connection, Disconnected, Server, ServerEvent
from player.session import (
    Command,
    DataRequested,
    ModeChanged,
    Request,
    Subscribed,
    Unsubscribed,
)
from sim.devices.switchboard import Port, Switchboard
from sim.fleet.driver import Driver
from sim.fleet.fleet import Fleet, Launch
from sim.result import ControllerState

HINT_AFTER = 5.0
"""Wall-clock seconds after which a wait for one of several clocks of one client is explained."""


@dataclass(frozen=True)
class Patience:
    """Wall-clock seconds that a controller may keep the others waiting."""

    reading: float = 60.0

    @property
    def entry(self) -> float:
        """Until its first request: it may have much to load."""
        return 2 * self.reading


class Crew:
    """Drivers by robot. `stop(robot)` is called when a robot's controller has let go of it."""

    def __init__(
        self,
        server: Server,
        switchboard: Switchboard,
        fleet: Fleet,
        *,
        patience: Patience,
        clock: Literal["all", "any"],
        stop: Callable[[int], None],
        say: Callable[[str], None],
    ) -> None:
        self.server = server
        self.switchboard = switchboard
        self.fleet = fleet
        self.patience = patience
        self.any_clock = clock == "any"
        self.stop = stop
        self.say = say
        self.drivers: list[Driver] = []
        self.behind: dict[int, None] = {}  # robots whose controllers the world waits for
        self.interrupted = False
        self.waiting = False  # for clients: a signal that comes now need not break off anything
        self.paused: Callable[[], bool] = lambda: False
        self.hinted = False
        fleet.attach(server.watch, server.unwatch)

    # -- entries ----------------------------------------------------------------------------

    def add(self, driver: Driver) -> None:
        """A robot has entered; its controller, if any, is waited for until its first request."""
        assert driver.robot == len(self.drivers)
        self.drivers.append(driver)
        if driver.kind != "none":
            driver.since = monotonic()
            self.behind[driver.robot] = None

    def launch(
        self, driver: Driver, launch: Launch, environment: dict[str, str], port: Port | None
    ) -> None:
        """Start a controller's process; with `port`, it inherits a socket pair to it."""
        theirs: socket.socket | None = None
        if port is not None:
            ours, theirs = socket.socketpair()
            driver.connection = self.server.adopt(ours, port.directory, peer=driver.record.name)
        self.fleet.start(driver.robot, driver.record.name, launch, environment, theirs)

    # -- the wait ---------------------------------------------------------------------------

    def wait(self, timeout: float | None = None) -> bool:
        """Serve requests until the world may move on; False if `timeout` seconds pass first."""
        until = None if timeout is None else monotonic() + timeout
        self.server.flush()
        while not self.interrupted:
            if until is None and self.ready():
                return True
            left = self.time_left() if until is None else until - monotonic()
            if until is not None and left <= 0:
                return False
            self.waiting = True
            events = self.server.poll(max(0.0, min(left, 1.0)))
            self.waiting = False
            self.take(events)
            self.server.flush()
            self.notice_ends()
            if until is None and not self.paused():
                self.notice_hung()
        return False

    def ready(self) -> bool:
        """Whether nobody is waited for any more."""
        if self.paused():
            return False
        if not self.behind:
            return True
        if not self.any_clock:
            return False
        starting = any(not self.drivers[robot].asked for robot in self.behind)
        clocks = [clock for driver in self.drivers if (clock := driver.clock()) is not None]
        return not starting and any(clock.session.waiting for clock in clocks)

    def next_round(self) -> None:
        """Data has been published: every clock that has been served is waited for again."""
        now = monotonic()
        for driver in self.drivers:
            if not driver.clocks:
                continue
            clock = driver.clock()
            if clock is not None and not clock.session.waiting:
                driver.since = now
                self.behind[driver.robot] = None

    def time_left(self) -> float:
        """Seconds until the patience with somebody ends."""
        now = monotonic()
        left = [self.limit(self.drivers[robot]) - now for robot in self.behind]
        return min(left, default=1.0)

    def limit(self, driver: Driver) -> float:
        return driver.since + (self.patience.reading if driver.asked else self.patience.entry)

    def notice_hung(self) -> None:
        """Give up those that have kept the others waiting for too long."""
        now = monotonic()
        if not self.hinted and not self.any_clock:
            self.hint(now)
        for robot in [robot for robot in self.behind if self.limit(self.drivers[robot]) <= now]:
            driver = self.drivers[robot]
            waited = now - driver.since
            self.say(f"{driver.record.name}: hung: nothing for {waited:.0f} s, its robot stops")
            if driver.launched:
                self.fleet.kill(robot)
            if driver.connection is not None and driver.connection.is_open:
                self.take(self.server.poll(0))
            for connection in [driver.connection, *driver.clocks]:
                if connection is not None and connection.is_open:
                    self.leave(connection)
                    connection.close()
            self.end(driver, "hung", None, f"kept the others waiting for {waited:.0f} s")

    def hint(self, now: float) -> None:
        """One client that reads several robots in turn waits for ever: say what would help."""
        waiting = {
            clock.peer.rpartition(":")[0]
            for driver in self.drivers
            if driver.kind == "external"
            and (clock := driver.clock()) is not None
            and clock.session.waiting
        }
        for robot in self.behind:
            driver = self.drivers[robot]
            clock = driver.clock()
            if (
                driver.kind == "external"
                and clock is not None
                and now - driver.since > HINT_AFTER
                and clock.peer.rpartition(":")[0] in waiting
            ):
                self.hinted = True
                self.say(
                    f"{driver.record.name}: its client has not asked for data for "
                    f"{HINT_AFTER:.0f} s while others wait. A program that reads several robots "
                    "in turn needs `player: {clock: any}` in the world file"
                )
                return

    # -- events -----------------------------------------------------------------------------

    def take(self, events: Iterable[tuple[Connection, ServerEvent]]) -> None:
        """Obey and answer what clients have sent."""
        for connection, event in events:
            kind = type(event)
            if kind is DataRequested:
                assert isinstance(event, DataRequested)
                self.asked(connection, event.served)
            elif kind is Command:
                assert isinstance(event, Command)
                self.switchboard.command(connection, event)
            elif kind is Request:
                assert isinstance(event, Request)
                self.switchboard.request(connection, event)
            elif kind is Subscribed:
                assert isinstance(event, Subscribed)
                self.subscribed(connection, event)
            elif kind is Unsubscribed:
                assert isinstance(event, Unsubscribed)
                device = self.switchboard.unsubscribe(connection, event.addr)
                if event.addr.interf == Interface.POSITION2D:
                    self.release(connection, device.robot)
            elif kind is ModeChanged:
                self.mode_changed(connection)
            elif kind is Disconnected:
                assert isinstance(event, Disconnected)
                self.disconnected(connection, event.reason)
            elif kind is Connected:
                pass

    def robots_of(self, connection: Connection) -> list[Driver]:
        """The robots whose devices a connection can reach."""
        return [self.drivers[robot] for robot in self.switchboard.port(connection).robots]

    def asked(self, connection: Connection, served: bool) -> None:
        for driver in self.robots_of(connection):
            if driver.kind == "none":
                continue
            clock = driver.clock()
            if clock is connection:
                driver.asked = True
                if not served:
                    self.behind.pop(driver.robot, None)
            elif clock is None and not driver.asked and not driver.ending:
                driver.asked = True  # reads without driving: an onlooker, and no clock
                self.behind.pop(driver.robot, None)

    def subscribed(self, connection: Connection, event: Subscribed) -> None:
        device = self.switchboard.subscribe(connection, event.addr)
        driver = self.drivers[device.robot]
        if connection is driver.connection or driver.kind in ("command", "external"):
            name = str(event.addr)
            if name not in driver.record.devices:
                driver.record.devices.append(name)
        if event.addr.interf == Interface.POSITION2D and driver.kind != "none":
            driver.clocks.append(connection)
            driver.ending = False
            if driver.kind == "external" and driver.record.state == "lost":
                driver.record.state, driver.record.error = "running", None
                self.say(f"{driver.record.name}: a client has come back ({connection.peer})")
            if connection.session.mode == DataMode.PUSH:
                driver.asked = True  # it is sent data without asking
                self.behind.pop(driver.robot, None)
            elif driver.clock() is connection and not connection.session.waiting:
                driver.since = monotonic()
                self.behind[driver.robot] = None

    def mode_changed(self, connection: Connection) -> None:
        for driver in self.drivers:
            if connection not in driver.clocks:
                continue
            clock = driver.clock()
            if clock is None:
                driver.asked = True
                self.behind.pop(driver.robot, None)
            elif not clock.session.waiting:
                driver.since = monotonic()
                self.behind[driver.robot] = None

    def leave(self, connection: Connection) -> None:
        """A connection is gone: its subscriptions end."""
        self.switchboard.forget(connection)

    def release(self, connection: Connection, robot: int) -> None:
        """A connection does not drive a robot any more."""
        driver = self.drivers[robot]
        if connection not in driver.clocks:
            return
        driver.clocks.remove(connection)
        clock = driver.clock()
        if clock is not None:
            if clock.session.waiting:
                self.behind.pop(robot, None)
        elif driver.running and not driver.ending:
            self.behind.pop(robot, None)
        if not driver.clocks:
            self.stop(robot)

    def disconnected(self, connection: Connection, reason: str) -> None:
        drove = [driver for driver in self.drivers if connection in driver.clocks]
        if "not Player's protocol" in reason:
            self.say(f"{connection.peer}: {reason}")
        self.leave(connection)
        for driver in drove:
            self.release(connection, driver.robot)
        for driver in {d.robot: d for d in [*drove, *self.robots_of(connection)]}.values():
            if not driver.running or driver.clock() is not None:
                continue
            if driver.launched and (connection is driver.connection or driver in drove):
                # its process must end, or connect again, before the world moves on: which of
                # the two comes first must not depend on the machine's load
                driver.ending = True
                driver.since = monotonic()
                self.behind[driver.robot] = None
            elif driver.kind == "external" and driver in drove:
                self.end(driver, "lost", None, f"{connection.peer}: {reason}")

    # -- ends -------------------------------------------------------------------------------

    def notice_ends(self) -> None:
        """Take note of processes that have ended."""
        for robot, code in self.fleet.take_ended().items():
            driver = self.drivers[robot]
            self.drain(driver)
            if not driver.running:
                driver.record.exit_code = code
                continue
            if code == 0:
                self.end(driver, "finished", 0, None)
            else:
                self.end(driver, "failed", code, self.describe(robot, code))
                self.say(f"{driver.record.name}: failed: {self.describe(robot, code, brief=True)}")

    def drain(self, driver: Driver) -> None:
        """Take what a process wrote before its end, then close its connections."""
        connection = driver.connection
        if connection is None:
            return
        for _ in range(64):
            if not connection.is_open:
                break
            events = self.server.poll(0)
            self.take(events)
            self.server.flush()
            if not any(one is connection for one, _ in events):
                break
        if connection.is_open:
            connection.close()
            self.disconnected(connection, "its process has ended")

    def describe(self, robot: int, code: int, brief: bool = False) -> str:
        """What is known of a process's failure."""
        how = f"exit code {code}" if code >= 0 else f"killed by signal {-code}"
        if self.fleet.lost:
            how += " (the fork server has died)"
        lines = self.fleet.outputs[robot].last_lines()
        if brief:
            lines = lines.rpartition("\n")[2]
        return f"{how}: {lines}" if brief and lines else f"{how}\n{lines}".strip()

    def end(
        self, driver: Driver, state: ControllerState, code: int | None, error: str | None
    ) -> None:
        """A controller's run is over; its robot stops."""
        driver.record.state = state
        driver.record.exit_code = code
        driver.record.error = error
        driver.ending = False
        self.behind.pop(driver.robot, None)
        self.stop(driver.robot)

    @property
    def running(self) -> list[Driver]:
        """The controllers that have not ended."""
        return [driver for driver in self.drivers if driver.running]

    def dismiss(self, grace: float = 1.0) -> None:
        """The run is over: tell everybody, give programs a moment, end what is left."""
        until = monotonic() + grace
        for connection in list(self.server.connections):
            connection.close()
        while self.fleet.pids and not self.fleet.lost and (left := until - monotonic()) > 0:
            self.server.poll(min(left, 0.1))
            self.fleet.take_ended()
        self.fleet.close()
        self.server.close()
