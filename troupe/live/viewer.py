"""One page that looks on: what it has been told, what it may be sent, and what it holds."""

from __future__ import annotations

import asyncio
import contextlib
from time import monotonic

from websockets.asyncio.server import ServerConnection

from sim.view.frames import Frame
from troupe.live.asks import Ask
from troupe.live.exchange import MOST_ASKED

RATE, BURST = 240.0, 480.0
"""Messages a second that a page may send for long, and at once."""
UNDER_WAY = 2
"""Moments that a page has been sent and has not drawn yet."""
FULL = 1 << 16
"""Bytes that wait for its line, above which nothing is added."""
PROMPT = 0.5
"""Wall-clock seconds within which a page that is awake has drawn a moment, and said goodbye."""
GOING_AWAY = 1001
"""The code by which a WebSocket is closed from where nobody is any more."""


class Viewer:
    """One page: what it has been told, and what it may be sent."""

    def __init__(self, line: ServerConnection) -> None:
        self.line = line
        self.scenes = 0
        self.moments = 0
        self.frame: Frame | None = None
        """The moment that it was sent last; `moments`: its number."""
        self.notices = 0
        self.under_way = 0
        self.selected: tuple[int, ...] = ()
        self.drives: set[int] = set()
        self.holds: set[int] = set()
        """Robots that it drives: they stop when it goes. Those that it has taken are given back."""
        self.wants_world = False
        self.since = monotonic()
        """Since when the first moment under way waits to be drawn."""
        self.credit = BURST
        self.counted = monotonic()

    @property
    def takes(self) -> bool:
        """Whether its line has room: what it did not take in time is little."""
        return self.line.transport.get_write_buffer_size() <= FULL

    @property
    def hungry(self) -> bool:
        """Whether it has drawn what it was sent."""
        return self.under_way < UNDER_WAY

    @property
    def answers(self) -> bool:
        """Whether it draws what it gets."""
        return not self.under_way or monotonic() - self.since < PROMPT

    def note(self, ask: Ask) -> None:
        """Keep in mind which robots are to be let go when it goes."""
        for kept, begins, ends in (
            (self.drives, ask.do == "drive" and any(ask.numbers), ask.do == "drive"),
            (self.holds, ask.do == "take", ask.do == "give"),
        ):
            if begins and len(kept) < MOST_ASKED:
                kept.add(ask.robot)
            elif ends:
                kept.discard(ask.robot)

    def affords(self) -> bool:
        """Count one message; whether it keeps to the rate."""
        now = monotonic()
        self.credit = min(BURST, self.credit + RATE * (now - self.counted)) - 1.0
        self.counted = now
        return self.credit >= 0.0

    async def leave(self) -> None:
        """Say goodbye; who stands, as in a debugger, cannot, and is not waited for."""
        goodbye = self.line.close(GOING_AWAY, "the run is over")
        if self.answers:
            await goodbye
            return
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(goodbye, PROMPT)
        self.line.transport.abort()
