"""Limits of the physics: what the stage cuts its steps for, and what world files may ask of it."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, radians
from typing import TYPE_CHECKING, Any

from sim.stage.geometry import girth, reach
from sim.worldfile.dividing import clock_within
from sim.worldfile.mistakes import Mistake

if TYPE_CHECKING:
    from sim.worldfile.schema import Drive, World

DEEPEST = 0.015
"""m that bodies may close in a substep. With the slop of 0.005 m that Chipmunk leaves
between bodies that rest on each other, this keeps overlaps below 0.02 m. Bodies so small that they
would pass through something in one may close by half of what they are wide."""
SLOP = 0.005
"""m that bodies which rest on each other may overlap."""
MOST_SUBSTEPS = 4000
"""Of a step, against a run that would never end."""
MOST_RATIO = 1000.0
"""Of the masses of two bodies that move."""
MOST_PUSH = 1e5
"""m/s2: the largest force of a drive over the mass of the lightest body; 100 m/s2 on one that is
MOST_RATIO times as heavy."""


def physics_mistakes(world: World) -> list[Mistake]:
    """What the physics could not keep apart: too unequal masses, too strong or too fast drives.

    Only models count that robots or doors use.
    """
    bodies = [one for one in _moving(world) if one[1].solid]
    if not bodies:
        return []
    mistakes: list[Mistake] = []
    lightest, least = min(((body.mass, where) for where, body, _ in bodies), key=lambda one: one[0])
    than = f"{lightest:g} kg of {'.'.join(map(str, least))}"
    clock, longest, fastest = world.clock, inf, ""
    for where, body, drive in bodies:
        if body.mass > MOST_RATIO * lightest * (1 + 1e-9):
            what = "is too heavy for the lightest body"
            allowed = f"at most {MOST_RATIO:g} times the {than}"
            place = (*where, "body", "mass") if where[0] == "models" else (*where, "mass")
            mistakes.append(Mistake(place, what, f"{body.mass:g}", allowed))
        if drive is None:
            continue
        if drive.max_force > MOST_PUSH * lightest * (1 + 1e-9):
            what = "is too strong for the lightest body"
            allowed = f"at most {MOST_PUSH * lightest:g}: {MOST_PUSH:g} m/s2 for the {than}"
            place = (*where, "drive", "max_force")
            mistakes.append(Mistake(place, what, f"{drive.max_force:g}", allowed))
        lever = 0.0 if body.shape == "circle" else reach(body)
        speed = drive.max_speed + radians(drive.max_turn_rate) * lever
        step = MOST_SUBSTEPS * min(DEEPEST, girth(body)) / (2.0 * speed)
        if step < longest:
            longest = step
            fastest = f"model {where[1]}, {2.0 * girth(body):.3g} m wide, at {speed:.6g} m/s"
    if clock.physics_step > longest:
        what = "is so long that bodies could pass through others in it"
        works = clock_within(clock.interval, longest)
        allowed = f"at most {longest:.3g} for {fastest}, such as {works}"
        mistakes.append(
            Mistake(("clock", "physics_step"), what, f"{clock.physics_step:g}", allowed)
        )
    return mistakes


def _moving(world: World) -> Iterator[tuple[tuple[str | int, ...], Any, Drive | None]]:
    """Where in the file a body that moves is described, the body, and its drive."""
    used = [robot.model for robot in world.robots] + [door.model for door in world.doors]
    for name in dict.fromkeys(used):
        if name in world.models:
            yield ("models", name), world.models[name].body, world.models[name].drive
    for index, obstacle in enumerate(world.obstacles):
        if obstacle.movable:
            yield ("obstacles", index), obstacle, None
