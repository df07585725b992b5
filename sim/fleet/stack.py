"""A program's Python stack as faulthandler prints it, without the frames of those that run it."""

from __future__ import annotations

import re
from collections.abc import Iterable

RUNNERS = re.compile(
    r'\s*File "([^"]*/sim/fleet/(?:forkserver|program)\.py|<frozen runpy>|[^"]*/runpy\.py)"'
)
THREAD = re.compile(r"(Current thread|Thread) 0x[0-9a-f]+")


def own_frames(lines: Iterable[str]) -> list[str]:
    """The lines of a stack, the newest call first. A program's last lines may stand before it."""
    own: list[str] = []
    begun = False
    for line in lines:
        begun |= THREAD.match(line) is not None
        if not begun or RUNNERS.match(line):
            continue
        if line.strip():
            told = line.replace(" (most recent call first)", "")
            own.append(THREAD.sub(lambda found: f"{found[1]}, the newest call first", told))
    return own
