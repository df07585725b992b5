"""What a run shows on standard error while it goes on: a bar, and lines."""

from __future__ import annotations

import sys
from time import monotonic
from types import TracebackType
from typing import Any, Self

from sim.printable import printable_lines

REDRAW = 0.1
"""Wall-clock seconds between two looks at the bar."""


class Screen:
    """Lines on standard error; on a terminal, a bar below them. Nothing at all when quiet."""

    def __init__(self, quiet: bool) -> None:
        self.quiet = quiet
        self.bar: Any = None
        self.task: Any = None
        self.next_look = 0.0
        if not quiet and sys.stderr.isatty():
            from rich.console import Console  # noqa: PLC0415 - not needed in a pipe
            from rich.progress import BarColumn, Progress, TextColumn  # noqa: PLC0415

            self.bar = Progress(
                TextColumn("{task.fields[time]}"),
                BarColumn(),
                TextColumn("{task.fields[speed]}"),
                TextColumn("{task.fields[coverage]}"),
                console=Console(stderr=True),
                transient=True,
                redirect_stdout=False,  # what others print goes through our streams, not past them
                redirect_stderr=False,
            )

    def __enter__(self) -> Self:
        if self.bar is not None:
            self.bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.bar is not None:
            self.bar.stop()

    def say(self, line: str) -> None:
        """Print a line, with signs in place of characters that a terminal would obey."""
        if self.quiet:
            return
        line = printable_lines(line)
        if self.bar is not None:
            self.bar.console.print(line, markup=False, highlight=False, soft_wrap=True)
        else:
            print(line, file=sys.stderr, flush=True)

    def progress(self, engine: Any) -> None:
        """Bring the bar up to date, now and then."""
        if self.bar is None:
            return
        now = monotonic()
        if now < self.next_look:
            return
        self.next_look = now + REDRAW
        if self.task is None:
            self.task = self.bar.add_task(
                "", total=engine.settings.duration, time="", speed="", coverage=""
            )
            return
        painted = f"coverage {engine.scenery.floor.coverage:.1%}" if engine.sprayers.mounts else ""
        self.bar.update(
            self.task,
            completed=engine.time,
            time=f"{engine.time:.1f} s of {engine.settings.duration:g}",
            speed=f"{engine.speed or 0.0:.0f} x real time",
            coverage=painted,
        )
