"""Kill parts of a sweep at random moments, again and again, and see that nothing comes of it.

    python scripts/sweep_kills.py [--kills N] [--runs N] [--seed N]

The same sweep is made twice: once undisturbed, and once with SIGKILL sent to the sweep itself, a
worker, a fork server or a controller, whichever chance has it, and started again where it was the
sweep. No run that was completed may be run again, and in the end both tables must be the same to
the bit.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import psutil

from troupe.sweep.lines import read_line

ROOT = Path(__file__).resolve().parent.parent
MARK = "TROUPE_SWEEP_KILLS"

WORLD = """\
size: [8, 8]
duration: 2
until: duration
models:
  rover: {body: {shape: circle, radius: 0.3}, sensors: [{type: laser, samples: 36}]}
robots: [{model: rover, count: 2, placement: random, controller: wander}]
"""


@dataclass
class Trial:
    """A sweep into a folder, and what has been killed of it."""

    world: Path
    out: Path
    runs: int
    mark: str

    def command(self) -> list[str]:
        return [
            sys.executable, "-m", "troupe", "sweep", str(self.world), "--out", str(self.out),
            "--seeds", f"0:{self.runs // 2}", "--set", "models.rover.drive.max_speed=0.2,0.5",
            "--jobs", "2", "--quiet", "--retry-failed",  # three kills may hit one run
        ]  # fmt: skip

    def start(self) -> subprocess.Popen[bytes]:
        environment = {**os.environ, "PYTHONPATH": str(ROOT), MARK: self.mark}
        return subprocess.Popen(
            self.command(), env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
        )

    def table(self) -> bytes:
        return (self.out / "results.csv").read_bytes()

    def done(self) -> int:
        return len(list((self.out / "runs").glob("*/result.json")))

    def completed(self) -> dict[str, tuple[int, int]]:
        """The files of runs that are completed, and when and where each was written."""
        found = {}
        for path in (self.out / "runs").glob("*/result.json"):
            line = read_line(path.read_bytes())
            if line is not None and line.outcome == "completed":
                found[line.name] = (path.stat().st_ino, path.stat().st_mtime_ns)
        return found


def processes(mark: str) -> list[psutil.Process]:
    """The living processes of a trial."""
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            alive = process.status() != psutil.STATUS_ZOMBIE
            if alive and process.environ().get(MARK) == mark:
                found.append(process)
    return found


def kill_one(sweep: subprocess.Popen[bytes], mark: str, chance: random.Random) -> str:
    """Kill the sweep, or something that it has started; what it was."""
    others = [one for one in processes(mark) if one.pid != sweep.pid]
    chosen = psutil.Process(sweep.pid) if chance.random() < 0.4 or not others else None
    victim = chosen or chance.choice(others)
    with contextlib.suppress(psutil.Error):
        name = "sweep" if chosen else next((w for w in victim.cmdline() if w.endswith(".py")), "?")
        victim.kill()
        return Path(name).name
    return "nothing"


def disturbed(trial: Trial, kills: int, seed: int) -> list[str]:
    """Make the sweep with so many kills, as long as it lasts; what was killed."""
    chance = random.Random(seed)
    killed: list[str] = []
    while True:
        there, completed, before = trial.done(), trial.completed(), len(killed)
        sweep = trial.start()
        at_work = chance.random() < 0.8  # else it may be killed while it gets ready, too
        while at_work and sweep.poll() is None and trial.done() == there:
            time.sleep(0.02)
        while sweep.poll() is None and len(killed) < kills:
            time.sleep(chance.uniform(0.0, 3.0))
            if sweep.poll() is None:
                killed.append(kill_one(sweep, trial.mark, chance))
                print(f"{len(killed)}: {killed[-1]} ({trial.done()} runs there)", flush=True)
                if killed[-1] == "sweep":
                    break
        sweep.wait()
        assert completed.items() <= trial.completed().items(), "what was there was run again"
        # Kills that all hit one run make it a row that has failed: started again it is retried.
        undisturbed = len(killed) == before
        if sweep.returncode == 0 and (undisturbed or len(trial.completed()) == trial.done()):
            return killed
        if sweep.returncode > 0:
            assert sweep.stderr is not None
            raise SystemExit(f"the sweep failed: {sweep.stderr.read().decode()}")


def compare(folder: Path, kills: int, runs: int, seed: int) -> list[str]:
    """Make both sweeps; what was killed. Raises AssertionError where a table differs."""
    world = folder / "world.yaml"
    world.write_text(WORLD)
    mark = f"{os.getpid()}-{seed}"
    quiet = Trial(world, folder / "quiet", runs, mark)
    assert quiet.start().wait() == 0, "the undisturbed sweep has failed"
    rough = Trial(world, folder / "rough", runs, mark)
    killed = disturbed(rough, kills, seed)
    assert rough.table() == quiet.table(), "the tables differ"
    assert rough.done() == runs, "a run is missing, or there is one too many"
    return killed


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    options.add_argument("--kills", type=int, default=100)
    options.add_argument("--runs", type=int, default=400)
    options.add_argument("--seed", type=int, default=1)
    given = options.parse_args()
    with tempfile.TemporaryDirectory() as name:
        killed = compare(Path(name), given.kills, given.runs, given.seed)
    kinds = sorted((killed.count(kind), kind) for kind in set(killed))
    print(f"{len(killed)} kills: {kinds}; the tables are the same to the bit")


if __name__ == "__main__":
    main()
