"""The obstacles that have a name: where they are, and being put elsewhere."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians

from sim.stage.stage import Stage
from sim.worldfile.schema import World

Pose = tuple[float, float, float]


@dataclass(frozen=True)
class Thing:
    """An obstacle. `pose`: x, y, yaw at the start; `number`: among those that can be pushed.

    `z`: metres above the floor at which it begins.
    """

    pose: Pose
    number: int | None
    z: float

    def where(self, stage: Stage) -> Pose:
        """Where it is now, x, y, yaw in metres and radians."""
        if self.number is None:
            return self.pose
        x, y, yaw = map(float, stage.movable_poses[self.number])
        return x, y, yaw


def named_things(world: World) -> dict[str, Thing]:
    """The obstacles of a world that have a name, by it."""
    things: dict[str, Thing] = {}
    pushed = 0
    for obstacle in world.obstacles:
        x, y, heading = map(float, obstacle.pose)
        number = pushed if obstacle.movable else None
        pushed += obstacle.movable
        if obstacle.name is not None:
            things[obstacle.name] = Thing((x, y, radians(heading)), number, obstacle.z)
    return things
