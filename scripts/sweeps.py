"""Has `troupe sweep` run something for the papers' results, and reads what came out."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from sim.result import Result
from troupe.sweep.collect import gather
from troupe.sweep.results import result_of

ROOT = Path(__file__).resolve().parent.parent
JUDGE = "troupe.testing.paint.judge:measures"


def sweep(folder: Path, *words: str | Path) -> None:
    """Run what a sweep's folder lacks; who interrupts it goes on with the same call.

    Raises SystemExit with the command's exit code where it is not 0.
    """
    command = [sys.executable, "-m", "troupe", "sweep", *map(str, words), "--out", str(folder)]
    code = subprocess.run(command, cwd=ROOT, check=False).returncode
    if code:
        sys.exit(code)


def runs(folder: Path, each: Sequence[Any] = ()) -> Iterator[tuple[dict[str, Any], Result | None]]:
    """A sweep's rows in their order, each with the result, None where the run has none.

    A row has the wall-clock seconds too, as `wall_time`.
    """
    tables = gather([folder], each)
    for row, timing in zip(tables.results, tables.timings, strict=True):
        record = tables.found[f"{row['hash']}-s{row['seed']}"].record
        result = result_of(record) if "robots" in record else None
        yield {**row, "wall_time": timing["wall_time"]}, result
