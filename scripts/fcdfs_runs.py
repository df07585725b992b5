"""The runs on the grid behind docs/results/fcdfs.md: a sweep's table, and what they gave."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pages import keep
from sweeps import rows

from gridworld import studies

DISPERSE = "troupe.grid:disperse"
DOORS = "gridworld.studies:doors"
SMALL = "gridworld.studies:small_regions"
COLUMNS = (
    "world", "seed", "region", "door", "doors", "rule", "q", "conflict", "force", "size",
)  # fmt: skip

FAILURES = (0.0, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5)
MISSED = (("fcdfs", "stop"), ("fcdfs", "stay"), ("light", "stop"))
COMBS = ("comb", "comb 2", "comb 6", "comb 11", "comb 16", "comb 20")
RINGS = {"ring 8 1": "0,4", "ring 12 1": "5,0", "ring 12 2": "0,5"}
"""The rings with their doors."""
CORRIDORS = (100, 1000, 4000)
ASLEEP = (0.1, 0.25, 0.5, 0.75)
"""The probabilities with which robots miss steps in corridors."""
WITH_CHANCE = ("dflf", "bflf", "symmetric")
TABLE_RULES = ("dflf", "bflf", "fcdfs", "fcdfs5", "symmetric", "left_hand")

Asked = dict[str, Any]


def run(region: str, rule: str, seeds: str, **more: Any) -> Asked:
    """Runs of a rule in a region."""
    asked = {"world": DISPERSE, "seed": seeds, "region": region, "rule": rule, "q": 0.0}
    door = {"30x30": "13,13", **RINGS}.get(region)
    return {**asked, "conflict": "stop", **({"door": door} if door else {}), **more}


def table_1(runs: int) -> Iterator[Asked]:
    for name in studies.TABLE_1:
        for rule in TABLE_RULES:
            yield run(name, rule, f"0:{runs if rule in WITH_CHANCE else 1}")


def combs() -> Iterator[Asked]:
    for name in COMBS:
        for rule in ("fcdfs", "dflf", "bflf"):
            yield run(name, rule, "1", force=True)


def rings() -> Iterator[Asked]:
    for name in RINGS:
        for conflict in ("stop", "stay"):
            yield run(name, "fcdfs", "0", conflict=conflict, force=True)


def missed_steps(regions: int) -> Iterator[Asked]:
    for rule, conflict in MISSED:
        for q in FAILURES:
            yield run("any", rule, f"0:{regions}", conflict=conflict, q=q)


def later_paper(runs: int) -> Iterator[Asked]:
    for name, lines in studies.TABLE_2.items():
        for rule, q in lines:
            yield run(name, rule, f"0:{1 if rule == 'fcdfs' else runs}", q=q)
    for q in ASLEEP:
        for length in CORRIDORS:
            yield run(f"{length}x1", "light", "0:3", q=q, door="0,0")


def several_doors(regions: int) -> Iterator[Asked]:
    for count in (1, 2, 3, 4):
        for conflict in ("stop", "stay"):
            yield run("any", "fcdfs", f"0:{regions}", conflict=conflict, doors=count)


def everything(runs: int, regions: int, cells: int) -> Iterator[Asked]:
    """All that the page tells of."""
    yield from table_1(runs)
    yield from ({"world": DOORS, "seed": "0", "region": name} for name in studies.TABLE_1)
    yield from combs()
    yield from rings()
    yield from missed_steps(regions)
    yield from later_paper(runs)
    yield from several_doors(regions)
    yield from ({"world": SMALL, "seed": "0", "size": size} for size in range(1, cells + 1))


def write_asked(path: Path, asked: Iterator[Asked]) -> None:
    """The table of a sweep."""
    lines = [[one.get(name, "") for name in COLUMNS] for one in asked]
    keep(path, COLUMNS, [["true" if cell is True else cell for cell in line] for line in lines])


class Found:
    """What a sweep has found: the runs of each combination, in the order of their seeds."""

    def __init__(self, folder: Path) -> None:
        self.runs: dict[str, list[Mapping[str, Any]]] = {}
        for row in rows(folder):
            self.runs.setdefault(key_of(row), []).append(row)

    def of(self, asked: Asked) -> Sequence[Mapping[str, Any]]:
        """The rows of what was asked for; raises KeyError for what was not run."""
        first, _, end = str(asked["seed"]).partition(":")
        seeds = range(int(first), int(end) if end else int(first) + 1)
        return [row for row in self.runs[key_of(asked)] if row["seed"] in seeds]

    def one(self, asked: Asked) -> Mapping[str, Any]:
        """The row of a single run."""
        (row,) = self.of(asked)
        return row


def key_of(row: Mapping[str, Any]) -> str:
    """A combination as one text, whether it is asked for or a table's row."""
    found = {name: row.get(name) for name in COLUMNS if name != "seed"}
    if found["q"] is not None:
        found["q"] = float(found["q"])
    return json.dumps(found)
