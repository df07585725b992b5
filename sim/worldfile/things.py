"""Names of obstacles: each stands for one thing, also where robots have names."""

from __future__ import annotations

from collections.abc import Iterable

from sim.worldfile.mistakes import Mistake
from sim.worldfile.robots import RobotSpec, numbered
from sim.worldfile.schema import Door
from sim.worldfile.shapes import Obstacle


def thing_name_mistakes(
    obstacles: Iterable[tuple[int, Obstacle]],
    robots: Iterable[RobotSpec],
    doors: Iterable[tuple[int, Door]],
) -> list[Mistake]:
    """Names of obstacles (index in the file, obstacle) that another one, or a robot, has too."""
    named = [(index, thing.name) for index, thing in obstacles if thing.name is not None]
    if not named:
        return []
    owner = {robot.name: f"robots.{robot.entry} has a robot of this name" for robot in robots}
    stems = [(index, door.name) for index, door in doors]
    mistakes: list[Mistake] = []
    for index, name in named:
        from_door = next((k for k, stem in stems if numbered(name, stem)), None)
        taken = owner.get(name)
        if taken is None and from_door is not None:
            taken = f"a robot from doors.{from_door} may be called so"
        if taken is not None:
            where = ("obstacles", index, "name")
            mistakes.append(Mistake(where, taken, name, "another name"))
        owner.setdefault(name, f"obstacles.{index} has this name")
    return mistakes
