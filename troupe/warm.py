"""Compiles every kernel that ships, once, before the first command that computes."""

from __future__ import annotations

import contextlib
import hashlib
import platform
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

# What loads numba is loaded when it is needed: other commands stay quick.
# ruff: noqa: PLC0415

ROOT = Path(__file__).resolve().parent.parent
SOURCES = (
    "sensors",
    "sim/devices",
    "sim/log",
    "sim/stage",
    "controllers/dispersal",
    "controllers/dispersal/rules",
    "gridworld",
)
"""The folders of the kernels."""

KEPT = "compiling the kernels for this machine, only once (it may take a minute); kept in {} ..."
NOT_KEPT = (
    "the compiled kernels cannot be kept, so they are compiled anew each time: no cache folder can "
    "be written. Set NUMBA_CACHE_DIR to a folder that can be"
)

WORLD = """\
# One of everything that is computed by a kernel.
size: [12, 12]
obstacles:
  - {shape: circle, radius: 0.4, pose: [6, 6, 0], movable: true}
models:
  all:
    body: {shape: box, size: [0.6, 0.6]}
    fiducial: 1
    odometry_noise: {slip: 0.01, turn: 0.01}
    sensors:
      - {type: laser, noise: 0.01}
      - {type: ranger, elements: [[0.3, 0, 0]], range: 5, fov: 15, noise: 0.01}
      - {type: blobfinder, colors: [red]}
      - {type: fiducial}
      - {type: bumper}
    actuators: [{type: sprayer}]
  car:
    body: {shape: circle, radius: 0.3}
    drive: {kind: car, wheelbase: 0.4, max_steering: 30}
    localization: gps
    sensors: [{type: laser, range: 5}]
  slider:
    body: {shape: polygon, points: [[-0.3, -0.3], [0.3, 0], [-0.3, 0.3]]}
    drive: {kind: omnidirectional}
    sensors: [{type: blobfinder, range: 5, image: [40, 30]}]
robots:
  - {model: all, pose: [0.302, 6, 180]}  # 2 mm from the wall, which it is going to touch
  - {model: all, placement: random}
  - {model: car, count: 2, placement: random}
  - {model: slider, count: 2, placement: random}
"""


looked: list[bool] = []
"""Not empty once somebody in this process has looked whether kernels are to be compiled."""


def tell(line: str) -> None:
    """Print a line on standard error."""
    print(line, file=sys.stderr, flush=True)


def warm_once(say: Callable[[str], None]) -> Path | None:
    """Compile what has not been compiled on this machine; where it is kept, None if nowhere.

    Where nothing can be kept nothing is done: each kernel is compiled when it is needed.
    """
    from troupe.kernel_cache import cache_folder, distrust_cache

    looked.append(True)
    distrust_cache()
    folder = cache_folder()
    if folder is None:
        return None
    mark = folder / f"{machine()}-{sources()}.warm"
    if not mark.exists():
        say(KEPT.format(folder))
        compile_all()
        with contextlib.suppress(OSError):  # a full disk: the next command tries it again
            for older in folder.glob(f"{machine()}-*.warm"):
                older.unlink()
            mark.touch()
    return folder


def warm_first(say: Callable[[str], None]) -> None:
    """The same, unless somebody in this process has looked already."""
    if not looked:
        warm_once(say)


def machine() -> str:
    """What machine code depends on besides the sources."""
    import numba
    from llvmlite import binding

    features = sorted(binding.get_host_cpu_features().items())
    parts = (numba.__version__, sys.version, platform.machine(), binding.get_host_cpu_name())
    return hashlib.sha256(repr((parts, features)).encode()).hexdigest()[:12]


def sources(root: Path = ROOT) -> str:
    """A digest of what the kernels' sources are, by their sizes and times."""
    files = sorted(path for name in SOURCES for path in (root / name).glob("*.py"))
    stats = [(path.name, path.stat()) for path in [*files, root / "troupe" / "warm.py"]]
    text = repr([(name, stat.st_mtime_ns, stat.st_size) for name, stat in stats])
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def compile_all() -> None:
    """Do a little of everything that is computed by a kernel."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "everything.yaml"
        path.write_text(WORLD)
        sense_and_move(path)
        keep(path)
    disperse()


def sense_and_move(world: Path) -> None:
    """A small world in which everything is sensed and every drive and sprayer on."""
    from sim.build import load
    from sim.rehearsal import run_for_nobody

    run_for_nobody(load(world), seed=1)


def keep(world: Path) -> None:
    """A log of all of that."""
    from troupe.simulation import Simulation

    log = world.with_suffix(".mcap")
    with Simulation(world, log=log, log_sensors=["all"], controllers=False) as simulation:
        simulation.step()
        simulation.command(forward=0.1)
        simulation.step()


def disperse() -> None:
    """Every rule on a small grid."""
    from controllers.dispersal.rules import RULES
    from gridworld.grid import simulate
    from gridworld.median import best_door
    from gridworld.regions import rectangle

    region = rectangle(3, 3, [(1, 1)])
    best_door(region)
    for rule in RULES:
        simulate(region, rule)
