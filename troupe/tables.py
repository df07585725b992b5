"""Logs as tables: poses, commands, scans and events, to Parquet, CSV and pandas."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from player.printable import printable
from troupe.log import Log
from troupe.sweep.folder import aside
from troupe.usage import UsageError, check_output

if TYPE_CHECKING:
    import pandas as pd

Columns = dict[str, Any]
PART = 60.0
"""Simulated seconds that are in memory at a time."""


class MissingExtra(UsageError):
    """A package is not installed that comes with an extra."""


def frame(log: Log, table: str) -> pd.DataFrame:
    """A table as a pandas frame; raises MissingExtra, and UsageError for another table's name."""
    pandas = needed("pandas")
    parts = [pandas.DataFrame(columns) for columns in TABLES[known(table)](log)]
    if not parts:
        return pandas.DataFrame()
    found: pd.DataFrame = pandas.concat(parts, ignore_index=True)
    return found


def export(log: Log, table: str, path: Path) -> int:
    """Write a table to a .parquet or .csv file; how many rows. Raises UsageError, OSError.

    A file that stands there stays as it is until all rows are there.
    """
    parts = TABLES[known(table)](log)
    target = check_output(path, tuple(WRITERS), "table", log.path)
    with aside(target) as place:
        return WRITERS[path.suffix.lower()](parts, place)


def known(table: str) -> str:
    if table not in TABLES:
        raise UsageError(f"there is no table {table!r}; there are {', '.join(TABLES)}")
    return table


def needed(name: str) -> Any:
    """A package of the extra `tables`; raises MissingExtra."""
    import importlib  # noqa: PLC0415

    try:
        return importlib.import_module(name)
    except ImportError:
        raise MissingExtra(
            f"{name} is not installed: it comes with Troupe's extra `tables` "
            "(pip install -e '.[tables]' in Troupe's folder); CSV needs nothing"
        ) from None


def to_parquet(parts: Iterator[Columns], path: Path) -> int:
    arrow, parquet = needed("pyarrow"), needed("pyarrow.parquet")
    writer, rows = None, 0
    try:
        for columns in parts:
            texts = {
                name: arrow.array(column, arrow.string())  # also where there are none yet
                for name, column in columns.items()
                if isinstance(column, list)
            }
            table = arrow.table({**columns, **texts})
            if writer is None:
                writer = parquet.ParquetWriter(path, table.schema, compression="zstd")
            writer.write_table(table)
            rows += table.num_rows
    finally:
        if writer is not None:
            writer.close()
    return rows


def to_csv(parts: Iterator[Columns], path: Path) -> int:
    """Numbers as Python writes them, so that they are read back exactly; texts without controls."""
    rows = 0
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        for number, columns in enumerate(parts):
            if not number:
                writer.writerow(columns)
            values = [plain(column) for column in columns.values()]
            writer.writerows(zip(*values, strict=True))
            rows += len(values[0]) if values else 0
    return rows


def plain(column: Any) -> list[Any]:
    """A column as numbers and texts; nothing for what is no number."""
    values = column.tolist() if isinstance(column, np.ndarray) else list(column)
    return [
        "" if isinstance(value, float) and math.isnan(value)
        else printable(value) if isinstance(value, str) else value
        for value in values
    ]  # fmt: skip


WRITERS: dict[str, Callable[[Iterator[Columns], Path], int]] = {
    ".parquet": to_parquet,
    ".csv": to_csv,
}
"""By the ending of a file's name."""


def windows(log: Log) -> Iterator[Log]:
    """The log in parts that are not too large; at least one."""
    times = log.times
    if not len(times):
        yield log
        return
    start, end = float(times[0]), float(times[-1])
    for number in range(math.floor((end - start) / PART) + 1):
        first = start + number * PART
        # times are multiples of the interval: half a one keeps rounding out of the borders
        border = 0.5 * log.interval
        yield log[first - border : first + PART - border]


def poses(log: Log) -> Iterator[Columns]:
    """A row for each tick and each robot that had entered."""
    names = np.array(log.robots, dtype=object)
    for part in windows(log):
        at, ticks, times = part.poses, part.ticks, part.times
        tick, robot = np.nonzero(~np.isnan(at[..., 0]))
        speed, stall, touched = part.velocities, part.stalls, part.contacts
        yield {
            "tick": ticks[tick],
            "time": times[tick],
            "robot": names[robot].tolist(),
            **{name: at[tick, robot, k] for k, name in enumerate(("x", "y", "yaw"))},
            **{
                name: speed[tick, robot, k].astype(float)
                for k, name in enumerate(("vx", "vy", "wz"))
            },
            "stall": stall[tick, robot],
            "contacts": touched[tick, robot],
        }


def commands(log: Log) -> Iterator[Columns]:
    """A row for each command that was carried out, where it changed."""
    names = np.array(log.robots, dtype=object)
    kinds = np.array(["twist", "steering", "pose", "heading"], dtype=object)
    rows = log.commands
    columns = {name: rows[name] for name in rows.dtype.names or ()}
    columns["robot"] = names[rows["robot"]].tolist() if len(rows) else []
    columns["mode"] = kinds[rows["mode"]].tolist() if len(rows) else []
    yield columns


def scans(log: Log) -> Iterator[Columns]:
    """A row for each ray of each scan. Raises UsageError where no scans were kept."""
    if not log.scanners:
        raise UsageError(
            f"{log.path}: there are no scans in the log: `--log-sensors laser` keeps them"
        )
    for part in windows(log):
        for robot, index in log.scanners:
            found = part.scans(robot, index)
            count, samples = found.ranges.shape
            yield {
                "time": np.repeat(found.times, samples),
                "robot": [robot] * (count * samples),
                "scanner": np.full(count * samples, index),
                "ray": np.tile(np.arange(samples), count),
                "bearing": np.tile(found.bearings, count),
                "range": found.ranges.reshape(-1),
            }


def events(log: Log) -> Iterator[Columns]:
    """A row for each thing that happened: entries, what was said, reported, printed, touches."""
    rows: list[tuple[float, str, str, str, str]] = []
    rows += [
        (one.time, "entry", one.name, "", one.model) for one in log.entries if log.spans(one.time)
    ]
    rows += [(one.time, "said", one.robot, "", one.text) for one in log.said]
    rows += [(one.time, "property", one.robot, one.key, repr(one.value)) for one in log.properties]
    rows += [
        (one.time, "controller", one.robot, one.state, one.error or "") for one in log.controllers
    ]
    rows += [(one.time, "line", one.who, "", one.text) for one in log.lines]
    rows += [
        (one.time, "contact", one.robot, "", f"{one.point[0]!r} {one.point[1]!r}")
        for one in log.touches
    ]
    rows.sort(key=lambda row: row[0])
    texts = ("kind", "robot", "key", "text")
    yield {
        "time": np.array([row[0] for row in rows], float),
        **{name: [row[k] for row in rows] for k, name in enumerate(texts, start=1)},
    }


TABLES: dict[str, Callable[[Log], Iterator[Columns]]] = {
    "poses": poses,
    "commands": commands,
    "scans": scans,
    "events": events,
}
"""What can be exported, by name."""
