"""What a run, or what is made of its log, shows on standard error meanwhile: a bar, and lines."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from time import monotonic
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from troupe.interrupts import last_acts

if TYPE_CHECKING:
    from sim.engine import Engine

from player.printable import printable_lines

REDRAW = 0.1
"""Wall-clock seconds between two looks at the bar."""

TOLD_AFTER = 2.0
"""Wall-clock seconds of waiting after which the bar tells for whom."""

MOST_NAMED = 3
"""Robots that the bar names while the world waits for them."""


class Screen:
    """Lines on standard error; on a terminal, a bar below them. Nothing at all when quiet."""

    def __init__(self, quiet: bool) -> None:
        self.quiet = quiet
        self.bar: Any = None
        self.task: Any = None
        self.next_look = 0.0
        self.since = monotonic()
        if not quiet and sys.stderr.isatty():
            from rich.console import Console  # noqa: PLC0415 - not needed in a pipe
            from rich.progress import BarColumn, Progress, TextColumn  # noqa: PLC0415

            self.bar = Progress(
                TextColumn("{task.fields[time]}"),
                BarColumn(),
                TextColumn("{task.fields[speed]}"),
                TextColumn("{task.fields[coverage]}"),
                TextColumn("{task.fields[waiting]}"),
                console=Console(stderr=True),
                transient=True,
                redirect_stdout=False,  # what others print goes through our streams, not past them
                redirect_stderr=False,
            )

    def __enter__(self) -> Self:
        return self  # the bar begins with the run: until then a signal ends the command at once

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.task is not None:
            self.bar.stop()
            last_acts.remove(show_cursor)

    def say(self, line: str) -> None:
        """Print a line, with signs in place of characters that a terminal would obey."""
        if not self.quiet:
            self.warn(line)

    def warn(self, line: str) -> None:
        """The same for what is not to be overlooked: also when quiet."""
        line = printable_lines(line)
        if self.bar is not None:
            self.bar.console.print(line, markup=False, highlight=False, soft_wrap=True)
        else:
            print(line, file=sys.stderr, flush=True)

    def progress(self, engine: Engine) -> None:
        """Bring the bar of a run up to date, now and then."""
        if self.bar is not None and self.begun(engine.settings.duration):
            floor = engine.scenery.floor
            covered = f"coverage {floor.coverage:.1%}" if engine.spraying.painters else ""
            self.come(engine.time, engine.settings.duration, engine.speed or 0.0, covered)

    def rendered(self, time: float, until: float) -> None:
        """The same while a log is rendered: simulated seconds so far, and in all."""
        if self.bar is not None and self.begun(until):
            self.come(time, until, time / max(monotonic() - self.since, 1e-9), "")

    def come(self, time: float, until: float, speed: float, coverage: str) -> None:
        """Show how far it has come."""
        self.bar.update(
            self.task,
            completed=time,
            time=f"{time:.1f} s of {until:g}",
            speed=f"{speed:.0f} x real time",
            coverage=coverage,
            waiting="",
        )

    def waiting(self, engine: Engine) -> None:
        """Tell on the bar for whom the world has been waiting for a while."""
        if self.bar is not None and self.begun(engine.settings.duration):
            self.bar.update(self.task, waiting=awaited(engine.behind(TOLD_AFTER)))

    def begun(self, until: float) -> bool:
        """Whether the bar is there and it is time to look at it again."""
        now = monotonic()
        if now < self.next_look:
            return False
        self.next_look = now + REDRAW
        if self.task is None:
            last_acts.append(show_cursor)
            self.bar.start()
            self.task = self.bar.add_task(
                "", total=until, time="", speed="", coverage="", waiting=""
            )
        return True


def awaited(late: Mapping[str, float]) -> str:
    """For whom the world waits, and since when: `late` has seconds by robots' names."""
    if not late:
        return ""
    names = list(late)
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    return f"waiting for {', '.join(names[:MOST_NAMED])}{more} ({max(late.values()):.0f} s)"


def show_cursor() -> None:
    """The bar has hidden it."""
    os.write(2, b"\x1b[?25h\r\n")
