"""Draws each example and each world of the gallery, for their pages: called by scripts/pictures."""

from __future__ import annotations

import os
import runpy
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

import troupe  # noqa: E402
from troupe.examples import Example, examples  # noqa: E402

MOMENTS = {
    "01_wander": 40,
    "02_follow_wall": 65,
    "03_find_blob": 5,
    "04_push": 22,
    "05_keep_distance": 40,
    "06_light_seeker": 4,
    "07_square": 20,
    "08_metric": 60,
    "09_dead_reckoning": 19,
    "10_disperse": 70,
}
"""Simulated seconds at which something can be seen."""
WIDTH, HEIGHT = 360, 280


def draw(example: Example, at: float) -> None:
    """Run an example until that moment, and draw it."""
    name = f"examples/{example.name}"
    world = example.folder / "world.yaml"
    if example.name == "05_keep_distance":
        drive = runpy.run_path(str(example.folder / "keep_distance.py"))["keep_distance"]
        picture(name, world, at, controllers=False, each_tick=drive, video_show=["trails"])
    elif example.name == "07_square":
        clients: list[subprocess.Popen[bytes]] = []
        picture(name, world, at, set={"player.port": 0}, say=by_hand(example, clients))
        for client in clients:
            client.wait()
    else:
        picture(name, world, at)


def picture(name: str, world: Path, at: float, **more: Any) -> None:
    """Run a world with seed 3 until that moment, and draw it."""
    target = ROOT / "docs" / "pictures" / f"{name}.png"
    target.parent.mkdir(exist_ok=True)
    told = {"video_show": ["fans", "trails"], "seed": 3, "video_size": (WIDTH, HEIGHT), **more}
    troupe.run(world, duration=at, at=at, picture=target, **told)


def by_hand(example: Example, clients: list[subprocess.Popen[bytes]]) -> Callable[[str], None]:
    """What listens to a run's lines, and starts the example's program when it is told a port."""

    def say(line: str) -> None:
        _, found, port = line.partition("served at 127.0.0.1:")
        if found and not clients:
            variables = {**os.environ, "PLAYER_PORT": port, "PYTHONPATH": str(ROOT)}
            program = [sys.executable, str(example.folder / "square.py")]
            clients.append(
                subprocess.Popen(program, env=variables, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL)
            )  # fmt: skip

    return say


for one in examples():
    draw(one, MOMENTS[one.name])
for stage in sorted((ROOT / "docs" / "gallery").glob("*.world")):
    show = ["trails"] if stage.stem == "flock" else ["fans", "trails"]
    picture(f"gallery/{stage.stem}", stage.with_suffix(".yaml"), 15.0, video_show=show)
