"""A controller's output: captured line by line, shown under its name, kept in part."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable

TAIL_LINES = 40
"""Lines kept for the result: enough for a traceback."""
SHOWN_LINES = 2000
"""Lines shown of one controller; a flood beyond that is read and dropped."""
LONGEST_LINE = 2000
"""Characters of one line that are kept."""
READ_AT_ONCE = 1 << 16


class Output:
    """The reading end of the pipe that a controller's stdout and stderr go to."""

    def __init__(self, descriptor: int, name: str, show: Callable[[str], None] | None) -> None:
        os.set_blocking(descriptor, False)
        self.descriptor = descriptor
        self.name = name
        self.show = show
        self.tail: deque[str] = deque(maxlen=TAIL_LINES)
        self.shown = 0
        self.rest = b""
        self.is_open = True
        self.aside: list[str] | None = None  # where lines go that are not the program's own

    def read(self) -> bool:
        """Take what is there, up to a bound; False at the end of the output."""
        try:
            data = os.read(self.descriptor, READ_AT_ONCE)
        except BlockingIOError:
            return True
        except OSError:
            data = b""
        if not data:
            self.finish()
            return False
        *lines, self.rest = (self.rest + data).split(b"\n")
        if len(self.rest) > LONGEST_LINE:
            lines.append(self.rest)
            self.rest = b""
        for line in lines:
            self.take(line)
        return True

    def drain(self) -> None:
        """Take what a process that has ended left in the pipe (a pipe holds at most 1 MiB)."""
        for _ in range((1 << 20) // READ_AT_ONCE):
            if not self.is_open or not self.read():
                return

    def take(self, line: bytes) -> None:
        """Show and keep one line."""
        text = line[:LONGEST_LINE].decode(errors="replace").rstrip("\r")
        if self.aside is not None:
            self.aside.append(text)
            return
        self.tail.append(text)
        self.shown += 1
        if self.show is None or self.shown > SHOWN_LINES:
            return
        self.show(f"[{self.name}] {text}")
        if self.shown == SHOWN_LINES:
            self.show(f"[{self.name}] (more than {SHOWN_LINES} lines: the rest is not shown)")

    def finish(self) -> None:
        """Close; a last line without its end counts as well."""
        if not self.is_open:
            return
        if self.rest:
            self.take(self.rest)
            self.rest = b""
        self.is_open = False
        os.close(self.descriptor)

    def last_lines(self) -> str:
        """What was printed last, for the result."""
        return "\n".join(line for line in self.tail).strip()
