"""One run of one world, from the file to the result."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from sim.build import LoadedWorld
from sim.engine import Engine, Settings
from sim.fleet.fleet import Fleet
from sim.fleet.functions import Controllers
from sim.interrupts import Interrupts
from sim.result import Result

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
    while_waiting: EachTick | None = None,
    say: Callable[[str], None] = lambda line: None,
    warn: Callable[[str], None] | None = None,
    interrupts: Interrupts | None = None,
    controllers: Controllers = True,
) -> Result:
    """Run a world to its end.

    `fleet` may have been started early, so that it gets ready while the world is read. `film`
    makes a video, `log` keeps the run. `each_tick(engine)` is called after every tick, and
    `while_waiting(engine)` while the world waits for controllers. `say(line)` is given what is
    meant for people, and `warn(line)`, or else `say`, what they are not to overlook.

    SIGINT, SIGTERM and SIGHUP end the run in order: the result so far comes back with the outcome
    `interrupted`, and video and log are completed; a second one raises KeyboardInterrupt.
    `interrupts` that are given stay held when the run is over. `controllers`: see `Engine`.
    """
    interrupts, own = interrupts or Interrupts(), interrupts is None
    interrupts.hold()
    fleet = fleet or Fleet(show=say)
    engine: Engine | None = None
    result: Result | None = None
    hooks = (log.each_tick if log else None, film.each_tick if film else None, each_tick)
    watchers = [watch for watch in hooks if watch]

    def after_tick(engine: Engine) -> None:
        for watch in watchers:
            watch(engine)

    try:
        engine = Engine(loaded, settings, fleet, say, warn, while_waiting, controllers)
        if log is not None:
            engine.sensing.logged = log.sensed.wanted
        with interrupts.heard_by(engine):
            result = engine.run(after_tick if watchers else None)
        return result
    finally:
        try:
            if engine is None:
                fleet.close()
            if film is not None:
                film.finish(engine)
        finally:
            try:
                if log is not None:
                    log.finish(engine, result)
            finally:
                if own:
                    interrupts.release()
