"""A stepped simulation in the browser: what it is at, between its steps and while they are made."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from contextlib import AbstractContextManager
from html import escape
from typing import TYPE_CHECKING

from troupe.live.opening import Served
from troupe.live.watch import Watch

if TYPE_CHECKING:
    from sim.engine import Engine

LOOK = 0.05
"""Wall-clock seconds between two looks at what is asked for between steps."""
HEIGHT = 600
"""Pixels of the page within a notebook."""


class Window:
    """The page of a simulation: shown where a notebook shows this, or at `address`.

    `lock`: who holds it may look at the engine and move things in it. `engine()` is the engine now;
    a simulation that is reset has another.
    """

    def __init__(
        self,
        engine: Callable[[], Engine],
        lock: AbstractContextManager[object],
        host: str,
        port: int,
        *,
        browser: bool | None,
        read_only: bool,
        say: Callable[[str], None],
    ) -> None:
        """Opens it; raises OSError where the address cannot be had."""
        self._engine, self._lock = engine, lock
        browser = not in_notebook() if browser is None else browser
        self._served = Served(host, port, browser=browser, read_only=read_only, say=say)
        self._watch = Watch(self._served.exchange, again=False, stepped=True)
        self._closed = threading.Event()
        self._served.__enter__()
        with lock:
            self._watch.while_waiting(engine())
        self._thread = threading.Thread(target=self._look, name="troupe window", daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """What a browser on this machine is to open."""
        return self._served.address

    @property
    def closed(self) -> bool:
        """Whether the page has been closed."""
        return self._closed.is_set()

    def each_tick(self, engine: Engine) -> None:
        """A step has been made, by whoever holds the lock."""
        self._watch.each_tick(engine)

    def leave(self, outcome: str) -> None:
        """The engine's run is over: another one may come. By whoever holds the lock."""
        self._watch.finish(outcome)
        self._watch.leave()

    def close(self) -> None:
        """The page goes, with the last moment in it."""
        if self._closed.is_set():
            return
        self._closed.set()
        self._thread.join()
        self._served.__exit__(None, None, None)

    def _look(self) -> None:
        """Between steps: obey, and show what that brings."""
        while not self._closed.wait(LOOK):
            with self._lock:
                if not self._closed.is_set():
                    self._watch.while_waiting(self._engine())

    def __repr__(self) -> str:
        return f"<the simulation's page{' (closed)' * self.closed}: {self.address}>"

    def _repr_html_(self) -> str:
        """The page within a notebook."""
        address = escape(self.address, quote=True)
        return (
            f'<iframe src="{address}" title="Troupe" width="100%" height="{HEIGHT}" '
            f'allow="clipboard-write" style="border: 1px solid #ccc"></iframe>'
        )


def in_notebook() -> bool:
    """Whether a notebook's kernel runs us: it shows the page itself."""
    return "ipykernel" in sys.modules
