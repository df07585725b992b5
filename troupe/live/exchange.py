"""Where the thread of the run and that of the server meet: moments one way, wishes the other.

A source of moments (a run, a log that is played) calls `show` once, then, whenever something is
`due`, `offer`, and obeys what it gets from `take`. It never waits: what nobody has fetched when the
next moment comes is dropped.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from time import monotonic

from sim.view.moment import Moment, Scene
from troupe.live.asks import Ask

PACED, FLAT_OUT = 1 / 30, 1 / 8
"""Wall-clock seconds between two moments at the least: of a run that is held to the clock, where
they show motion; and of one that goes flat out, where they show jumps, however many there are."""
SHARE = 0.01
"""Of a run that goes flat out, what its process may do for viewers, in seconds of the processor: so
seldom moments come. A run loses more than that: a thread that wakes up takes its core, and what
the caches hold of it, from the run or a controller."""
MOST_ASKED = 256
"""Wishes that wait to be obeyed; further ones are dropped."""


class Exchange:
    """The latest moment, and what has been asked for since the source last looked."""

    def __init__(self) -> None:
        self.scene: Scene | None = None
        self.scenes = 0
        """How many there were: a run that begins again has another."""
        self.moment: Moment | None = None
        self.moments = 0
        self.world: Callable[[Moment], str] | None = None
        """Makes the text of a world file that begins as a moment is; None: of a log."""
        self.hungry = False
        """Whether a viewer waits for a moment."""
        self.selected: frozenset[int] = frozenset()
        """Robots of which somebody wants to know more."""
        self.ring: Callable[[], None] = lambda: None
        """Tells the server that something is new."""
        self.wake: Callable[[], None] = lambda: None
        """Tells the source that something was asked."""
        self.said: list[str] = []
        self.notices = 0
        self._asks: dict[object, Ask] = {}
        self._lock = threading.Lock()
        self._next = 0.0
        self._cost = 0.0

    # -- the source's side ------------------------------------------------------------------

    @property
    def due(self) -> bool:
        """Whether somebody wants a moment, and it is time for one."""
        return self.hungry and monotonic() >= self._next

    def show(self, scene: Scene) -> None:
        """A run begins."""
        self.scene, self.moment = scene, None
        self.scenes += 1
        self.ring()

    def offer(self, moment: Moment, cost: float = 0.0, *, idle: bool = False) -> None:
        """The run has come to this moment; making it has cost so many seconds of the processor.

        `idle`: the run has time to spare, as it is held to the wall clock.
        """
        with self._lock:
            spent, self._cost = self._cost + cost, 0.0
        self._next = monotonic() + (PACED if idle else max(FLAT_OUT, spent / SHARE))
        self.hungry = False
        self.moment = moment
        self.moments += 1
        self.ring()

    def tell(self, line: str) -> None:
        """Something that those who watch are to read."""
        self.said = [*self.said[-19:], line]
        self.notices += 1
        self.ring()

    @property
    def asked(self) -> bool:
        """Whether anything was asked for that has not been taken."""
        return bool(self._asks)

    def take(self) -> list[Ask]:
        """What was asked for since the last call, in order."""
        if not self._asks:
            return []
        with self._lock:
            asks, self._asks = self._asks, {}
        return list(asks.values())

    # -- the server's side ------------------------------------------------------------------

    def ask(self, ask: Ask) -> None:
        """Somebody wishes this."""
        with self._lock:
            if ask.key in self._asks:
                del self._asks[ask.key]
            elif len(self._asks) >= MOST_ASKED:
                return
            self._asks[ask.key] = ask
        self.wake()

    def spend(self, seconds: float) -> None:
        """So long the server has worked for viewers, in seconds of the processor."""
        with self._lock:
            self._cost += seconds
