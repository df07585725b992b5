"""Holding a run to the wall clock, for programs and people that live in real time."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic


class Pace:
    """Simulated seconds per wall-clock second; `factor` None runs flat out. `now` is the clock."""

    def __init__(self, factor: float | None, now: Callable[[], float] = monotonic) -> None:
        self.factor = factor
        self.now = now
        self.origin = 0.0

    def begin(self, time: float = 0.0) -> None:
        """Simulated time `time` is now."""
        if self.factor:
            self.origin = self.now() - time / self.factor

    def follow(self, factor: float | None, time: float) -> None:
        """Keep to a factor, from simulated time `time` on if it is not the same as before."""
        if factor != self.factor:
            self.factor = factor
            self.begin(time)

    def ahead(self, time: float) -> float:
        """Wall-clock seconds by which simulated time `time` is early.

        A run that has fallen behind by more than a second does not rush to catch up.
        """
        if not self.factor:
            return 0.0
        early = self.origin + time / self.factor - self.now()
        if early < -1.0:
            self.begin(time)
            return 0.0
        return early
