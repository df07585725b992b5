"""Clients that sleep while a world waits for them, where people count on time to pass."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from sim.fleet.driver import Driver

ASLEEP = 0.5
"""Wall-clock seconds between two requests for data from which on a client is taken to sleep."""


class Sleeping:
    """Says once that a client from outside sleeps, and what lets time pass meanwhile.

    `now()` is the wall clock: it decides over a line for people, and nothing else.
    """

    def __init__(self, say: Callable[[str], None], now: Callable[[], float] = monotonic) -> None:
        self.say = say
        self.now = now
        self.told = False

    def asked(self, driver: Driver) -> None:
        """A robot's clock asks for data; it was waited for since `driver.since`."""
        if self.told or driver.launched or not driver.asked:
            return
        slept = self.now() - driver.since
        if slept >= ASLEEP:
            self.told = True
            self.say(
                f"{driver.record.name}: its client did not ask for data for {slept:.1f} s, and the "
                "world waited: no simulated time has passed meanwhile. For programs that sleep: "
                "--free, or `player: {clock: free}` in the world file"
            )
