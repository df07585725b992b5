"""How long the world waits for a controller, and what it says meanwhile."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from player.codes import DataMode
from sim.fleet.driver import Driver

HINT_AFTER = 5.0
"""Wall-clock seconds after which a wait for one of several clocks of one client is explained."""


@dataclass(frozen=True)
class Patience:
    """Wall-clock seconds that a controller may keep the others waiting; infinite: for ever."""

    reading: float = 60.0

    @property
    def entry(self) -> float:
        """Until its first request: it may have much to load."""
        return 2 * self.reading

    @property
    def look_after(self) -> float:
        """How often to look who has used it up."""
        return min(1.0, 0.5 * self.reading, 0.5 * HINT_AFTER)

    def limit(self, driver: Driver) -> float:
        """The time at which the patience with a controller that is waited for ends."""
        return driver.since + (self.reading if driver.asked else self.entry)

    def limit_of_pause(self, since: float) -> float:
        """The time at which the patience with who has paused the world ends."""
        return since + self.reading


def lacking(driver: Driver) -> str:
    """What a controller that is waited for has not done."""
    if driver.kind == "external" and not driver.clocks:
        return "no client that asks for data has come"
    if driver.kind != "program":
        return "it has not asked for data" + " again" * driver.asked
    session = None if driver.connection is None else driver.connection.session
    if session is not None and not session.subscribed and session.mode is DataMode.PUSH:
        return "it has made no PlayerClient"
    return "it has not called read()" + " again" * driver.asked


def hint(behind: Iterable[Driver], drivers: Iterable[Driver], now: float) -> str | None:
    """What to tell of a client that reads several robots in turn, and so waits for ever.

    It is known by this: of two robots that are driven over TCP from one machine, one waits for
    its data and the other has not asked for a while.
    """
    late = [
        driver
        for driver in behind
        if driver.kind != "program" and driver.clock is not None and now - driver.since > HINT_AFTER
    ]
    if not late:
        return None
    waiting = {host(driver) for driver in drivers if driver.asking}
    for driver in late:
        if host(driver) in waiting:
            return (
                f"{driver.record.name}: its client has not asked for data for "
                f"{HINT_AFTER:.0f} s while others wait. A program that reads several robots "
                "in turn needs `player: {clock: any}` in the world file"
            )
    return None


def host(driver: Driver) -> str:
    """The machine that a robot's clock is on."""
    return "" if driver.clock is None else driver.clock.peer.rpartition(":")[0]
