"""Makes the tables of one or several folders: CSV always, Parquet where pyarrow is."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from troupe.sweep.folder import load_plans, records, write_aside
from troupe.sweep.lines import Line
from troupe.sweep.plan import Plan
from troupe.sweep.results import Each, added
from troupe.sweep.rows import Row, columns, rows_of
from troupe.usage import UsageError

if TYPE_CHECKING:
    import pandas
    import polars

LARGE = 1 << 63


@dataclass(frozen=True)
class Tables:
    """What is in the folders.

    `added` columns are those of judges, functions that were run, and functions of a result;
    `missing` runs were asked for and have no record.
    """

    plans: list[Plan]
    found: dict[str, Line]
    results: list[Row]
    timings: list[Row]
    added: list[str]
    missing: int


def gather(folders: Sequence[Path], each: Sequence[Each] = ()) -> Tables:
    """Read the folders, and have the functions add their columns.

    The functions are those that the sweeps were asked for besides `each`. Raises UsageError.
    """
    plans = {plan.name: plan for folder in folders for plan in load_plans(folder)}
    if not plans:
        raise UsageError(f"{', '.join(map(str, folders))}: holds no sweep")
    ordered = [plans[name] for name in sorted(plans)]
    found = records(folders)
    results, timings, names = rows_of(ordered, found)
    asked = [Each(**one) for plan in ordered for one in plan.about.get("each", ())]
    functions = [(one, one.load()) for one in dict.fromkeys([*asked, *each])]
    if functions:
        for row in results:
            record = found[f"{row['hash']}-s{row['seed']}"].record
            for one, function in functions:
                new = added(one, function, record)
                taken = sorted(set(new) & set(row))
                if taken:
                    raise UsageError(f"{one}: there is a column {taken[0]} already")
                row.update(new)
                names += [name for name in new if name not in names]
    asked_for = {run.name for plan in ordered for run in plan.runs()}
    missing = len(asked_for - found.keys())
    return Tables(ordered, found, results, timings, names, missing)


def write_tables(tables: Tables, folder: Path) -> list[Path]:
    """Write results and timings into a folder, each aside and renamed; the files."""
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    for name, rows in (("results", tables.results), ("timings", tables.timings)):
        path = folder / f"{name}.csv"
        write_aside(path, csv_of(rows))
        made.append(path)
    parquet = parquet_of(tables.results)
    if parquet is not None:
        write_aside(folder / "results.parquet", parquet)
        made.append(folder / "results.parquet")
    return made


def csv_of(rows: Sequence[Row]) -> bytes:
    """The rows as CSV (RFC 4180): what is missing is empty, lists and mappings are JSON."""
    names = columns(rows)
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(names)
    for row in rows:
        out.writerow([cell(row.get(name)) for name in names])
    return text.getvalue().encode()


def cell(value: Any) -> Any:
    """A value as it stands in CSV."""
    if isinstance(value, bool | list | tuple | dict):
        return json.dumps(value)
    return value


def uniform(values: Sequence[Any]) -> list[Any]:
    """A column's values, of one kind: truth values, whole numbers, numbers, or else texts.

    Whole numbers of more than 64 bits are numbers.
    """
    kinds = {type(value) for value in values if value is not None}
    if any(type(value) is int and not -LARGE <= value < LARGE for value in values):
        kinds.add(float)
    if len(kinds) < 2 and kinds <= {bool, int, str, float}:
        return list(values)
    if kinds == {int, float}:
        return [None if value is None else float(value) for value in values]
    return [v if v is None or isinstance(v, str) else json.dumps(v) for v in values]


def parquet_of(rows: Sequence[Row]) -> bytes | None:
    """The rows as Parquet, None without pyarrow."""
    try:
        import pyarrow as pa  # noqa: PLC0415 - an extra
        import pyarrow.parquet as pq  # noqa: PLC0415
    except ImportError:
        return None
    table = pa.table(
        {name: pa.array(uniform([r.get(name) for r in rows])) for name in columns(rows)}
    )
    out = io.BytesIO()
    pq.write_table(table, out)
    return out.getvalue()


def read_sweep(
    folder: str | Path,
    *more: str | Path,
    timings: bool = False,
    each: Sequence[str] = (),
    frame: Literal["pandas", "polars"] | None = None,
) -> pandas.DataFrame | polars.DataFrame:
    """The table of a sweep's folder, or of several, one row a run.

    Args:
        folder, more: folders that `troupe sweep` has made, also of a sweep that is not complete.
        timings: the table of what depends on the machine instead: wall-clock times, tries, host.
        each: functions of a result that add columns, `module:function` or `FILE.py:function`.
        frame: which library's DataFrame; unless given pandas', or polars' where there is no pandas.

    Raises:
        ImportError: there is neither pandas nor polars.
        ValueError: there is no sweep in a folder, or a function does not work.
    """
    found = gather([Path(one) for one in (folder, *more)], [Each(n, str(Path.cwd())) for n in each])
    rows = found.timings if timings else found.results
    data = {name: uniform([row.get(name) for row in rows]) for name in columns(rows)}
    if frame in (None, "pandas"):
        try:
            import pandas as pd  # noqa: PLC0415 - an extra
        except ImportError:
            if frame == "pandas":
                raise ImportError(MISSING) from None
        else:
            return pd.DataFrame(data)
    try:
        import polars as pl  # noqa: PLC0415 - an extra
    except ImportError:
        raise ImportError(MISSING) from None
    return pl.DataFrame(data)


MISSING = "read_sweep needs the extra `tables`: pip install 'troupe-sim[tables]' (or polars)"
