"""Signals that ask for the end of a run: noted, and obeyed in order; a second one ends at once.

No handler raises an exception while there is something to lose: where it would come out nobody
knows, and within a muxer's callback or a module that is being loaded nobody passes it on.
"""

from __future__ import annotations

import contextlib
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from types import FrameType
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from sim.engine import Engine

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Ctrl-C, a polite kill, and a terminal that is closed."""


def raise_interrupt() -> NoReturn:
    """What a second signal does in somebody's own program."""
    raise KeyboardInterrupt


class Interrupts:
    """Whether somebody has asked for the end. Signals are held from `hold` to `release`.

    `again()` is called for every further signal. Signals that were ignored stay so, and outside of
    the main thread, where Python has no handlers, nothing is held.
    """

    def __init__(self, again: Callable[[], object] = raise_interrupt) -> None:
        self.again = again
        self.noted = False
        self.engine: Engine | None = None
        self._before: dict[int, Any] = {}

    @property
    def held(self) -> bool:
        """Whether signals are held now."""
        return bool(self._before)

    def hold(self) -> None:
        """From now on a signal is noted; a second call changes nothing."""
        if self.held or threading.current_thread() is not threading.main_thread():
            return
        for number in SIGNALS:
            if signal.getsignal(number) not in (signal.SIG_IGN, None):
                self._before[number] = signal.signal(number, self._take)

    def release(self) -> None:
        """The handlers that were there before come back."""
        while self._before:
            number, handler = self._before.popitem()
            signal.signal(number, handler)

    def _take(self, number: int, frame: FrameType | None) -> None:
        if self.noted:
            self.again()
        self.noted = True
        if self.engine is not None:
            self.engine.crew.interrupted = True

    @contextlib.contextmanager
    def heard_by(self, engine: Engine) -> Iterator[None]:
        """The engine ends its run when a signal comes, also while it waits for clients."""
        engine.crew.interrupted |= self.noted
        if not self.held:
            yield
            return
        reading, writing = socket.socketpair()
        for end in (reading, writing):
            end.setblocking(False)

        def drain() -> None:
            with contextlib.suppress(BlockingIOError):
                reading.recv(4096)

        engine.server.watch(reading, drain)
        wakeup = signal.set_wakeup_fd(writing.fileno(), warn_on_full_buffer=False)
        self.engine = engine
        engine.crew.interrupted |= self.noted  # one may have come in between
        try:
            yield
        finally:
            self.engine = None
            signal.set_wakeup_fd(wakeup)
            reading.close()
            writing.close()
