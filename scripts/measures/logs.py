"""What a log costs the run that is kept, and what it takes to look into one."""

from __future__ import annotations

import statistics
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from measures.worlds import world


def log_cost(folder: Path, count: int, sensors: bool, repeats: int) -> str:
    """What a log costs a run without controllers, as the processor time of its two parts.

    The hook in the tick delays the run; the thread runs beside it where a core is free.
    """
    from sim.build import load  # noqa: PLC0415
    from sim.engine import Engine, Settings  # noqa: PLC0415 - after the path is set
    from sim.fleet.fleet import Fleet  # noqa: PLC0415
    from sim.log.recorder import open_log  # noqa: PLC0415

    size = (16, 21) if count == 4 else (316, 316)
    loaded = load(world(folder, "null", 1e6, size=size, count=count))
    engine = Engine(loaded, Settings(1, 1e6, sense_all=True), Fleet(), lambda line: None)
    about = {"seed": "1", "interval": "0.1"}
    path = folder / "cost.mcap"
    log = open_log(path, loaded, ["all"] if sensors else [], about)
    log.writer.stop()  # what it would do is timed here
    random = np.random.default_rng(1)
    engine.enter_first()
    number = 1000 if count == 4 else 20
    ticks: list[float] = []
    hooks: list[float] = []
    thread, written = 0.0, 0
    for part in range(1 + repeats):  # in the first one kernels are compiled, and robots enter
        ticks, hooks = (ticks, hooks) if part > 1 else ([], [])
        for tick in range(number):
            if tick % 20 == 0:
                turns = random.standard_normal(count) * 0.5
                twists = np.stack([np.full(count, 0.4), 0 * turns, turns], axis=1)
                engine.scenery.stage.command(np.arange(count), twists)
            began = perf_counter()
            engine.tick()
            ended = perf_counter()
            log.each_tick(engine)
            ticks.append(ended - began)
            hooks.append(perf_counter() - ended)
        before = log.writer.file.at
        began = process_time()
        log.writer.drain()
        if part:
            thread += process_time() - began
            written += log.writer.file.at - before
    log.finish(None, None)
    thread, bytes_ = thread / (repeats * number), written / (repeats * number)
    engine.crew.dismiss()
    engine.server.close()
    tick_time = statistics.median(ticks)
    hook = statistics.median(hooks)
    return (
        f"{hook / tick_time:.1%} in the tick ({1e6 * hook:.0f} us of {1e6 * tick_time:.0f}), "
        f"{thread / tick_time:.1%} on the thread ({1e6 * thread:.1f} us), "
        f"{bytes_:.0f} bytes a tick"
    )


def log_reading(folder: Path) -> str:
    """How long a log of 1000 robots with all that was sensed takes to open, and to look into."""
    import troupe  # noqa: PLC0415 - after the path is set

    path = folder / "read.mcap"
    with troupe.Simulation(
        world(folder, "null", 1e6), log=path, log_sensors=["all"], controllers=False
    ) as simulation:
        simulation.step(60)
    began = perf_counter()
    log = troupe.Log(path)
    opened = perf_counter() - began
    looks: dict[str, Callable[[Any], Any]] = {
        "poses": lambda part: part.poses,
        "a scan": lambda part: part.scans("rover5"),
    }
    moments = np.random.default_rng(1).uniform(0.0, log.times[-1], 30).tolist()
    seeks: dict[str, list[float]] = {what: [] for what in looks}
    for moment in moments:
        part = log[moment : moment + 0.1]
        for what, look in looks.items():
            began = perf_counter()
            look(part)
            seeks[what].append(perf_counter() - began)
    told = ", ".join(
        f"{what} of a moment {1e3 * statistics.median(times):.0f} ms (worst {1e3 * max(times):.0f})"
        for what, times in seeks.items()
    )
    return f"opened in {1e3 * opened:.0f} ms; {told}; {path.stat().st_size / 2**20:.0f} MiB"
