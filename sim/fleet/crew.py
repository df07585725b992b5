"""The crew: controllers' processes from start to end, and the wait for all controllers.

Rules: the world moves on when every robot's clock has asked for data. What is decided here depends
on what the controllers say and do, never on which of them is quicker; the wall clock only ends the
wait for a controller that hangs.
"""

from __future__ import annotations

import socket
from collections.abc import Callable
from time import monotonic

from player.server import Server
from sim.devices.device import Context
from sim.devices.switchboard import Port
from sim.fleet.driver import Driver
from sim.fleet.drivers import Drivers
from sim.fleet.fleet import Fleet, Launch
from sim.fleet.patience import Patience, hint, lacking
from sim.fleet.routing import Router
from sim.fleet.stack import own_frames

__all__ = ["Crew", "Patience"]

LAST_STACK = 1.0
"""Wall-clock seconds that a program has to print its stack."""

TOLD_AFTER = 2.0
"""Wall-clock seconds of waiting after which people want to know for whom."""

MOST_TOLD = 3
"""Controllers of which an interrupted run tells where they stood."""

LAST_WORDS = 256
"""Polls at the most for what a process wrote before its end: 16 MiB, above any socket's buffer."""


class Crew:
    """The robots' controllers. `while_waiting()` is called now and then while they are waited for,
    and `say(line)` is given what is meant for people.
    """

    def __init__(
        self,
        context: Context,
        server: Server,
        fleet: Fleet,
        drivers: Drivers,
        router: Router,
        *,
        patience: Patience,
        say: Callable[[str], None],
        while_waiting: Callable[[], None] | None = None,
    ) -> None:
        self.context = context
        self.server = server
        self.fleet = fleet
        self.drivers = drivers
        self.clocks = drivers.clocks
        self.router = router
        self.patience = patience
        self.say = say
        self.while_waiting = while_waiting
        self.interrupted = False
        self.waiting = False  # for clients: a signal that comes now need not break off anything
        self.hinted = False
        self.look_at = 0.0  # when to look again who has used up the patience
        fleet.attach(server.watch, server.unwatch)

    # -- entries ----------------------------------------------------------------------------

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
        while not (self.interrupted or self.drivers.failed):
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
            self.router.take(events)
            self.notice_ends()
            if until is None and monotonic() >= self.look_at:
                self.notice_hung()
            if self.while_waiting is not None:
                self.while_waiting()
        return False

    def ready(self) -> bool:
        """Whether nobody is waited for any more."""
        return not (self.context.paused or self.context.held) and self.clocks.ready()

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
        if self.context.paused or self.context.held:
            for driver in behind:
                driver.since = now
            if self.context.paused and self.patience.limit_of_pause(self.router.paused_at) <= now:
                self.end_pause(now - self.router.paused_at)
            return
        if not self.hinted and self.clocks.mode == "all":
            line = hint(behind, self.clocks.clocked.values(), now)
            if line is not None:
                self.hinted = True
                self.say(line)
        for driver in behind:
            if self.patience.limit(driver) <= now:
                self.give_up(driver, now - driver.since)

    def give_up(self, driver: Driver, waited: float) -> None:
        """End a controller that hangs, unless it has moved in the meantime."""
        self.router.take(self.server.poll(0))
        if driver.robot not in self.behind:
            return
        name = driver.record.name
        why = lacking(driver)
        error = f"kept the others waiting for {waited:.0f} s: {why}"
        if driver.kind == "external" and not driver.clocks:
            error = f"no client that asks for data has come within {waited:.0f} s"
            error += f" ({driver.record.error})" if driver.record.error else ""
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
        switchboard = self.router.switchboard
        paused_by = switchboard.paused_by
        self.router.take(self.server.poll(0))
        if paused_by is None or switchboard.paused_by is not paused_by:
            return
        error = f"kept the world paused for {waited:.0f} s"
        drivers = list(self.clocks.driven.get(paused_by, {}).values())
        for driver in drivers:
            self.say(f"{driver.record.name}: hung: {error}, its robot stops")
            self.abandon(driver, error)
        if not drivers:
            self.say(f"{paused_by.peer}: {error}: its connection is closed")
        if paused_by.is_open:
            self.router.close(paused_by)

    def abandon(self, driver: Driver, error: str) -> None:
        """Wait for a controller no more: end its process, close its connections."""
        if driver.launched:
            self.fleet.kill(driver.robot)
        for connection in [driver.connection, *driver.clocks]:
            if connection is not None and connection.is_open:
                self.router.close(connection)
        self.drivers.end(driver, "hung", None, error)

    def stack(self, driver: Driver) -> list[str]:
        """Where a program stands, as lines; it ends thereby. None are known of a command."""
        if driver.kind != "program" or driver.robot not in self.fleet.pids:
            return []
        output = self.fleet.outputs[driver.robot]
        output.aside = []
        self.fleet.ask_stack(driver.robot)
        until = monotonic() + LAST_STACK
        while driver.robot in self.fleet.pids and (left := until - monotonic()) > 0:
            self.router.take(self.server.poll(left))
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

    # -- ends -------------------------------------------------------------------------------

    def notice_ends(self) -> None:
        """Take note of processes that have ended."""
        for robot, code in self.fleet.take_ended().items():
            driver = self.context.robots[robot].driver
            self.drain(driver)
            if not driver.running:  # it hung: the signal that ended it was ours, and tells nothing
                continue
            if driver.lost is not None:
                self.drivers.end(driver, "lost", code, driver.lost)
            elif code == 0:
                idle = not driver.asked and not driver.record.devices
                error = "ended without having connected to its robot" if idle else None
                if error is not None:
                    error += ": it made no PlayerClient" if driver.kind == "program" else ""
                    self.say(f"{driver.record.name}: {error}")
                self.drivers.end(driver, "finished", 0, error)
            else:
                self.drivers.end(driver, "failed", code, self.describe(robot, code))
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
            self.router.take(events)
            robot, port = self.context.robots[driver.robot], self.router.switchboard.port
            if not any(
                one in own or (driver.kind == "command" and robot in port(one).robots)
                for one, _ in events
            ):
                break
        if driver.connection is not None and driver.connection.is_open:
            self.router.close(driver.connection)

    def describe(self, robot: int, code: int, brief: bool = False) -> str:
        """What is known of a process's failure."""
        how = f"exit code {code}" if code >= 0 else f"killed by signal {-code}"
        if self.fleet.lost:
            how += " (the fork server has died)"
        lines = self.fleet.outputs[robot].last_lines()
        if brief:
            lines = lines.rpartition("\n")[2]
        return f"{how}: {lines}" if brief and lines else f"{how}\n{lines}".strip()

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
