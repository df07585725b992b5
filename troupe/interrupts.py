"""Signals that end a command that has nothing to lose yet: at once, wherever they find it.

An exception would not do: it may come out in a weak reference's callback, which Python's import and
numba make use of and which passes no exception on. Ctrl-C, SIGTERM and SIGHUP are the same.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import signal
import sys
from collections.abc import Callable, Iterator
from types import FrameType
from typing import NoReturn

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
EXIT_CODE = 130

last_acts: list[Callable[[], object]] = []
"""Called before the process ends at once: what must not be left behind, such as half a file."""


def leave(number: int = 0, frame: FrameType | None = None) -> NoReturn:
    """A handler of signals: what has been printed goes out, and the process ends."""
    for act in last_acts:
        with contextlib.suppress(Exception):
            act()
    with contextlib.suppress(Exception):  # in the midst of a write to it there is no second one
        sys.stdout.flush()
    with contextlib.suppress(OSError):
        os.write(2, b"interrupted\n")
    os._exit(EXIT_CODE)


def interrupt(number: int, frame: FrameType | None) -> None:
    """A handler of signals: raises KeyboardInterrupt, or ends at once where modules are loaded."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            leave()
        frame = frame.f_back
    raise KeyboardInterrupt


def heed_interrupts() -> None:
    """To be called as early as can be; a signal that was ignored when we came stays so."""
    for number in SIGNALS:
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, leave)


def all_done() -> None:
    """Everything has been said: a signal that comes now, while Python ends, changes nothing."""
    for number in SIGNALS:
        if signal.getsignal(number) is leave:
            signal.signal(number, signal.SIG_IGN)


@contextlib.contextmanager
def last_act(act: Callable[[], object]) -> Iterator[None]:
    """Within, a signal that ends the process at once has this done before."""
    last_acts.append(act)
    try:
        yield
    finally:
        last_acts.remove(act)


@contextlib.contextmanager
def raised() -> Iterator[None]:
    """Within, a signal that would end the command at once is a KeyboardInterrupt."""
    heeded = [number for number in SIGNALS if signal.getsignal(number) is leave]
    for number in heeded:
        signal.signal(number, interrupt)
    try:
        yield
    finally:
        for number in heeded:
            signal.signal(number, leave)


def is_the_command() -> bool:
    """Whether this process is the command `troupe`, and not somebody's program that imports it."""
    name = sys.argv[0] if sys.argv else ""
    if name == "-m":  # as long as the package is being found
        return ("-m", "troupe") in itertools.pairwise(sys.orig_argv)
    return os.path.basename(name) == "troupe" or name.endswith("troupe/__main__.py")
