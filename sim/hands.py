"""What is put somewhere by hand: robots and obstacles, by clients that may do so."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from sim.devices.device import Context


@dataclass
class Hands:
    """Puts what clients have asked for where they want it; `say` is told of what has no room."""

    context: Context
    say: Callable[[str], None]

    def put_all(self) -> None:
        """Put robots where they shall be put, all at once, and then obstacles one by one."""
        if goals := self.context.take_puts():
            self.put(goals)
        for name, pose in self.context.take_thing_puts().items():
            self.put_thing(name, pose)

    def reset(self) -> None:
        """Put all robots back where they entered: a client with full access has asked for it.

        So is what stands, before the robots or after them, as there is room.
        """
        self.context.resets = 0
        self.put_back()
        starts = {robot.index: robot.record.start for robot in self.context.robots}
        staying = self.put(starts)
        for name, start in self.put_back():
            self.say(stays(name, start))
        for robot in starts:
            if robot not in staying:
                self.context.scenery.odometry.reset(robot)

    def put_back(self) -> list[tuple[str, tuple[float, float, float]]]:
        """Put fixtures back to where they stood at the start; those for which there is no room."""
        scenery = self.context.scenery
        first = len(scenery.stage.layout.movables)
        return [
            (one.name, one.start)
            for number, one in enumerate(scenery.stage.layout.fixtures, first)
            if one.pose != one.start and not scenery.put_thing(number, one.start)
        ]

    def put(self, poses: Mapping[int, tuple[float, float, float]]) -> list[int]:
        """Put robots at poses in the world, all at once; those who have no room there, and stay."""
        staying = self.context.scenery.put(poses)
        for robot in staying:
            self.say(stays(self.context.robots[robot].name, poses[robot]))
        return staying

    def put_thing(self, name: str, pose: tuple[float, float, float]) -> None:
        """Put an obstacle at a pose in the world, if there is room."""
        if not self.context.scenery.put_thing(self.context.things[name].number, pose):
            self.say(stays(name, pose))


def stays(name: str, pose: tuple[float, float, float]) -> str:
    """What is told of somebody, or something, that cannot be put at a pose."""
    return f"{name} stays where it is: there is no room for it at [{pose[0]:g}, {pose[1]:g}]"
