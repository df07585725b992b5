"""A world is rehearsed before its ports open: what is compiled or loaded for it is ready then.

Clients of Player's own library wait five seconds for an answer, and compiling may take longer.
"""

from __future__ import annotations

import contextlib
import math
from dataclasses import replace

from sim.build import LoadedWorld
from sim.engine import Engine, Settings
from sim.fleet.functions import Controllers
from sim.fleet.idle import NoFleet
from sim.worldfile.schema import Player

TICKS = 2
"""The second one moves what the first one has been told."""


def is_served(
    loaded: LoadedWorld, listen: tuple[str, int] | None, controllers: Controllers = True
) -> bool:
    """Whether a run of a world opens any port."""
    if listen is not None or loaded.world.player.port is not None:
        return True
    if controllers is False:
        return False
    named = {robot.controller for robot in loaded.robots}
    named |= {door.controller for door in loaded.layout.doors}
    known = loaded.world.controllers
    return any(
        known[name].external or known[name].command is not None for name in named if name in known
    )


def rehearse(loaded: LoadedWorld, seed: int = 0) -> None:
    """Two ticks with everything sensed and told and every drive and sprayer on, for nobody.

    An error in it is no error of the run's: that will come to it, or not, by itself.
    """
    closed = replace(loaded, world=loaded.world.model_copy(update={"player": Player()}))
    with contextlib.suppress(Exception):
        run_for_nobody(closed, seed)


def run_for_nobody(loaded: LoadedWorld, seed: int) -> None:
    """The two ticks themselves."""
    settings = Settings(seed=seed, duration=math.inf, sense_all=True)
    engine = Engine(loaded, settings, NoFleet(), lambda line: None, controllers=False)  # type: ignore[arg-type]
    try:
        engine.begin()
        for robot in engine.robots:
            robot.port  # noqa: B018 - with the devices that a client would come to
        for _ in range(TICKS):
            for robot in engine.robots:
                if robot.model.drive is not None:
                    engine.context.drive(robot, (0.2, 0.0, 0.3))
                for sprayer in robot.sprayers:
                    sprayer.on = True
            engine.advance()
            engine.switchboard.rehearse(engine.sensing.encodings.round)
    finally:
        engine.crew.dismiss()
