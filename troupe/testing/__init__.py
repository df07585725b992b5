"""For those who test worlds, controllers and sensors of their own: what judges runs from outside.

    evidence = Evidence.of("run.mcap")       # a log, whoever made it; or a run, by a Watch
    assert not contacts(evidence)

`evidence.py` says what a judge looks at; `touching.py`, `nearness.py`, `ranks.py`, `ground.py` and
`again.py` ask it one question each, on the geometry of `outlines.py`. `lockstep.py` serves a world
to a controller under test, `wire.py` is a client that knows nothing of ours, `rays.py` what a
sensor should read, by brute force. `paint` and `fcdfs.py` judge the papers' algorithms.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from troupe.testing.again import Difference, first_difference
    from troupe.testing.evidence import Evidence, Watch
    from troupe.testing.ground import covered
    from troupe.testing.lockstep import Lockstep
    from troupe.testing.nearness import clearances, distances
    from troupe.testing.ranks import Passing, passings
    from troupe.testing.touching import Contact, contacts
    from troupe.testing.wire import RawClient

_HOMES = {
    "Contact": "touching",
    "Difference": "again",
    "Evidence": "evidence",
    "Lockstep": "lockstep",
    "Passing": "ranks",
    "RawClient": "wire",
    "Watch": "evidence",
    "clearances": "nearness",
    "contacts": "touching",
    "covered": "ground",
    "distances": "nearness",
    "first_difference": "again",
    "passings": "ranks",
}

__all__ = [
    "Contact",
    "Difference",
    "Evidence",
    "Lockstep",
    "Passing",
    "RawClient",
    "Watch",
    "clearances",
    "contacts",
    "covered",
    "distances",
    "first_difference",
    "passings",
]


def __getattr__(name: str) -> Any:
    """What is imported on first use."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    """What there is to be used, loaded or not yet."""
    return sorted(__all__)
