"""Kills runs of four processes that keep logs of all that is sensed, at random moments, and counts
what is missing; 50 trials by default.

    .venv/bin/python scripts/kill_logs.py [TRIALS]

A trial fails where a tick or a scan is missing that was given to the log more than a second before
the kill, or where strict readers (`mcap`, `rosbags`) do not read the recovered file to its end.
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
    say=lambda line: None, log=sys.argv[2], log_sensors=["all"], each_tick=tell)
"""


def trial(folder: Path, number: int) -> tuple[int, int, int, float]:
    """Kill one run: ticks told, ticks older than a second, ticks kept, seconds of ticks lost."""
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
            told.append(read(line))
            if told[-1][1] - told[0][1] > least:
                process.send_signal(signal.SIGKILL)
                break
        killed = monotonic()
        told += [read(line) for line in process.stdout if line.endswith("\n")]
    saved = recover(log, whole)
    found = Log(whole)
    kept = len(found.ticks)
    scans = min(len(found.scans(robot).times) for robot in found.robots)
    if scans != kept or strictly_read(whole) != saved.messages:
        kept = 0
    old = sum(at < killed - 1.0 for _, at in told)
    lost = killed - told[kept][1] if kept < len(told) else 0.0
    log.unlink()
    whole.unlink()
    return len(told), old, kept, lost


def read(line: str) -> tuple[int, float]:
    """A tick, and when the log had been given it."""
    tick, at = line.split()
    return int(tick), float(at)


def strictly_read(path: Path) -> int:
    """The messages that two readers find which know nothing of us; 0 where they do not agree."""
    from mcap.reader import make_reader  # noqa: PLC0415
    from rosbags.highlevel import AnyReader  # noqa: PLC0415

    with path.open("rb") as file:
        messages = sum(1 for _ in make_reader(file, validate_crcs=True).iter_messages())
    with AnyReader([path]) as reader:
        return messages if messages == sum(1 for _ in reader.messages()) else 0


def main() -> int:
    trials = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    failed, most = 0, 0.0
    with tempfile.TemporaryDirectory() as name:
        for number in range(trials):
            told, old, kept, lost = trial(Path(name), number)
            failed += kept < old
            most = max(most, lost)
            print(
                f"{number}: {told} ticks, {old} older than a second, {kept} kept; "
                f"the last {lost:.2f} s are lost",
                flush=True,
            )
    print(f"{failed} of {trials} lost what was older than a second; at the most {most:.2f} s")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
