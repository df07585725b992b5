"""Plots of a sweep as SVG: every run is a point, with the median and its interval beside them."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from troupe.report.groups import Group, Measure, Pairing, is_number, short, shown
from troupe.sweep.statistics import middle
from troupe.usage import UsageError

MOST_SERIES = 8
"""Combinations of the other parameters that are told apart in a plot."""

MOST_DRAWN = 2000
"""Points of a plot that are drawn one by one; more are a picture within it."""

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999")
"""Okabe and Ito's, which people who see red and green alike tell apart."""

MISSING = "troupe report needs the extra `report`: pip install 'troupe-sim[report]'"


def new_figure(width: float, height: float) -> Any:
    """An empty figure with its axes; raises UsageError without matplotlib."""
    try:
        import matplotlib as mpl  # noqa: PLC0415 - an extra
        from matplotlib.figure import Figure  # noqa: PLC0415
    except ImportError:
        raise UsageError(MISSING) from None
    mpl.rcParams["svg.hashsalt"] = "troupe"  # the same plot is the same file
    mpl.rcParams["svg.fonttype"] = "none"
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.add_subplot()
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure, axes


def as_svg(figure: Any) -> str:
    """A figure as an SVG element, to be put into a page."""
    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None}, dpi=150)
    text = out.getvalue()
    return text[text.index("<svg") :]


def against(
    factor: str,
    levels: Sequence[Any],
    groups: Sequence[Group],
    measure: Measure,
    all_: Sequence[str],
) -> str:
    """A measure against a parameter; the other parameters' combinations are series."""
    others = [name for name in all_ if name != factor]
    series: dict[str, list[Group]] = {}
    for group in groups:
        texts = [f"{short(name, all_)} {shown(group.levels[name])}" for name in others]
        series.setdefault(", ".join(texts), []).append(group)
    if len(series) > MOST_SERIES:
        series = {"": list(groups)}
    figure, axes = new_figure(min(10.0, 2.5 + 0.9 * len(levels)) + 1.5, 3.4)
    random = np.random.default_rng(1)
    spread = 0.7 / len(series)
    total = sum(len(group.rows) for group in groups)
    alpha = 0.6 if total <= 200 else 0.3
    line = "-" if all(is_number(value) for value in levels) else ""  # texts have no order
    for number, (label, members) in enumerate(series.items()):
        color = COLORS[number % len(COLORS)]
        middles: list[tuple[float, float]] = []
        for place, value in enumerate(levels):
            mine = [group for group in members if group.levels[factor] == value]
            values = np.concatenate([g.values(measure)[0] for g in mine]) if mine else np.zeros(0)
            if not len(values):
                continue
            centre = place + (number - (len(series) - 1) / 2) * spread
            jitter = random.uniform(-0.3, 0.3, len(values)) * spread
            axes.plot(
                centre + jitter, values, ".", color=color, alpha=alpha, markersize=6,
                markeredgewidth=0, rasterized=total > MOST_DRAWN,
            )  # fmt: skip
            found = middle(values, f"{measure.name} {factor} {shown(value)} {label}")
            axes.plot([centre, centre], [found.low, found.high], color=color, linewidth=2.5)
            middles.append((centre, found.median))
        if middles:
            x, y = zip(*middles, strict=True)
            axes.plot(x, y, f"{line}o", color=color, linewidth=0.8, markersize=6,
                      markerfacecolor="white", label=label or None)  # fmt: skip
    axes.set_xticks(range(len(levels)), [shown(value) for value in levels],
                    rotation=0 if len(levels) < 12 else 90)  # fmt: skip
    axes.set_xlabel(factor)
    axes.set_ylabel(measure.name)
    if len(series) > 1:
        figure.legend(loc="outside right upper", fontsize="small", frameon=False)
    return as_svg(figure)


def one_group(group: Group, measure: Measure) -> str:
    """How a measure is spread where there is only one combination."""
    values, _ = group.values(measure)
    figure, axes = new_figure(6.5, 2.6)
    axes.hist(values, bins=min(40, max(5, int(len(values) ** 0.5))), color=COLORS[0], alpha=0.5)
    marks = np.full(len(values), -0.02 * axes.get_ylim()[1])
    axes.plot(values, marks, "|", color=COLORS[0], rasterized=len(values) > MOST_DRAWN)
    found = middle(values, f"{measure.name} {group.label}")
    axes.axvspan(found.low, found.high, color=COLORS[1], alpha=0.25)
    axes.axvline(found.median, color=COLORS[1])
    axes.set_xlabel(measure.name)
    axes.set_ylabel("runs")
    return as_svg(figure)


def paired(pairing: Pairing, measure: Measure) -> str:
    """Each pair of runs of one seed as a point; on the line nothing has changed."""
    figure, axes = new_figure(3.9, 3.6)
    both = np.concatenate([pairing.before, pairing.after])
    ends = [both.min(), both.max()]
    axes.plot(ends, ends, color="#999999", linewidth=0.8)
    axes.plot(pairing.before, pairing.after, ".", color=COLORS[0], alpha=0.5, markeredgewidth=0,
              rasterized=len(both) > MOST_DRAWN)  # fmt: skip
    axes.set_xlabel(f"{measure.name}, {shown(pairing.base)}")
    axes.set_ylabel(f"{measure.name}, {shown(pairing.other)}")
    return as_svg(figure)


def identifiers_apart(svg: str, name: str) -> str:
    """The SVG with names that no other one in the same page has."""
    mark = hashlib.sha256(name.encode()).hexdigest()[:6]
    for before in ('id="', 'xlink:href="#', "url(#"):
        svg = svg.replace(before, f"{before}{mark}-")
    return svg


def captions(groups: Sequence[Group], measure: Measure) -> Mapping[str, int]:
    """What each caption says: how many runs are shown, how many failed."""
    shown_runs = sum(len(group.values(measure)[0]) for group in groups)
    return {"shown": shown_runs, "failed": sum(group.failed for group in groups)}
