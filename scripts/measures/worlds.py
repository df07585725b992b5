"""The worlds that are measured, and how their runs are started."""

from __future__ import annotations

import json
import os
import shutil
import statistics
import subprocess
import sys
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).resolve().parent.parent.parent

READER = """\
from player import BlobfinderProxy, LaserProxy, PlayerClient, Position2dProxy

with PlayerClient() as robot:
    base = Position2dProxy(robot)
    laser = LaserProxy(robot)
    blobs = BlobfinderProxy(robot)
    while robot.read():
        ahead = laser.ranges[60:120].min()
        near = sum(blob.range < 2.0 for blob in blobs.blobs)
        base.set_speed(0.4, 0.0 if ahead > 1.5 and not near else 0.8)
"""
WORLD = """\
size: {size}
duration: {duration}
until: duration
models:
  rover:
    body: {{shape: box, size: [1, 1], height: 1.0, color: green}}
    drive: {{kind: differential, max_speed: 0.5, max_turn_rate: 90}}
    sensors:
      - {{type: laser, range: 20, fov: 180, samples: 180}}
      - {{type: blobfinder, range: 20, fov: 180, image: [160, 120], colors: [red, green]}}
robots:
  - {{model: rover, count: {count}, placement: random, controller: {controller}}}
controllers:
  reader: {{program: ./reader.py}}
  outsider: {{command: [{python}, {reader}]}}
  raw: {{command: {raw}}}
"""
NO_BYTECODE = "PYTHONDONTWRITEBYTECODE"
"""Set on some machines: every start then compiles every module, which no user's start does."""


def world(
    folder: Path,
    controller: str,
    duration: float,
    *,
    size: tuple[int, int] = (316, 316),
    count: int = 1000,
) -> Path:
    """Write a world of robots with laser and blobfinder; its file."""
    (folder / "reader.py").write_text(READER)
    path = folder / f"{controller}_{count}.yaml"
    path.write_text(
        WORLD.format(
            duration=duration,
            controller=controller,
            size=list(size),
            count=count,
            python=json.dumps(sys.executable),
            reader=json.dumps(str(folder / "reader.py")),
            raw=json.dumps([*raw_client(folder), "{host}", "{port}"]),
        )
    )
    return path


def hall(count: int) -> tuple[int, int]:
    """Width and height in metres for so many robots."""
    side = round((count / 0.01) ** 0.5)
    return (16, 21) if count <= 4 else (side, side)


def raw_client(folder: Path) -> list[str]:
    """The command of a client that knows nothing of our packages: in C where there is a compiler.

    Built once in a folder.
    """
    program = folder / "raw_client"
    compiler = shutil.which("cc")
    if compiler is None:
        return [sys.executable, str(ROOT / "scripts" / "raw_client.py")]
    if not program.exists():
        source = ROOT / "scripts" / "raw_client.c"
        subprocess.run([compiler, "-O2", "-o", str(program), str(source)], check=True)
    return [str(program)]


def run_command(*words: str) -> tuple[dict[str, object], float]:
    """The JSON result of a run by the command line, and the whole process's seconds."""
    began = perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "troupe", "run", *words, "--json", "--quiet"],
        cwd=ROOT,
        env={name: text for name, text in os.environ.items() if name != NO_BYTECODE},
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout), perf_counter() - began


def median_speed(repeats: int, *words: str) -> float:
    """Median of simulated seconds per second over several runs."""
    speeds = []
    for _ in range(repeats):
        result, _ = run_command(*words)
        speeds.append(float(str(result["speed"])))
    return statistics.median(speeds)
