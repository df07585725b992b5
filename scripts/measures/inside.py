"""Runs from Python, their sensors, and other simulators at the same task."""

from __future__ import annotations

import statistics
import subprocess
import sys
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from measures.worlds import ROOT, hall, world

if TYPE_CHECKING:
    from troupe.simulation import Simulation

Floats = NDArray[np.float64]
PEERS = (("navground", "C++, no forces, no blobfinder"), ("irsim", "Python, no blobfinder"))
LOADING = """\
import resource, sys
from time import process_time
sys.path.insert(0, sys.argv[1])
import troupe
began = process_time()
with troupe.Simulation(sys.argv[2], seed=1, controllers=False) as sim:
    sim.readings("laser"), sim.readings("blobfinder")
    sim.step()
    there = process_time()
    sim.step(3)
    tick = (process_time() - there) / 3 / len(sim.names) * 1e6
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
print(f"{there - began:.0f} s to the first reading, {memory:.1f} GB, "
      f"{tick:.1f} us a robot and tick")
"""


def in_process(
    folder: Path, count: int, ticks: int, repeats: int, *, blind: bool = False
) -> tuple[str, str]:
    """Speed of a simulation that is driven and read from Python, and nanoseconds per ray of lasers.

    Robots go ahead and turn away from what their lasers show before them, as `READER` does; or,
    blind, ahead and anywhere, so that many come to press against walls. Both figures by the
    processor's time, which other programs on the machine disturb less: simulated seconds per second
    of one core.
    """
    import troupe  # noqa: PLC0415 - after the path is set

    random = np.random.default_rng(1)
    speeds = []
    path = world(folder, "null", 1e6, size=hall(count), count=count)
    with troupe.Simulation(path, seed=1, controllers=False) as sim:
        turn = np.zeros(count)
        for _ in range(repeats + 1):
            began = process_time()
            turn = drive(sim, turn, ticks, random if blind else None)
            speeds.append(0.1 * ticks / (process_time() - began))
    return (
        f"{float(f'{statistics.median(speeds[1:]):.3g}'):g} x real time",
        f"{ray(path):.1f} ns",
    )


def drive(
    sim: Simulation, turn: Floats, ticks: int, blindly: np.random.Generator | None = None
) -> Floats:
    """So many ticks, all sensors read in each; how fast robots are to turn next, (n,) rad/s.

    They turn away from what their lasers show, or blindly, as a generator has it.
    """
    for _ in range(ticks):
        sim.command(forward=0.4, turn=turn)
        sim.step()
        ranges = sim.readings("laser").ranges
        sim.readings("blobfinder").counts  # noqa: B018 - it is made
        if blindly is None:
            turn = np.where(ranges[:, 60:120].min(axis=1) > 1.5, 0.0, 0.8)
        else:
            turn = blindly.standard_normal(len(turn)) * 0.5
    return turn


def ray(path: Path) -> float:
    """Nanoseconds of a ray, all lasers of a world in one batch."""
    from sim.build import load  # noqa: PLC0415 - after the path is set
    from sim.scenery import Scenery  # noqa: PLC0415

    loaded = load(path)
    field = Scenery(loaded, 1)
    for spec, pose in zip(loaded.robots, field.start_poses, strict=True):
        field.add_robot(spec.name, spec.model, loaded.world.models[spec.model], pose)
    field.stage.tick()
    field.refresh()
    lasers = np.zeros(field.suite.slots, bool)
    lasers[0::2] = True
    times = []
    for tick in range(21):
        began = process_time()
        field.suite.sense(tick, 0.0, lasers)
        times.append(process_time() - began)
    return statistics.median(times[1:]) / (len(loaded.robots) * 180) * 1e9


def peers(python: str, count: int, ticks: int) -> list[tuple[str, str, str]]:
    """Rows of other simulators at the same task, as far as an interpreter has them."""
    rows = []
    for name, kind in PEERS:
        script = str(ROOT / "scripts" / "peers.py")
        done = subprocess.run(
            [python, script, name, str(count), str(ticks)],
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        if done.returncode == 0:
            known, _, speed = done.stdout.strip().splitlines()[-1].partition(": ")
            rows.append((f"the same in {known} ({kind})", "", speed))
        elif "ModuleNotFoundError" not in done.stderr:
            raise RuntimeError(done.stderr)
    return rows


def loading(folder: Path, count: int) -> str:
    """What a large crowd takes: seconds of the processor, memory, and the cost of a tick."""
    path = world(folder, "null", 10, size=hall(count), count=count)
    words = [sys.executable, "-c", LOADING, str(ROOT), str(path)]
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout.strip()
