"""The world file of a run with its robots and things where they are now."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import yaml

from sim.log.world import unpacked
from sim.worldfile import nodes
from sim.worldfile.files import rebased

if TYPE_CHECKING:
    from sim.build import LoadedWorld
    from sim.view.moment import Moment


DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
"""libyaml's, where it is there, is ten times faster."""


def saved_world(loaded: LoadedWorld, moment: Moment) -> str:
    """The text of a world file that begins as things stand in a moment.

    Names of files in it start where those of the run's own world file do. Who has come in through a
    door is there from the start, under another name: the door gives its names again.
    """
    data = unpacked(rebased(nodes.plain(loaded.root), loaded.root, loaded.folder))
    controllers = {robot.name: robot.controller for robot in loaded.robots}
    doors = {door.name: door.controller for door in loaded.layout.doors}
    robots: list[dict[str, Any]] = []
    taken = {robot.name for robot in moment.robots}
    for robot, pose in zip(moment.robots, moment.poses.tolist(), strict=True):
        name, controller = robot.name, controllers.get(robot.name)
        if name not in controllers:
            controller = doors.get(name.rstrip("0123456789"))
            name = fresh(f"entered_{name}", taken)
        entry = {"name": name, "model": robot.model, "pose": written(pose)}
        robots.append(entry if controller is None else {**entry, "controller": controller})
    data["robots"] = robots
    obstacles = data.get("obstacles") or ()
    things = [one for one in obstacles if one.get("movable")]
    things += [one for one in obstacles if one.get("name") and not one.get("movable")]
    for thing, pose in zip(things, moment.things.tolist(), strict=True):
        thing["pose"] = written(pose)
    data["seed"] = moment.status.get("seed", loaded.world.seed)
    text: str = yaml.dump(
        data, Dumper=DUMPER, sort_keys=False, default_flow_style=None, allow_unicode=True
    )
    where = f"{loaded.path.name} at {moment.time:.2f} s, seed {data['seed']}"
    return f"# {' '.join(where.split())}. Put it beside that file.\n{text}"


def written(pose: list[float]) -> list[float]:
    """A pose in metres and radians as world files have it, to a hundredth of a millimetre."""
    x, y, yaw = pose
    return [round(x, 5), round(y, 5), round(math.degrees(yaw), 4)]


def fresh(name: str, taken: set[str]) -> str:
    """The name, or one like it that nobody has; it is taken now."""
    number, found = 1, name
    while found in taken:
        number += 1
        found = f"{name}_{number}"
    taken.add(found)
    return found
