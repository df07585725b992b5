"""The measurements behind docs/performance.md; run by scripts/bench."""

from __future__ import annotations

import argparse
import os
import platform
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "scripts")]

from measures.inside import in_process, loading, peers  # noqa: E402
from measures.logs import log_cost, log_reading  # noqa: E402
from measures.runs import (  # noqa: E402
    first_tick,
    logged,
    logged_in_process,
    placements,
    raw_rounds,
    rounds,
    team,
    watched,
)

MARK = "<!-- measured -->"


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
            ("what a log delays 4 robots with 4 processes", "5 %", logged(folder, False, repeats)),
            ("the same with --log-sensors all", "15 %", logged(folder, True, repeats)),
            ("what a log delays 4 robots that are driven and read in process", "5 %",
             logged_in_process(folder, 4, False, repeats, 20_000)),
            ("the same with --log-sensors all", "15 %",
             logged_in_process(folder, 4, True, repeats, 20_000)),
            ("what a log delays 1000 robots that are driven and read in process", "5 %",
             logged_in_process(folder, 1000, False, repeats, 300)),
            ("the same with --log-sensors all", "15 %",
             logged_in_process(folder, 1000, True, repeats, 300)),
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
