"""Whole runs: with controllers, watched, kept in a log, from nothing."""

from __future__ import annotations

import csv
import json
import os
import re
import statistics
import subprocess
import sys
import threading
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from onlookers import look_on

from measures.inside import drive
from measures.pairs import pairs
from measures.worlds import NO_BYTECODE, ROOT, hall, median_speed, raw_client, run_command, world


def team(folder: Path, count: int, duration: float, repeats: int) -> str:
    """Robots at 0.01 per m2, or four in the small hall, each with a process that wanders."""
    path = world(folder, "reader", duration, size=hall(count), count=count)
    return f"{median_speed(repeats, str(path)):.3g} x real time"


def watched(folder: Path, repeats: int, count: int = 4, viewers: int = 1) -> str:
    """The price of pages that watch: pairs of runs, without them and with them."""
    duration = 12000 / count
    path = str(world(folder, "reader", duration, size=hall(count), count=count))
    speeds = pairs(
        max(5, repeats),
        lambda: float(str(run_command(path)[0]["speed"])),
        lambda: watched_speed(path, viewers),
    )
    price = statistics.median(100 * (1 - watched / alone) for alone, watched in speeds)
    return f"{price:.1f} % of the speed"


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


def logged(folder: Path, sensors: bool, repeats: int, duration: float = 1000.0) -> str:
    """How much longer a run of four robots with their processes takes that keeps a log.

    From the start until the log is whole, by the wall clock, over the time of the ticks.
    """
    import troupe  # noqa: PLC0415 - after the path is set

    path = world(folder, "reader", duration, size=hall(4), count=4)

    def run(**log: Any) -> tuple[float, float]:
        began = perf_counter()
        ticks = troupe.run(path, **log).wall_time
        return perf_counter() - began, ticks

    found = pairs(max(5, repeats), run, partial(run, **kept(folder, sensors)))
    return longer((after - before) / ticks for (before, ticks), (after, _) in found)


def logged_in_process(folder: Path, count: int, sensors: bool, repeats: int, ticks: int) -> str:
    """The same of robots without processes, which are driven and read from Python."""
    import troupe  # noqa: PLC0415 - after the path is set

    path = world(folder, "null", 1e6, size=hall(count), count=count)

    def run(**log: Any) -> float:
        with troupe.Simulation(path, seed=1, controllers=False, **log) as sim:
            turn = drive(sim, np.zeros(count), 20)
            began = perf_counter()
            drive(sim, turn, ticks)
        return perf_counter() - began

    found = pairs(max(5, repeats), run, partial(run, **kept(folder, sensors)))
    return longer(after / before - 1 for before, after in found)


def kept(folder: Path, sensors: bool) -> dict[str, Any]:
    """What `troupe.run` and `troupe.Simulation` are told of a log, which each run writes anew."""
    return {"log": folder / "kept.mcap", "log_sensors": ["all"] if sensors else []}


def longer(shares: Iterable[float]) -> str:
    return f"{statistics.median(shares):.1%} longer"


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
