"""Has `troupe sweep` run something for the papers' results, and reads what came out."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from sim.result import Result
from troupe.sweep.collect import Tables, gather
from troupe.sweep.results import result_of
from troupe.sweep.rows import Row

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


def tables_of(folder: Path, each: Sequence[Any] = ()) -> tuple[Tables, list[tuple[Row, Row]]]:
    """A folder's tables, and the rows of what was asked for last with their timings.

    A folder keeps the runs of older versions too.
    """
    newest = max((folder / "plans").glob("*.json"), key=lambda path: path.stat().st_mtime_ns)
    asked = {point["hash"] for point in json.loads(newest.read_bytes())["points"]}
    tables = gather([folder], each)
    both = zip(tables.results, tables.timings, strict=True)
    return tables, [(row, timing) for row, timing in both if row["hash"] in asked]


def rows(folder: Path) -> list[Row]:
    """A sweep's rows in their order, of what was asked for last."""
    return [row for row, _ in tables_of(folder)[1]]


def runs(folder: Path, each: Sequence[Any] = ()) -> Iterator[tuple[dict[str, Any], Result | None]]:
    """The same rows, each with the result, None where the run has none.

    A row has the wall-clock seconds too, as `wall_time`.
    """
    tables, found = tables_of(folder, each)
    for row, timing in found:
        record = tables.found[f"{row['hash']}-s{row['seed']}"].record
        result = result_of(record) if "robots" in record else None
        yield {**row, "wall_time": timing["wall_time"]}, result
