"""A sweep's table: one row a run, and nothing in it that another machine would have otherwise.

What depends on the machine and the day, wall-clock times above all, is a table of its own.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from troupe.sweep.lines import Line
from troupe.sweep.plan import Plan

MOST_ROBOTS = 32
"""Robots of a run up to which each has columns of its own for what it reported."""

OWN = (
    "world", "seed", "hash", "outcome", "reason",
    "sim_time", "ticks", "digest", "robots", "distance", "contacts", "stalls",
)  # fmt: skip
"""Columns of every table, or of every run of a world."""

SET = "set."
"""What the column of a parameter begins with that is called like one of them."""

FOUND = "found."
"""What a column of a function's begins with if the table has one of its name already."""

JUDGED = "judged."
"""What the columns of judges begin with."""

Row = dict[str, Any]


def rows_of(
    plans: Sequence[Plan], found: Mapping[str, Line]
) -> tuple[list[Row], list[Row], list[str]]:
    """The table of results and that of timings, both in the order of worlds, settings and seeds.

    A run that several plans ask for is one row; one that has not been run has none. Besides, the
    names of the columns that judges and functions gave.
    """
    parameters = list(dict.fromkeys(k for plan in plans for p in plan.points for k in p.settings))
    added: dict[str, None] = {}
    results: dict[str, Row] = {}
    timings: dict[str, Row] = {}
    for plan in plans:
        for run in plan.runs():
            line = found.get(run.name)
            if line is None or run.name in results:
                continue
            record = line.record
            row = {"world": run.point.world, "seed": run.seed}
            row |= {column_of(key): run.point.settings.get(key) for key in parameters}
            row |= {"hash": run.point.hash, **flat(record)}
            given = {
                f"{FOUND}{key}" if key in row else key: value
                for key, value in record.get("columns", {}).items()
            }
            added |= dict.fromkeys(key for key in row if key.startswith(JUDGED))
            added |= dict.fromkeys(given)
            row |= given
            results[run.name] = row
            timings[run.name] = {
                "hash": run.point.hash,
                "seed": run.seed,
                "seconds": record.get("seconds"),
                "wall_time": record.get("wall_time"),
                "speed": record.get("speed"),
                "tries": record["tries"],
                **record["machine"],
            }
    told = [column_of(key) for key in parameters]
    order = sorted(results, key=lambda name: place_of(results[name], told))
    return [results[name] for name in order], [timings[name] for name in order], list(added)


def column_of(parameter: str) -> str:
    """The name of a parameter's column."""
    return f"{SET}{parameter}" if parameter in OWN else parameter


def place_of(row: Row, parameters: Sequence[str]) -> tuple[Any, ...]:
    """Where a row stands by its parameters' columns: numbers are before texts, in their order."""
    values = [row[key] for key in parameters]
    return (row["world"], *map(in_order, values), row["seed"], row["hash"])


def in_order(value: Any) -> tuple[int, float, str]:
    """Something that values of any kinds are compared by."""
    if value is None:
        return (0, 0.0, "")
    if isinstance(value, int | float):
        return (1, float(value), "")
    return (2, 0.0, value if isinstance(value, str) else json.dumps(value))


def flat(record: Mapping[str, Any]) -> Row:
    """The columns of one record; of a run without a result only its outcome and the reason."""
    row: Row = {"outcome": record["outcome"], "reason": record.get("reason")}
    if "robots" not in record:
        return row
    robots = record["robots"]
    row |= {key: record[key] for key in ("sim_time", "ticks", "digest")}
    row["robots"] = len(robots)
    for key in ("distance", "contacts", "stalls"):
        row[key] = sum(one[key] for one in robots)
    row |= {f"{JUDGED}{key}": value for key, value in record.get("judged", {}).items()}
    row |= {f"floor.{key}": value for key, value in record["floor"].items()}
    row |= {f"doors.{door['name']}.emitted": door["emitted"] for door in record["doors"]}
    reported: dict[str, dict[str, Any]] = {}
    for one in robots:
        for key, value in leaves("properties", one["properties"]):
            reported.setdefault(key, {})[one["name"]] = value
    for key, values in sorted(reported.items()):
        numbers = [v for v in values.values() if isinstance(v, int | float)]
        if numbers:
            row[f"{key}.min"], row[f"{key}.max"] = min(numbers), max(numbers)
            row[f"{key}.mean"] = sum(numbers) / len(numbers)
        if len(robots) <= MOST_ROBOTS:
            row |= {f"{key}.{name}": value for name, value in values.items()}
    return row


def leaves(key: str, value: Any) -> list[tuple[str, Any]]:
    """The values within mappings, each under the keys that lead to it; a list is one value."""
    if isinstance(value, Mapping):
        return [leaf for name, below in value.items() for leaf in leaves(f"{key}.{name}", below)]
    return [(key, value)]


def columns(rows: Sequence[Row]) -> list[str]:
    """The names of all columns: those that all rows begin with first, then by their names."""
    first = list(rows[0]) if rows else []
    names = dict.fromkeys(key for row in rows for key in row)
    fixed = first[: first.index("reason") + 1] if "reason" in first else first
    rest = [name for name in OWN if name in names and name not in fixed]
    return [*fixed, *rest, *sorted(set(names) - {*fixed, *rest})]
