"""When Python looks for useless objects, where very many are made that are none."""

from __future__ import annotations

import contextlib
import gc
from collections.abc import Iterator

CROWD = 5000
"""Robots so many that to look through all that is known of them takes a while."""


@contextlib.contextmanager
def kept_objects(robots: int) -> Iterator[None]:
    """While so many robots are made, all of which stay, nobody looks.

    With ten thousand of them that took a fifth of the time. Afterwards Python would look through a
    crowd three times, as it gets older: once is enough.
    """
    looks = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if looks:
            gc.enable()
            if robots >= CROWD:
                gc.collect()
