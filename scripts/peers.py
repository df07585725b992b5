"""Other simulators at the same task, for rows beside ours in scripts/bench: peers.py NAME N TICKS.

Prints simulated seconds per second of one core, for robots that drive about with a laser of 180
rays over 180 degrees and 20 m, moved and sensed ten times a second, in the halls of scripts/bench.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from time import process_time
from typing import Any

INTERVAL = 0.1  # s
RANGE = 20.0  # m
RAYS = 180
SPEED = 0.4  # m/s


def hall(count: int) -> tuple[float, float]:
    """Width and height in metres for so many robots: 16 x 21, or 100 m2 for each."""
    side = round((count / 0.01) ** 0.5)
    return (16, 21) if count <= 4 else (side, side)


def places(count: int) -> list[tuple[float, float]]:
    """Where robots start: on a grid over the hall."""
    width, height = hall(count)
    row = math.ceil(count**0.5)
    return [((k % row + 0.5) * width / row, (k // row + 0.5) * height / row) for k in range(count)]


def navground(count: int) -> Callable[[], None]:
    """A tick of navground (C++): kinematics and lidars, no forces between bodies."""
    from navground import core, sim  # noqa: PLC0415

    width, height = hall(count)
    corners = [(0, 0), (width, 0), (width, height), (0, height)]
    world: Any = sim.World()
    for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
        world.add_wall(sim.Wall(core.LineSegment(start, end)))
    lidars: list[tuple[Any, Any, Any]] = []
    for number, place in enumerate(places(count)):
        drive = core.kinematics.TwoWheelsDifferentialDriveKinematics(SPEED, 0.5)
        lidar = sim.state_estimations.LidarStateEstimation(RANGE, -math.pi / 2, math.pi, RAYS)
        ahead = sim.tasks.DirectionTask((math.cos(number), math.sin(number)))
        behavior = core.behaviors.DummyBehavior(drive, 0.35)
        agent = sim.Agent(0.35, behavior, drive, ahead, [], INTERVAL)
        agent.position = place
        world.add_agent(agent)
        lidars.append((lidar, agent, core.SensingState()))
    world.update(INTERVAL)
    for lidar, agent, state in lidars:
        lidar.prepare(agent, world)
        lidar.prepare_state(state)

    def tick() -> None:
        world.update(INTERVAL)
        for lidar, agent, state in lidars:
            lidar.update(agent, world, state)

    return tick


def irsim(count: int) -> Callable[[], None]:
    """A tick of IR-SIM (Python): kinematics and lidars; who touches something stops."""
    import irsim as package  # noqa: PLC0415

    width, height = hall(count)
    robots = "".join(
        f"  - {{kinematics: {{name: diff}}, shape: {{name: rectangle, length: 0.5, width: 0.5}}, "
        f"state: [{x}, {y}, {number}], vel_max: [1, 1], sensors: [{{type: lidar2d, range_min: 0, "
        f"range_max: {RANGE}, angle_range: {math.pi}, number: {RAYS}}}]}}\n"
        for number, (x, y) in enumerate(places(count))
    )
    corners = [[0, 0], [width, 0], [width, height], [0, height], [0, 0]]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "world.yaml"
        path.write_text(
            f"world: {{height: {height}, width: {width}, step_time: {INTERVAL}, "
            f"collision_mode: stop}}\nrobot:\n{robots}"
            f"obstacle:\n  - {{shape: {{name: linestring, vertices: {corners}}}}}\n"
        )
        world = package.make(str(path), headless=True, log_level="ERROR")
    actions = [[SPEED, 0.1 * math.sin(number)] for number in range(count)]
    return lambda: world.step(actions)


PEERS: dict[str, Callable[[int], Callable[[], None]]] = {"navground": navground, "irsim": irsim}
DISTRIBUTIONS = {"navground": "navground", "irsim": "ir-sim"}


def main() -> None:
    """Print the version and the speed of a peer."""
    name, count, ticks = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    tick = PEERS[name](count)
    tick()
    began = process_time()
    for _ in range(ticks):
        tick()
    speed = INTERVAL * ticks / (process_time() - began)
    print(f"{name} {version(DISTRIBUTIONS[name])}: {float(f'{speed:.3g}'):g} x real time")


if __name__ == "__main__":
    main()
