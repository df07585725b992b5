"""Have every kernel compiled, and the machine code kept, so that the first run need not wait."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from controllers.dispersal.rules import RULES  # noqa: E402
from gridworld.grid import simulate  # noqa: E402
from gridworld.median import best_door  # noqa: E402
from gridworld.regions import rectangle  # noqa: E402
from sim.engine import Settings  # noqa: E402
from sim.run import run_world  # noqa: E402
from sim.worldfile import load  # noqa: E402

WORLD = """\
# One of everything that is computed by a kernel.
size: [12, 12]
duration: 2
until: duration
obstacles:
  - {shape: circle, radius: 0.4, pose: [6, 6, 0], movable: true}
models:
  all:
    body: {shape: box, size: [0.6, 0.6]}
    fiducial: 1
    odometry_noise: {slip: 0.01, turn: 0.01}
    sensors:
      - {type: laser, noise: 0.01}
      - {type: ranger, elements: [[0.3, 0, 0]], range: 5, fov: 15}
      - {type: blobfinder, colors: [red]}
      - {type: fiducial}
      - {type: bumper}
    actuators: [{type: sprayer}]
  car:
    body: {shape: circle, radius: 0.3}
    drive: {kind: car, wheelbase: 0.4, max_steering: 30}
    localization: gps
  slider:
    body: {shape: polygon, points: [[-0.3, -0.3], [0.3, 0], [-0.3, 0.3]]}
    drive: {kind: omnidirectional}
robots:
  - {model: all, count: 2, placement: random, controller: wander}
  - {model: car, count: 2, placement: random}
  - {model: slider, count: 2, placement: random}
"""


def main() -> None:
    """Run a small world in which everything is sensed, and every rule on a small grid."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "everything.yaml"
        path.write_text(WORLD)
        run_world(load(path), Settings(seed=1, duration=2.0, sense_all=True))
    region = rectangle(3, 3, [(1, 1)])
    best_door(region)
    for rule in RULES:
        simulate(region, rule)


if __name__ == "__main__":
    main()
