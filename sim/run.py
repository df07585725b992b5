"""One run of one world, from the file to the result."""

from __future__ import annotations

import contextlib
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from sim.engine import Engine, Settings
from sim.fleet.fleet import Fleet
from sim.result import Result
from sim.worldfile import LoadedWorld

if TYPE_CHECKING:
    from sim.filming import Film
    from sim.log.recorder import Recorder

EachTick = Callable[[Engine], None]


def run_world(
    loaded: LoadedWorld,
    settings: Settings,
    *,
    fleet: Fleet | None = None,
    film: Film | None = None,
    log: Recorder | None = None,
    each_tick: EachTick | None = None,
    say: Callable[[str], None] = lambda line: None,
) -> Result:
    """Run a world to its end.

    `fleet` may have been started early, so that it gets ready while the world is read. `film`
    makes a video, `log` keeps the run. `each_tick(engine)` is called after every tick.
    `say(line)` is given what is meant for people. SIGINT and SIGTERM end the run in an orderly
    way: the result so far comes back with the outcome `interrupted`.
    """
    fleet = fleet or Fleet(show=say)
    engine: Engine | None = None
    result: Result | None = None
    hooks = (log.each_tick if log else None, film.each_tick if film else None, each_tick)
    watchers = [watch for watch in hooks if watch]

    def after_tick(engine: Engine) -> None:
        for watch in watchers:
            watch(engine)

    try:
        engine = Engine(loaded, settings, fleet, say)
        if log is not None:
            engine.entry.logged = log.sensors
        with interruptible(engine):
            result = engine.run(after_tick if watchers else None)
        return result
    finally:
        if engine is None:
            fleet.close()
        if film is not None:
            film.finish(engine)
        if log is not None:
            log.finish(engine, result)


@contextlib.contextmanager
def interruptible(engine: Engine) -> Iterator[None]:
    """Turn SIGINT and SIGTERM into an orderly end; before there is anything to lose, at once.

    A second signal ends at once as well.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    reading, writing = socket.socketpair()
    for end in (reading, writing):
        end.setblocking(False)

    def interrupt(number: int, frame: object) -> None:
        compiling = engine.ticks <= 1 and not engine.crew.waiting  # perhaps: do not wait for it
        if engine.crew.interrupted or compiling:
            raise KeyboardInterrupt
        engine.crew.interrupted = True

    def drain() -> None:
        with contextlib.suppress(BlockingIOError):
            reading.recv(4096)

    engine.server.watch(reading, drain)
    before = {
        number: signal.signal(number, interrupt) for number in (signal.SIGINT, signal.SIGTERM)
    }
    wakeup = signal.set_wakeup_fd(writing.fileno(), warn_on_full_buffer=False)
    try:
        yield
    finally:
        signal.set_wakeup_fd(wakeup)
        for number, handler in before.items():
            signal.signal(number, handler)
        reading.close()
        writing.close()
