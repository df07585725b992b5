"""What a run from Python is given besides its world: seed and controllers, checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sim.fleet.functions import Controllers
from troupe.usage import UsageError

if TYPE_CHECKING:
    from sim.build import LoadedWorld


def listed(names: list[str], most: int = 8) -> str:
    """Names in a row for a message, cut off after `most`."""
    shown = ", ".join(names[:most])
    return f"{shown}, ... ({len(names)} in all)" if len(names) > most else shown or "none"


def checked_seed(seed: int) -> int:
    """A seed that can be; raises UsageError."""
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or not 0 <= seed < 1 << 63:
        raise UsageError(f"seed: must be a whole number from 0 to {(1 << 63) - 1} (given: {seed})")
    return int(seed)


def checked_controllers(controllers: Controllers, loaded: LoadedWorld) -> Controllers:
    """Controllers that the world's robots have; raises UsageError for others."""
    if isinstance(controllers, bool):
        return controllers
    known = {robot.controller for robot in loaded.robots} | {
        door.controller for door in loaded.layout.doors
    }
    for name, what in controllers.items():
        if name not in known:
            there = listed(sorted(one for one in known if one is not None))
            raise UsageError(
                f"controllers: no robot has the controller {name!r}; there are {there}"
            )
        if not callable(what) and not isinstance(what, bool):
            raise UsageError(
                f"controllers: {name!r} must be a function of a robot, or True for the world's own "
                f"program (given: {what!r})"
            )
    return dict(controllers)
