"""The measurements behind docs/performance.md; run by scripts/bench."""

from __future__ import annotations

import argparse
import csv
import json
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np
from onlookers import look_on

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

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
MARK = "<!-- measured -->"
NO_BYTECODE = "PYTHONDONTWRITEBYTECODE"
"""Set on some machines: every start then compiles every module, which no user's start does."""


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


def team(folder: Path, count: int, duration: float, repeats: int) -> str:
    """Robots at 0.01 per m2, or four in the small hall, each with a process that wanders."""
    path = world(folder, "reader", duration, size=hall(count), count=count)
    return f"{median_speed(repeats, str(path)):.3g} x real time"


def watched(folder: Path, repeats: int, count: int = 4, viewers: int = 1) -> str:
    """The price of pages that watch: pairs of runs, without them and with them."""
    duration = 600 if count == 4 else 6000 / count
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


def raw_rounds(folder: Path, repeats: int) -> tuple[str, str]:
    """In which language four clients over TCP are written, and the rounds of each per second."""
    path = world(folder, "raw", 300, size=(16, 21), count=4)
    language = "C" if len(raw_client(folder)) == 1 else "Python"
    return language, f"{median_speed(repeats, str(path)) / 0.1:.0f} per second each"


def log_cost(folder: Path, count: int, sensors: bool, repeats: int) -> str:
    """What a log costs a run without controllers, as the processor time of its two parts.

    The hook in the tick delays the run; the thread runs beside it where a core is free.
    """
    from sim.build import load  # noqa: PLC0415
    from sim.engine import Engine, Settings  # noqa: PLC0415 - after the path is set
    from sim.fleet.fleet import Fleet  # noqa: PLC0415
    from sim.log.moment import TickState  # noqa: PLC0415
    from sim.log.recorder import open_log, size_of  # noqa: PLC0415

    size = (16, 21) if count == 4 else (316, 316)
    loaded = load(world(folder, "null", 1e6, size=size, count=count))
    engine = Engine(loaded, Settings(1, 1e6, sense_all=True), Fleet(), lambda line: None)
    about = {"seed": "1", "interval": "0.1"}
    path = folder / "cost.mcap"
    log = open_log(path, loaded, ["all"] if sensors else [], about)
    log.writer.stop()  # what it would do is timed here
    kept: list[Any] = []
    log.writer.put = lambda item, size: kept.append(item)  # type: ignore[method-assign]
    random = np.random.default_rng(1)
    ticks, hooks = [], []
    engine.enter_first()
    number = 400 * repeats if count == 4 else 10 * repeats
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
    states: list[Any] = [one for one in kept if isinstance(one, TickState)]
    waiting = sum(map(size_of, states))
    log.writer._write(kept[:], waiting)  # entries and bodies once, and what is compiled
    states = [one._replace(events=()) for one in states]
    before = log.writer.file.at
    began = process_time()
    log.writer._write(states, waiting)
    thread = (process_time() - began) / number
    written = (log.writer.file.at - before) / number
    engine.crew.dismiss()
    engine.server.close()
    tick_time = statistics.median(ticks)
    hook = statistics.median(hooks)
    return (
        f"{hook / tick_time:.1%} in the tick ({1e6 * hook:.0f} us of {1e6 * tick_time:.0f}), "
        f"{thread / tick_time:.1%} on the thread ({1e6 * thread:.0f} us), "
        f"{written:.0f} bytes a tick"
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


def first_tick(repeats: int) -> str:
    run_command("worlds/wander.yaml", "--duration", "0.1")  # warms the caches
    times = [run_command("worlds/wander.yaml", "--duration", "0.1")[1] for _ in range(repeats)]
    return f"{statistics.median(times):.2f} s, the whole process with one tick"


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
            for _ in range(ticks):
                sim.command(forward=0.4, turn=turn)
                sim.step()
                ranges = sim.readings("laser").ranges
                sim.readings("blobfinder").counts  # noqa: B018 - it is made
                if blind:
                    turn = random.standard_normal(count) * 0.5
                else:
                    turn = np.where(ranges[:, 60:120].min(axis=1) > 1.5, 0.0, 0.8)
            speeds.append(0.1 * ticks / (process_time() - began))
    return (
        f"{float(f'{statistics.median(speeds[1:]):.3g}'):g} x real time",
        f"{ray(path):.1f} ns",
    )


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


PEERS = (("navground", "C++, no forces, no blobfinder"), ("irsim", "Python, no blobfinder"))


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


def loading(folder: Path, count: int) -> str:
    """What a large crowd takes: seconds of the processor, memory, and the cost of a tick."""
    path = world(folder, "null", 10, size=hall(count), count=count)
    words = [sys.executable, "-c", LOADING, str(ROOT), str(path)]
    return subprocess.run(words, capture_output=True, text=True, check=True).stdout.strip()


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


def machine() -> str:
    """What this was measured on."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [li for li in info.read_text().splitlines() if li.startswith("model name")]
        model = names[0].partition(": ")[2] if names else model
    return (
        f"{os.cpu_count()} cores of {model}, {platform.system()}, "
        f"Python {platform.python_version()}, numpy {np.__version__}"
    )


def main() -> None:
    """Measure, print the table, and write it into the documentation if asked to."""
    options = argparse.ArgumentParser(prog="scripts/bench", description=__doc__)
    options.add_argument("--write", action="store_true", help="into docs/performance.md")
    options.add_argument("--quick", action="store_true", help="one run of each")
    options.add_argument(
        "--peers", default=sys.executable, metavar="PYTHON",
        help="an interpreter that has other simulators (ir-sim, navground), for rows beside ours",
    )  # fmt: skip
    args = options.parse_args()
    repeats = 1 if args.quick else 5
    sweep = 20 if args.quick else 1000
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows = [
            ("16 x 21 m, 4 robots with laser (180 rays, 20 m) and blobfinder (160 columns) at "
             "10 Hz, 4 controller processes", "400 x real time", team(folder, 4, 300, repeats)),
            ("100 robots at 0.01 per m2, 100 controller processes", "25 x real time",
             team(folder, 100, 30, repeats)),
            ("1000 robots, 1000 controller processes", "1 x real time",
             team(folder, 1000, 10, max(1, repeats // 2))),
        ]  # fmt: skip
        ray = ""
        for count, ticks, target in ((4, 3000, "2500"), (100, 200, "200"), (1000, 30, "30"),
                                     (10_000, 10, "3")):  # fmt: skip
            speed, found = in_process(folder, count, ticks, repeats)
            ray = found if count == 1000 else ray
            what = f"{count} robots in process that look where they go, one core"
            rows.append((what, f"{target} x real time", speed))
            if count <= 1000:
                pressed, _ = in_process(folder, count, ticks, repeats, blind=True)
                rows.append(("the same, blind: many press against walls", "", pressed))
                rows += peers(args.peers, count, max(1, ticks // 10))
        language, raw = raw_rounds(folder, repeats)
        rows += [
            ("100,000 robots in process", "20 s, 2 GB", loading(folder, 100_000)),
            ("one ray, 1000 robots, one core", "5 ns", ray),
            ("rounds of one robot over a socket pair (laser and blobs read, a command given)",
             "", rounds(folder, "reader", repeats)),
            ("the same over TCP", "3000 per second", rounds(folder, "outsider", repeats)),
            (f"four clients in {language} over TCP, each with its robot of 16 x 21 m",
             "3000 rounds per second each", raw),
            ("`troupe run` to its first tick, caches warm", "0.4 s", first_tick(repeats)),
            ("what a page that watches the four robots costs",
             "under 3 %", watched(folder, repeats)),
            ("what five such pages cost", "under 3 %", watched(folder, repeats, viewers=5)),
            ("what a page costs 100 robots", "under 3 %", watched(folder, repeats, 100)),
            (f"{sweep} random placements of Paint in a sweep with two jobs: the runs' own times "
             "over two, as a share of the sweep's", "90 %", placements(folder, sweep)),
            ("a log's share of a tick, 4 robots, sensed, no controllers", "5 % in all, 150 bytes",
             log_cost(folder, 4, False, repeats)),
            ("the same with --log-sensors all", "15 % in all, 2500 bytes",
             log_cost(folder, 4, True, repeats)),
            ("a log's share of a tick, 1000 robots, sensed, no controllers", "5 % in all",
             log_cost(folder, 1000, False, repeats)),
            ("the same with --log-sensors all", "15 % in all",
             log_cost(folder, 1000, True, repeats)),
            ("a log of 1000 robots with all that was sensed is read", "1 s, 50 ms",
             log_reading(folder)),
        ]  # fmt: skip
    table = "\n".join(
        [
            f"Measured on {machine()}{', one run of each' if args.quick else ''}.",
            "",
            "| what | target | measured |",
            "| --- | --- | --- |",
        ]
        + [f"| {what} | {target} | {found} |" for what, target, found in rows]
    )
    print(table)
    if args.write:
        page = ROOT / "docs" / "performance.md"
        before, _, rest = page.read_text().partition(MARK)
        _, _, after = rest.partition(MARK)
        page.write_text(f"{before}{MARK}\n{table}\n{MARK}{after}")


if __name__ == "__main__":
    main()
