"""What must go together in a world as a whole: size, region, paint, ports, doors and clock."""

from __future__ import annotations

from math import ceil

from sim.worldfile.dividing import divides, shown
from sim.worldfile.mistakes import Mistake
from sim.worldfile.schema import World

MOST_CELLS = 200_000_000
"""Cells of the paint layer, of which each takes a few bytes."""

MOST_PORT = 65535


def size_mistakes(world: World, size: tuple[float, float]) -> list[Mistake]:
    """What does not fit the world's size (width, height in m), that of its map if it has one."""
    mistakes: list[Mistake] = []
    width, height = size
    slack = 1e-9 * max(size)
    left, low = low_corner(world.origin, size)
    right, high = left + width, low + height
    for x, y in world.region or ():
        if not (left - slack <= x <= right + slack and low - slack <= y <= high + slack):
            mistakes.append(
                Mistake(
                    ("region",),
                    "a corner lies outside of the world",
                    f"[{x:g}, {y:g}]",
                    f"x from {left:g} to {right:g}, y from {low:g} to {high:g}",
                )
            )
    cells = ceil(width / world.floor.resolution) * ceil(height / world.floor.resolution)
    if cells > MOST_CELLS and _paints(world):
        mistakes.append(
            Mistake(
                ("floor", "resolution"),
                f"the paint layer would have {cells:.3g} cells",
                f"{world.floor.resolution:g}",
                f"at most {MOST_CELLS:.3g} cells",
            )
        )
    return mistakes


def _paints(world: World) -> bool:
    """Whether a robot could have a sprayer."""
    return any(one.type == "sprayer" for model in world.models.values() for one in model.actuators)


def low_corner(
    origin: str | tuple[float, float] | None, size: tuple[float, float]
) -> tuple[float, float]:
    """The lower left corner of a world of a size (m), in coordinates that count from its origin."""
    if origin is None:
        return 0.0, 0.0
    x, y = (size[0] / 2, size[1] / 2) if isinstance(origin, str) else origin
    return 0.0 - x, 0.0 - y


def period_mistakes(world: World) -> list[Mistake]:
    """Periods of doors whose steps would not end where a tick does."""
    mistakes: list[Mistake] = []
    interval = world.clock.interval
    for index, door in enumerate(world.doors):
        if not divides(interval, door.period):
            near = interval * max(1, round(door.period / interval))
            told = shown(near, lambda period: divides(interval, period))
            mistakes.append(
                Mistake(
                    ("doors", index, "period"),
                    "is not a whole number of the clock's intervals",
                    f"{door.period:g}",
                    f"a multiple of {interval:g}, such as {told}",
                )
            )
    return mistakes


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
