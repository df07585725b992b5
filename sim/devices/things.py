"""The obstacles with which devices deal: those that have a name, and those that give energy."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from typing import Any

from sim.stage.layout import Layout
from sim.stage.stage import Stage
from sim.stage.standing import Pose
from sim.worldfile.schema import World


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


@dataclass(frozen=True)
class Charger:
    """An obstacle that gives energy. `number`: the stage's, None where it stays for ever."""

    body: Any
    pose: Pose
    number: int | None

    def where(self, stage: Stage) -> Pose:
        """Where it is now."""
        return self.pose if self.number is None else stage.thing_pose(self.number)


def chargers_of(world: World) -> list[Charger]:
    """The chargers of a world, in its order."""
    things = [one for one in world.obstacles if one.movable]
    things += [one for one in world.obstacles if one.name is not None and not one.movable]
    numbers = {id(one): number for number, one in enumerate(things)}
    return [
        Charger(one, (*one.pose[:2], radians(one.pose[2])), numbers.get(id(one)))
        for one in world.obstacles
        if one.charger is not None
    ]
