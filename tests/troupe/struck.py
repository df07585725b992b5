"""The command line with signals at chosen places, run as a program: `struck.py PLACE N COMMAND...`.

A place is MODULE:NAME[:after], where NAME is a function, or an import, `import:MODULE`. When it is
called (or imported) the process gets N signals of the number in $SIGNAL, all before it goes on.
"""

from __future__ import annotations

import importlib
import importlib.abc
import os
import signal
import sys
import threading
import weakref
from typing import Any

heard = threading.Event()
NUMBER = int(os.environ.get("SIGNAL", signal.SIGINT))


class Thing:
    """Something that a weak reference can be made of."""


def strike(times: int) -> None:
    """The signals come, and come out in a callback that passes no exception on.

    In another thread than the main one: one after the other, as soon as each has been heard. A
    main thread that was just about to wait for this one notices a signal only when it is woken,
    so it is, by a signal that means nothing.
    """
    main = threading.main_thread()
    for _ in range(times):
        heard.clear()
        thing = Thing()
        gone = weakref.ref(thing, lambda _: os.kill(os.getpid(), NUMBER))
        del thing
        assert gone() is None
        if threading.current_thread() is not main:
            while not heard.wait(0.1):
                signal.pthread_kill(main.ident or 0, signal.SIGURG)


def listen() -> None:
    """Know when the main thread has heard a signal."""
    from sim.interrupts import Interrupts  # noqa: PLC0415

    take = Interrupts._take

    def heard_too(self: Interrupts, *words: Any) -> None:
        take(self, *words)
        heard.set()

    Interrupts._take = heard_too  # type: ignore[method-assign]
    signal.signal(signal.SIGURG, lambda *_: None)


class Import(importlib.abc.MetaPathFinder):
    """Strikes when a module is about to be imported."""

    def __init__(self, module: str, times: int) -> None:
        self.module = module
        self.times = times

    def find_spec(self, name: str, path: Any, target: Any = None) -> None:
        if name == self.module:
            self.module = ""
            strike(self.times)


def lay_trap(place: str, times: int) -> None:
    """Have the first call of a function strike."""
    module, name, *when = place.split(":")
    owner: Any = importlib.import_module(module)
    *path, last = name.split(".")
    for part in path:
        owner = getattr(owner, part)
    function = getattr(owner, last)
    left = [times]

    def struck(*words: Any, **more: Any) -> Any:
        now, left[0] = left[0], 0
        if not when:
            strike(now)
        result = function(*words, **more)
        if when:
            strike(now)
        return result

    setattr(owner, last, struck)


def main() -> None:
    """Run the command line with a trap."""
    place, times = sys.argv[1], int(sys.argv[2])
    sys.argv[:] = ["troupe", *sys.argv[3:]]
    from troupe.__main__ import main as command  # noqa: PLC0415

    if place.startswith("import:"):
        sys.meta_path.insert(0, Import(place.partition(":")[2], times))
    else:
        listen()
        lay_trap(place, times)
    command()


if __name__ == "__main__":
    main()
