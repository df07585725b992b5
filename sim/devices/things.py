"""The obstacles that have a name: where they are, and being put elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

from sim.stage.layout import Layout


@dataclass(frozen=True)
class Thing:
    """An obstacle. `number`: the stage's; `z`: metres above the floor at which it begins."""

    number: int
    z: float


def named_things(layout: Layout) -> dict[str, Thing]:
    """The obstacles of a world that have a name, by it."""
    things = [movable.body for movable in layout.movables]
    things += [fixture.body for fixture in layout.fixtures]
    named = ((number, body) for number, body in enumerate(things) if body.name is not None)
    return {body.name: Thing(number, body.z) for number, body in named}
