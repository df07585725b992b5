"""Ctrl-C that is not lost while modules are loaded."""

from __future__ import annotations

import os
import signal
from types import FrameType


def interrupt(number: int, frame: FrameType | None) -> None:
    """A handler of signals: raises KeyboardInterrupt, or ends at once where modules are loaded.

    There the exception may be raised in a weak reference's callback, which Python's import makes
    use of and which passes no exception on; and there is nothing to lose yet.
    """
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            os.write(2, b"interrupted\n")
            os._exit(130)
        frame = frame.f_back
    raise KeyboardInterrupt


def heed_interrupts() -> None:
    """To be called as early as can be; an interrupt that was ignored when we came stays so."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, interrupt)
