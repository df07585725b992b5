"""Whole runs through the command line: with controllers, watched, from nothing."""

from __future__ import annotations

import csv
import json
import os
import re
import statistics
import subprocess
import sys
import threading
from pathlib import Path
from time import perf_counter

from onlookers import look_on

from measures.worlds import NO_BYTECODE, ROOT, hall, median_speed, raw_client, run_command, world


def team(folder: Path, count: int, duration: float, repeats: int) -> str:
    """Robots at 0.01 per m2, or four in the small hall, each with a process that wanders."""
    path = world(folder, "reader", duration, size=hall(count), count=count)
    return f"{median_speed(repeats, str(path)):.3g} x real time"


def watched(folder: Path, repeats: int, count: int = 4, viewers: int = 1) -> str:
    """The price of pages that watch: pairs of runs, without them and with them."""
    duration = 12000 / count
    path = str(world(folder, "reader", duration, size=hall(count), count=count))
    prices = []
    for _ in range(max(5, repeats)):
        alone = float(str(run_command(path)[0]["speed"]))
        prices.append(100 * (1 - watched_speed(path, viewers) / alone))
    return f"{statistics.median(prices):.1f} % of the speed"


def watched_speed(path: str, viewers: int) -> float:
    """The speed of a run while so many take every moment that comes, and draw nothing."""
    run = subprocess.Popen(
        [sys.executable, "-m", "troupe", "run", path, "--json", "--quiet", "--view", "--no-open"],
        cwd=ROOT,
        env={name: text for name, text in os.environ.items() if name != NO_BYTECODE},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert run.stderr is not None
    address = next(m[1] for line in run.stderr if (m := re.search(r"http://(\S+)", line)))
    threading.Thread(target=look_on, args=(address, viewers), daemon=True).start()
    return float(json.loads(run.communicate()[0])["speed"])


def rounds(folder: Path, controller: str, repeats: int) -> str:
    """Rounds in lockstep per second: a laser and blobs are read, a command is given."""
    path = world(folder, controller, 300, size=(16, 21), count=1)
    return f"{median_speed(repeats, str(path)) / 0.1:.0f} per second"


def raw_rounds(folder: Path, repeats: int) -> tuple[str, str]:
    """In which language four clients over TCP are written, and the rounds of each per second."""
    path = world(folder, "raw", 300, size=(16, 21), count=4)
    language = "C" if len(raw_client(folder)) == 1 else "Python"
    return language, f"{median_speed(repeats, str(path)) / 0.1:.0f} per second each"


def first_tick(repeats: int) -> str:
    run_command("worlds/wander.yaml", "--duration", "0.1")  # warms the caches
    times = [run_command("worlds/wander.yaml", "--duration", "0.1")[1] for _ in range(repeats)]
    return f"{statistics.median(times):.2f} s, the whole process with one tick"


def placements(folder: Path, number: int) -> str:
    """How much of two cores a sweep makes use of: the runs' own wall-clock times over two.

    Paint with four robots, from as many random placements to their goals, without painting.
    """
    out = folder / "placements"
    began = perf_counter()
    subprocess.run(
        [sys.executable, "-m", "troupe", "sweep", "worlds/paint_case_1.yaml", "--jobs", "2",
         "--set", "controllers.paint.args.paint=false", "--duration", "1800", "--quiet",
         "--seeds", f"1000:{1000 + number}", "--out", str(out)],
        cwd=ROOT,
        env={name: text for name, text in os.environ.items() if name != NO_BYTECODE},
        stdout=subprocess.DEVNULL,
        check=True,
    )  # fmt: skip
    passed = perf_counter() - began
    with (out / "timings.csv").open(newline="") as file:
        own = sum(float(row["wall_time"]) for row in csv.DictReader(file))
    return f"{own / 2 / passed:.0%} ({number / passed:.2f} runs per second)"
