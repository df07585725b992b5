"""How far a sweep is, on standard error: done, failed, rate, time left."""

from __future__ import annotations

import sys
import time
from typing import Any

EVERY = 10.0
"""Seconds between two lines where standard error is no terminal."""

REDRAW = 0.2


class Progress:
    """A line that is redrawn on a terminal, and one every ten seconds in a file."""

    def __init__(self, total: int, quiet: bool) -> None:
        self.total = total
        self.done = 0
        self.failed = 0
        self.began = time.monotonic()
        self.next = self.began + EVERY
        self.live: Any = None
        self.quiet = quiet
        if not quiet and sys.stderr.isatty():
            from rich.console import Console  # noqa: PLC0415 - not needed in a file
            from rich.live import Live  # noqa: PLC0415

            self.live = Live(console=Console(stderr=True), auto_refresh=False, transient=True)
            self.live.start()

    def step(self, completed: bool) -> None:
        """One more run is done; the first one starts the clock, for workers take a moment."""
        if self.done == 0:
            self.began = time.monotonic()
        self.done += 1
        self.failed += not completed
        now = time.monotonic()
        if self.quiet or now < self.next:
            return
        self.next = now + (EVERY if self.live is None else REDRAW)
        if self.live is not None:
            self.live.update(self.text(now), refresh=True)
        else:
            print(self.text(now), file=sys.stderr, flush=True)

    def text(self, now: float) -> str:
        """`120 of 1000 done, 3 failed, 2.1 runs/s, 7:03 left`."""
        passed = max(now - self.began, 1e-9)
        rate = (self.done - 1) / passed
        left = (self.total - self.done) / rate if rate else 0.0
        return (
            f"{self.done} of {self.total} done, {self.failed} failed, {rate:.3g} runs/s, "
            f"{clock(left)} left"
        )

    def close(self) -> None:
        if self.live is not None:
            self.live.stop()


def clock(seconds: float) -> str:
    """`7:03`, or `1:07:03`."""
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02}:{second:02}" if hours else f"{minute}:{second:02}"
