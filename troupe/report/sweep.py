"""The report of a sweep: what is in it, and its page in HTML or Markdown."""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from player.printable import printable
from troupe.report import plots
from troupe.report.groups import (
    Group,
    Measure,
    factors,
    grouped,
    measures_of,
    pairings,
    short,
    shown,
)
from troupe.report.looks import command_of, looks, points_of
from troupe.sweep.collect import Tables
from troupe.sweep.folder import write_aside
from troupe.sweep.statistics import middle
from troupe.usage import UsageError

MOST_LEVELS = 40
"""Values of a parameter up to which it is plotted level by level."""

MOST_REASONS = 20


def contents(
    tables: Tables,
    *,
    title: str,
    measures: Sequence[str] = (),
    higher: Sequence[str] = (),
    pictures: bool = True,
) -> dict[str, Any]:
    """All that a report says, as its templates take it; raises UsageError."""
    rows = tables.results
    if not rows:
        raise UsageError("no run is there to be reported; run `troupe sweep` first")
    found = factors(rows)
    chosen = measures_of(rows, measures, higher, tables.added)
    groups = grouped(rows, found)
    seconds = {(row["hash"], row["seed"]): row["seconds"] or 0.0 for row in tables.timings}
    return {
        "title": printable(title),
        "runs": len(rows),
        "missing": tables.missing,
        "completed": sum(row["outcome"] == "completed" for row in rows),
        "measures": [measure_part(one, groups, found) for one in chosen],
        "failures": failures(tables),
        "looks": [
            {
                "title": look.title,
                "label": look.label,
                "seed": look.seed,
                "value": f"{look.value:.6g}",
                "command": look.command,
                "picture": look.picture,
                "why_not": printable(look.why_not),
            }
            for look in looks(groups, chosen[0], tables.plans, seconds, pictures=pictures)
        ],
        "measure": chosen[0],
        "versions": versions_of(tables),
        "machines": machines_of(tables),
        "hours": sum(seconds.values()) / 3600,
        "each_run": sum(seconds.values()) / max(len(seconds), 1),
        "commands": [
            (plan.about.get("folder", ""), plan.about.get("command", "")) for plan in tables.plans
        ],
    }


def measure_part(
    measure: Measure, groups: Sequence[Group], found: Mapping[str, list[Any]]
) -> dict[str, Any]:
    """One measure's table, plots and pairs."""
    table = []
    for group in groups:
        values, rows = group.values(measure)
        summary = middle(values, f"{measure.name} {group.label}")
        worst = measure.worst(values) if len(values) else None
        table.append(
            {
                "label": group.label,
                "n": len(group.rows),
                "completed": len(group.completed),
                "failed": group.failed,
                "measured": summary.number,
                "of_all": shown_median(group.median_of_all(measure)),
                "median": f"{summary.median:.6g}" if summary.number else "",
                "low": f"{summary.low:.6g}" if summary.number else "",
                "high": f"{summary.high:.6g}" if summary.number else "",
                "worst": "" if worst is None else f"{values[worst]:.6g}",
                "worst_seed": "" if worst is None else rows[worst]["seed"],
            }
        )
    said = plots.captions(groups, measure)
    names = list(found)
    figures = [
        {
            "name": f"{measure.name} {factor}",
            "caption": f"{measure.name} against {factor}",
            "svg": plots.against(factor, levels, groups, measure, names),
            **said,
        }
        for factor, levels in found.items()
        if len(levels) <= MOST_LEVELS
    ]
    if not figures and said["shown"]:
        whole = (
            groups[0] if len(groups) == 1 else Group("", {}, [r for g in groups for r in g.rows])
        )
        caption = f"{measure.name} of all runs"
        svg = plots.one_group(whole, measure)
        figures = [{"name": measure.name, "caption": caption, "svg": svg, **said}]
    return {
        "name": measure.name,
        "better": "higher" if measure.higher else "lower",
        "table": table,
        "figures": [one for one in figures if one["shown"]],
        "pairs": [pair_part(one, measure, names) for one in pairings(groups, measure, found)],
    }


def shown_median(value: float) -> str:
    """A median of all runs: none where it lies among those that are not complete."""
    return f"{value:.6g}" if np.isfinite(value) else "none"


def pair_part(pairing: Any, measure: Measure, names: Sequence[str]) -> dict[str, Any]:
    """Two levels compared seed by seed."""
    difference = pairing.difference
    return {
        "factor": short(pairing.factor, names),
        "base": shown(pairing.base),
        "other": shown(pairing.other),
        "n": difference.number,
        "median": f"{difference.median:+.6g}",
        "low": f"{difference.low:+.6g}",
        "high": f"{difference.high:+.6g}",
        "only_base": pairing.only_before,
        "only_other": pairing.only_after,
        "lower": pairing.lower,
        "higher": pairing.higher,
        "name": f"{measure.name} {pairing.factor} {shown(pairing.base)} {shown(pairing.other)}",
        "svg": plots.paired(pairing, measure),
    }


def failures(tables: Tables) -> list[dict[str, Any]]:
    """The runs that are not complete by outcome and reason, the most frequent first."""
    points = points_of(tables.plans)
    counts: Counter[tuple[str, str]] = Counter()
    such: dict[tuple[str, str], str] = {}
    for row in tables.results:
        if row["outcome"] != "completed":
            key = (row["outcome"], printable(row["reason"] or ""))
            counts[key] += 1
            such.setdefault(key, command_of(points[row["hash"]], row["seed"]))
    return [
        {"outcome": key[0], "reason": key[1], "count": count, "command": such[key]}
        for key, count in counts.most_common(MOST_REASONS)
    ]


def versions_of(tables: Tables) -> dict[str, str]:
    """Versions by name; several where the sweeps had several."""
    found: dict[str, dict[str, None]] = {}
    for plan in tables.plans:
        for name, version in plan.about.get("versions", {}).items():
            found.setdefault(name, {})[version] = None
    return {name: ", ".join(versions) for name, versions in found.items()}


def machines_of(tables: Tables) -> list[tuple[str, int]]:
    """The machines and how many of the runs were made on each."""
    counts = Counter(
        f"{row['host']}: {row['cores']} cores of {row['processor']}, {row['system']}"
        for row in tables.timings
    )
    return counts.most_common()


def write_html(content: Mapping[str, Any], path: Path) -> None:
    """One file that needs nothing else and no network."""
    for part in content["measures"]:
        for one in (*part["figures"], *part["pairs"]):
            one["svg"] = plots.identifiers_apart(one["svg"], one["name"])
    for look in content["looks"]:
        if look["picture"] is not None:
            look["data"] = base64.b64encode(look["picture"]).decode()
    write_aside(path, rendered("sweep.html.jinja", content).encode())


def write_markdown(content: Mapping[str, Any], path: Path) -> None:
    """A page with its plots and pictures in a folder beside it, for a repository."""
    folder = path.with_name(f"{path.stem}_files")
    folder.mkdir(exist_ok=True)
    number = 0
    for part in content["measures"]:
        for one in (*part["figures"], *part["pairs"]):
            number += 1
            one["file"] = f"{folder.name}/plot_{number}.svg"
            write_aside(path.parent / one["file"], one["svg"].encode())
    for look in content["looks"]:
        if look["picture"] is not None:
            look["file"] = f"{folder.name}/{look['title']}.png"
            write_aside(path.parent / look["file"], look["picture"])
    write_aside(path, rendered("sweep.md.jinja", content).encode())


def rendered(template: str, content: Mapping[str, Any]) -> str:
    """A template of this folder filled in; in HTML everything that is not ours is escaped."""
    try:
        from jinja2 import Environment, FileSystemLoader, StrictUndefined  # noqa: PLC0415
    except ImportError:
        raise UsageError(plots.MISSING) from None
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=template.endswith(".html.jinja"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["cell"] = lambda text: str(text).replace("|", "\\|").replace("\n", " ")
    return environment.get_template(template).render(content)
