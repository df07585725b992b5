"""Kills runs that keep logs, at random moments, and counts what is missing; 50 trials by default.

    .venv/bin/python scripts/kill_logs.py [TRIALS]

A trial fails where a tick is missing that was given to the log more than a second before the kill.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from time import monotonic

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
RUN = """\
import sys, time
from troupe.running import run_file

def tell(engine):
    print(engine.ticks, time.monotonic(), flush=True)

run_file(sys.argv[1], seed=None, duration=1e6, settings=[], realtime=None, listen=None,
    patience=60.0, video=None, video_fps=None, video_speed=None, video_size=None,
    say=lambda line: None, log=sys.argv[2], each_tick=tell)
"""


def trial(folder: Path, number: int) -> tuple[int, int, int]:
    """Kill one run: ticks told, ticks older than a second, ticks in the recovered log."""
    from sim.log.recover import recover  # noqa: PLC0415 - after the path is set
    from troupe.log import Log  # noqa: PLC0415

    log, whole = folder / f"{number}.mcap", folder / f"{number}-whole.mcap"
    command = [sys.executable, "-c", RUN, str(ROOT / "worlds" / "wander.yaml"), str(log)]
    least = random.Random(number).uniform(1.2, 4.0)
    told: list[tuple[int, float]] = []
    with subprocess.Popen(
        command, env={**os.environ, "PYTHONPATH": str(ROOT)}, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            tick, at = line.split()
            told.append((int(tick), float(at)))
            if told[-1][1] - told[0][1] > least:
                process.send_signal(signal.SIGKILL)
                break
    killed = monotonic()
    recover(log, whole)
    ticks = Log(whole).ticks
    old = sum(at < killed - 1.0 for _, at in told)
    return len(told), old, len(ticks)


def main() -> int:
    trials = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        for number in range(trials):
            told, old, kept = trial(Path(name), number)
            failed += kept < old
            print(f"{number}: {told} ticks, {old} older than a second, {kept} kept", flush=True)
    print(f"{failed} of {trials} lost what was older than a second")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
