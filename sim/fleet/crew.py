"""The crew: every robot's controller, from its start to its end, and the wait for all of them.

The world moves on when every robot's clock has asked for data. What is decided here depends on
what the controllers say and do, never on which of them is quicker; the wall clock only ends the
wait for a controller that hangs.
"""

from __future__ import annotations

import socket
import traceback
from collections.abc import Callable, Iterable
from time import monotonic
from typing import Literal

from player.codes import Interface
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
from sim.fleet.clocks import Clocks
from sim.fleet.driver import Driver
from sim.fleet.fleet import Fleet, Launch
from sim.fleet.origin import origin
from sim.fleet.patience import Patience, hint, lacking
from sim.fleet.stack import own_frames
from sim.result import ControllerState

__all__ = ["Crew", "Patience"]

MOVING = frozenset((int(Interface.POSITION2D), int(Interface.DIO)))
"""Interfaces whose commands go on to have an effect after their client has gone."""

FAILURES = ("failed", "hung", "lost")

LAST_STACK = 1.0
"""Wall-clock seconds that a program has to print its stack."""

TOLD_AFTER = 2.0
"""Wall-clock seconds of waiting after which people want to know for whom."""

MOST_TOLD = 3
"""Controllers of which an interrupted run tells where they stood."""

LAST_WORDS = 256
"""Polls at the most for what a process wrote before its end: 16 MiB, above any socket's buffer."""


class Crew:
    """Drivers by robot. `stop(robot)` is called when nobody drives a robot any more."""

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
        self.clocks = Clocks(clock == "any")
        self.stop = stop
        self.say = say
        self.drivers: list[Driver] = []
        self.expelled: set[Connection] = set()  # nothing more is taken from them
        self.interrupted = False
        self.fail_fast = False
        self.failed = False  # and nobody is to be waited for any more
        self.while_waiting: Callable[[], None] | None = None
        self.waiting = False  # for clients: a signal that comes now need not break off anything
        self.paused: Callable[[], bool] = lambda: False
        self.paused_at = 0.0  # wall-clock time
        self.hinted = False
        self.look_at = 0.0  # when to look again who has used up the patience
        fleet.attach(server.watch, server.unwatch)

    # -- entries ----------------------------------------------------------------------------

    def add(self, driver: Driver) -> None:
        """A robot has entered; its controller, if any, is waited for until its first request."""
        assert driver.robot == len(self.drivers)
        self.drivers.append(driver)
        if driver.kind != "none":
            self.clocks.enter(driver)

    def launch(
        self, driver: Driver, launch: Launch, environment: dict[str, str], port: Port | None
    ) -> None:
        """Start a controller's process; with `port`, it inherits a socket pair to it."""
        theirs: socket.socket | None = None
        if port is not None:
            ours, theirs = socket.socketpair()
            driver.connection = self.server.adopt(ours, port.directory, peer=driver.record.name)
            self.clocks.join(driver.connection, driver, drives=False)
        driver.environment = environment
        self.fleet.start(driver.robot, driver.record.name, launch, environment, theirs)

    # -- the wait ---------------------------------------------------------------------------

    def wait(self, timeout: float | None = None) -> bool:
        """Serve requests until the world may move on; False if `timeout` seconds pass first.

        Whoever has something to say is heard at least once, also where nobody is waited for.
        What is said to clients may stay unwritten: it goes out with the data of the tick.
        """
        until = None if timeout is None else monotonic() + timeout
        heard = False
        while not (self.interrupted or self.failed):
            ready = until is None and self.ready()
            if ready and heard:
                return True
            left = (self.look_at if until is None else until) - monotonic()
            if until is not None and left <= 0:
                return False
            self.waiting = True
            events = self.server.poll(0.0 if ready else min(max(left, 0.0), 1.0))
            self.waiting = False
            heard = True
            self.take(events)
            self.notice_ends()
            if until is None and monotonic() >= self.look_at:
                self.notice_hung()
            if self.while_waiting is not None:
                self.while_waiting()
        return False

    def ready(self) -> bool:
        """Whether nobody is waited for any more."""
        return not self.paused() and self.clocks.ready()

    def next_round(self) -> None:
        """Data has been published: every clock that has been served is waited for again."""
        self.clocks.next_round()

    @property
    def behind(self) -> dict[int, Driver]:
        """The robots whose controllers the world waits for."""
        return self.clocks.behind

    @property
    def pushed_only(self) -> bool:
        """Whether clients drive robots and none of them, and no program, is a clock."""
        clocks = self.clocks
        return bool(clocks.driven) and not clocks.clocked and not clocks.behind

    def notice_hung(self) -> None:
        """Give up those that have kept the others waiting for too long."""
        now = monotonic()
        self.look_at = now + self.patience.look_after
        behind = list(self.behind.values())
        if self.paused():
            for driver in behind:
                driver.since = now
            if self.patience.limit_of_pause(self.paused_at) <= now:
                self.end_pause(now - self.paused_at)
            return
        if not self.hinted and not self.clocks.any_clock:
            line = hint(behind, self.clocks.clocked.values(), now)
            if line is not None:
                self.hinted = True
                self.say(line)
        for driver in behind:
            if self.patience.limit(driver) <= now:
                self.give_up(driver, now - driver.since)

    def give_up(self, driver: Driver, waited: float) -> None:
        """End a controller that hangs, unless it has moved in the meantime."""
        self.take(self.server.poll(0))
        if driver.robot not in self.behind:
            return
        name = driver.record.name
        why = lacking(driver)
        error = f"kept the others waiting for {waited:.0f} s: {why}"
        if driver.kind == "external" and not driver.clocks:
            error = f"no client that drives it has come within {waited:.0f} s"
            self.say(f"{name}: {error}; it stands still")
        else:
            self.say(f"{name}: hung: nothing for {waited:.0f} s ({why}), its robot stops")
            stack = self.stack(driver)
            for line in stack:
                self.say(f"[{name}] {line}")
            error = "\n".join([error, *stack])
        self.abandon(driver, error)

    def end_pause(self, waited: float) -> None:
        """End whoever has paused the world for too long, unless it goes on in the meantime."""
        pauser = self.switchboard.pauser
        self.take(self.server.poll(0))
        if pauser is None or self.switchboard.pauser is not pauser:
            return
        error = f"kept the world paused for {waited:.0f} s"
        drivers = list(self.clocks.driven.get(pauser, {}).values())
        for driver in drivers:
            self.say(f"{driver.record.name}: hung: {error}, its robot stops")
            self.abandon(driver, error)
        if not drivers:
            self.say(f"{pauser.peer}: {error}: its connection is closed")
        if pauser.is_open:
            self.close(pauser)

    def abandon(self, driver: Driver, error: str) -> None:
        """Wait for a controller no more: end its process, close its connections."""
        if driver.launched:
            self.fleet.kill(driver.robot)
        for connection in [driver.connection, *driver.clocks]:
            if connection is not None and connection.is_open:
                self.close(connection)
        self.end(driver, "hung", None, error)

    def stack(self, driver: Driver) -> list[str]:
        """Where a program stands, as lines; it ends thereby. None are known of a command."""
        if driver.kind != "program" or driver.robot not in self.fleet.pids:
            return []
        output = self.fleet.outputs[driver.robot]
        output.aside = []
        self.fleet.ask_stack(driver.robot)
        until = monotonic() + LAST_STACK
        while driver.robot in self.fleet.pids and (left := until - monotonic()) > 0:
            self.take(self.server.poll(left))
        lines, output.aside = output.aside, None
        return own_frames(lines)

    def tell_awaited(self) -> None:
        """The run is interrupted: say for whom it was waiting, if that was why."""
        now = monotonic()
        late = [driver for driver in self.behind.values() if now - driver.since > TOLD_AFTER]
        for driver in late[:MOST_TOLD]:
            name = driver.record.name
            self.say(f"{name}: waited for since {now - driver.since:.0f} s: {lacking(driver)}")
            for line in self.stack(driver):
                self.say(f"[{name}] {line}")

    # -- events -----------------------------------------------------------------------------

    def take(self, events: Iterable[tuple[Connection, ServerEvent]]) -> None:
        """Obey and answer what clients have sent."""
        for connection, event in events:
            if connection in self.expelled:
                continue
            try:
                self.obey(connection, event)
            except Exception as error:
                self.expel(connection, error)

    def obey(self, connection: Connection, event: ServerEvent) -> None:
        """Obey or answer one message, or take note of where a connection has come to."""
        kind = type(event)
        if kind is DataRequested:
            assert isinstance(event, DataRequested)
            if not event.served:
                self.clocks.asked(connection)
                if self.clocks.unasked:
                    self.first_reading(connection)
        elif kind is Command:
            assert isinstance(event, Command)
            pauser = self.switchboard.pauser
            device = self.switchboard.command(connection, event)
            if self.switchboard.pauser is not pauser:
                self.paused_at = monotonic()
            if event.addr.interf in MOVING:
                self.drivers[device.robot].commander = connection
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
                driver = self.drivers[device.robot]
                self.clocks.undrive(connection, driver)
                self.release(connection, driver)
        elif kind is ModeChanged:
            for driver in self.clocks.driven.get(connection, {}).values():
                self.clocks.choose(driver)
        elif kind is Disconnected:
            assert isinstance(event, Disconnected)
            self.disconnected(connection, event.reason)
        elif kind is Connected:
            pass

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

    def first_reading(self, connection: Connection) -> None:
        """A program may read what is not its robot's own; an outsider that does, looks on."""
        if connection in self.clocks.driven:
            return
        for robot in self.switchboard.port(connection).robots:
            driver = self.clocks.unasked.get(robot)
            if driver is None or driver.clocks:
                continue
            if driver.kind == "external" and driver.drives:
                continue  # its client is the one that will drive it
            if not self.is_own(driver, connection):
                continue
            if driver.launched:
                self.clocks.join(connection, driver, drives=False)
            else:
                self.clocks.has_asked(driver)

    def is_own(self, driver: Driver, connection: Connection) -> bool:
        """Whether a connection is the robot's controller's, and not of somebody who looks on."""
        if driver.kind == "program":
            return driver.running and connection is driver.connection
        if driver.kind == "command":
            if connection not in driver.origins:
                driver.origins[connection] = origin(connection, driver.environment)
            return driver.running and driver.origins[connection] != 0
        return driver.kind == "external"

    def subscribed(self, connection: Connection, event: Subscribed) -> None:
        """A connection has subscribed a device; it may be one of the robot's controller."""
        device = self.switchboard.subscribe(connection, event.addr)
        driver = self.drivers[device.robot]
        drives = event.addr.interf == Interface.POSITION2D
        if (drives or driver.launched) and self.is_own(driver, connection):
            if driver.kind == "external" and driver.record.state in ("lost", "hung"):
                driver.record.state, driver.record.error = "running", None
                self.say(f"{driver.record.name}: a client has come ({connection.peer})")
            self.clocks.join(connection, driver, drives)
        if connection in driver.clocks or not (driver.drives or driver.launched):
            devices = self.switchboard.port(connection).devices
            own = [a for a in connection.session.subscribed if devices[a].robot == driver.robot]
            note_devices(driver, map(str, own))

    def release(self, connection: Connection, driver: Driver) -> None:
        """A connection does not drive a robot any more."""
        if driver.commander is connection:
            driver.commander = None
            self.stop(driver.robot)

    def disconnected(self, connection: Connection, reason: str) -> None:
        """A connection is gone, and with it the commands that it has given."""
        if "not Player's protocol" in reason:
            self.say(f"{connection.peer}: {reason}")
        drove = list(self.clocks.driven.get(connection, {}).values())
        self.switchboard.forget(connection)
        for robot in self.switchboard.port(connection).robots:
            driver = self.drivers[robot]
            driver.origins.pop(connection, None)
            left = driver in drove or connection is driver.connection
            alone = all(other is connection for other in driver.clocks)
            ends = left and alone and driver.launched and driver.running
            driver.ending |= ends
            self.clocks.leave(connection, driver)
            self.release(connection, driver)
            if ends:
                # which comes first, the end of the connection or that of the process, must not
                # depend on the machine's load: the world stands until both are known
                self.clocks.wait_for(driver)
        for driver in drove:
            if driver.kind == "external" and driver.running and not driver.clocks:
                self.end(driver, "lost", None, f"{connection.peer}: {reason}")

    def close(self, connection: Connection) -> None:
        """Close a connection from our side."""
        connection.close()
        self.disconnected(connection, "closed by the simulator")

    # -- ends -------------------------------------------------------------------------------

    def notice_ends(self) -> None:
        """Take note of processes that have ended."""
        for robot, code in self.fleet.take_ended().items():
            driver = self.drivers[robot]
            self.drain(driver)
            if not driver.running:
                driver.record.exit_code = code
                continue
            if driver.lost is not None:
                self.end(driver, "lost", code, driver.lost)
            elif code == 0:
                idle = not driver.asked and not driver.record.devices
                error = "ended without having connected to its robot" if idle else None
                if error is not None:
                    error += ": it made no PlayerClient" if driver.kind == "program" else ""
                    self.say(f"{driver.record.name}: {error}")
                self.end(driver, "finished", 0, error)
            else:
                self.end(driver, "failed", code, self.describe(robot, code))
                self.say(f"{driver.record.name}: failed: {self.describe(robot, code, brief=True)}")

    def drain(self, driver: Driver) -> None:
        """Take what a process wrote before its end, then close what it has inherited."""
        for _ in range(LAST_WORDS):
            own = {driver.connection, *driver.clocks}
            if driver.kind == "program" and (
                driver.connection is None or not driver.connection.is_open
            ):
                break
            events = self.server.poll(0)
            self.take(events)
            port = self.switchboard.port
            if not any(
                one in own or (driver.kind == "command" and driver.robot in port(one).robots)
                for one, _ in events
            ):
                break
        if driver.connection is not None and driver.connection.is_open:
            self.close(driver.connection)

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
        """A controller's run is over; its robot stops, for good unless a client may come back."""
        if driver.kind == "external":
            self.stop(driver.robot)  # while it counts as running: it is not to become a body
        driver.record.state = state
        driver.record.exit_code = code
        driver.record.error = error
        self.failed |= self.fail_fast and state in FAILURES
        driver.commander = None
        self.clocks.retire(driver)
        if driver.kind != "external":
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


def note_devices(driver: Driver, names: Iterable[str]) -> None:
    """Put down, for the result, which devices a controller has subscribed."""
    driver.record.devices += [name for name in names if name not in driver.record.devices]
