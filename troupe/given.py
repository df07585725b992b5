"""What a run is given besides its world: numbers and controllers, checked."""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Integral, Real
from typing import TYPE_CHECKING

from troupe.usage import UsageError

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.fleet.functions import Controllers


def listed(names: list[str], most: int = 8) -> str:
    """Names in a row for a message, cut off after `most`."""
    shown = ", ".join(names[:most])
    return f"{shown}, ... ({len(names)} in all)" if len(names) > most else shown or "none"


def checked_seed(seed: int) -> int:
    """A seed that can be; raises UsageError."""
    if isinstance(seed, bool) or not isinstance(seed, Integral) or not 0 <= seed < 1 << 63:
        raise UsageError(f"seed: must be a whole number from 0 to {(1 << 63) - 1} (given: {seed})")
    return int(seed)


def checked_seconds(option: str, given: float) -> float:
    """A number above 0 that can be; raises UsageError that names the option."""
    if not is_finite(given) or given <= 0:
        raise UsageError(f"{option}: must be above 0 and finite (given: {shown(given)})")
    return float(given)


def checked_patience(patience: float) -> float:
    """Seconds that controllers may take, infinite for 0; raises UsageError."""
    if not is_finite(patience) or patience < 0:
        raise UsageError(
            "patience: must be finite and above 0, or 0 to wait for ever "
            f"(given: {shown(patience)})"
        )
    return float(patience) or math.inf


def is_finite(given: object) -> bool:
    """Whether it is a number, numpy's among them, and a finite one."""
    return isinstance(given, Real) and not isinstance(given, bool) and math.isfinite(given)


def shown(given: object) -> str:
    """A number as people write it, or whatever was given in its place."""
    return f"{given:g}" if isinstance(given, Real) else repr(given)


def checked_controllers(controllers: Controllers, loaded: LoadedWorld) -> Controllers:
    """Controllers that the world's robots have; raises UsageError for others."""
    if isinstance(controllers, bool):
        return controllers
    if not isinstance(controllers, Mapping):
        raise UsageError(
            "controllers: must be True, False, or a mapping from names of controllers to functions "
            f"(given: {controllers!r})"
        )
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
