"""What must go together in a world as a whole: size, region, paint, ports, doors and clock."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, radians
from typing import Any

from sim.stage.limits import DEEPEST, MOST_PUSH, MOST_RATIO, MOST_SUBSTEPS
from sim.worldfile.mistakes import Mistake
from sim.worldfile.schema import Drive, World

MOST_CELLS = 200_000_000
"""Cells of the paint layer, of which each takes a few bytes."""

MOST_PORT = 65535


def size_mistakes(world: World, size: tuple[float, float]) -> list[Mistake]:
    """What does not fit the world's size (width, height in m), that of its map if it has one."""
    mistakes: list[Mistake] = []
    width, height = size
    slack = 1e-9 * max(size)
    for x, y in world.region or ():
        if not (-slack <= x <= width + slack and -slack <= y <= height + slack):
            mistakes.append(
                Mistake(
                    ("region",),
                    "a corner lies outside of the world",
                    f"[{x:g}, {y:g}]",
                    f"x from 0 to {width:g}, y from 0 to {height:g}",
                )
            )
    cells = ceil(width / world.floor.resolution) * ceil(height / world.floor.resolution)
    if cells > MOST_CELLS and any(model.actuators for model in world.models.values()):
        mistakes.append(
            Mistake(
                ("floor", "resolution"),
                f"the paint layer would have {cells:.3g} cells",
                f"{world.floor.resolution:g}",
                f"at most {MOST_CELLS:.3g} cells",
            )
        )
    return mistakes


def period_mistakes(world: World) -> list[Mistake]:
    """Periods of doors whose steps would not end where a tick does."""
    mistakes: list[Mistake] = []
    interval = world.clock.interval
    for index, door in enumerate(world.doors):
        ticks = door.period / interval
        if round(ticks) < 1 or abs(ticks - round(ticks)) > 1e-9 * ticks:
            near = interval * max(1, round(ticks))
            mistakes.append(
                Mistake(
                    ("doors", index, "period"),
                    "is not a whole number of the clock's intervals",
                    f"{door.period:g}",
                    f"a multiple of {interval:g}, such as {near:g}",
                )
            )
    return mistakes


def physics_mistakes(world: World) -> list[Mistake]:
    """What the physics could not keep apart: too unequal masses, too strong or too fast drives.

    Only models count that robots or doors use.
    """
    from sim.stage.geometry import least_width, outline, reach  # noqa: PLC0415

    bodies = list(_moving(world))
    if not bodies:
        return []
    mistakes: list[Mistake] = []
    lightest, least = min(((body.mass, where) for where, body, _ in bodies), key=lambda one: one[0])
    than = f"{lightest:g} kg of {'.'.join(map(str, least))}"
    clock, longest, fastest = world.clock, float("inf"), ""
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
        lever, width = 0.0, 2.0 * getattr(body, "radius", 0.0)
        if body.shape != "circle":
            lever, width = reach(body), least_width(outline(body))
        speed = drive.max_speed + radians(drive.max_turn_rate) * lever
        step = MOST_SUBSTEPS * min(DEEPEST, width / 2.0) / (2.0 * speed)
        if step < longest:
            longest, fastest = step, f"{where[1]} at {speed:.6g} m/s"
    if clock.physics_step > longest:
        near = clock.interval / max(1, ceil(clock.interval / longest))
        what = "is so long that bodies could pass through others in it"
        allowed = f"at most {longest:.3g} for model {fastest}, such as {near:.6g}"
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


def port_mistakes(world: World, robots: int) -> list[Mistake]:
    """Ports of the robots that would lie beyond the last one."""
    port = world.player.port
    if not port or world.player.layout == "shared" or port + robots - 1 <= MOST_PORT:
        return []
    return [
        Mistake(
            ("player", "port"),
            f"the last of {robots} robots would be at port {port + robots - 1}",
            str(port),
            f"at most {MOST_PORT + 1 - robots}, or layout: shared",
        )
    ]
