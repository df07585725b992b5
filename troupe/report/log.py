"""The report of one run, from its log: one HTML file that needs no network and no extra package."""

from __future__ import annotations

import json
import shlex
from pathlib import Path
from typing import Any

import numpy as np

from sim.log.playback import Playback
from troupe.log import Log
from troupe.report.charts import Mark, Series, chart, escaped, number, time_line
from troupe.report.html import MOST_ROWS, figure, page, preformatted, table
from troupe.report.log_charts import CURVE, EACH, company, driving, painting, reported
from troupe.report.measures import measure
from troupe.report.stills import pictures
from troupe.summary import OUTCOMES, counted
from troupe.sweep.folder import write_aside
from troupe.usage import UsageError, check_output

MOST_LINED, MOST_MARKS = 40, 1500
"""Robots on the time line, and marks on it."""
LAST_LINES = 5
ENDINGS = (".html", ".htm")


def check_page(path: Path, *sources: Path) -> None:
    """Raises UsageError for a page that cannot be asked for, or that is one of its `sources`."""
    if path.suffix.lower() not in ENDINGS:
        raise UsageError(f"{path}: the report of a run is a page: name it *.html")
    check_output(path, ENDINGS, "report", *sources)


def write_report(log: Log, path: Path) -> None:
    """Write the report of a log; raises LogError, and OSError where it cannot be written."""
    write_aside(path, report_of(log).encode())


def report_of(log: Log) -> str:
    """The page."""
    playback = Playback(log._reader)
    measures = measure(log)
    title = log.about.get("title", "") or log.path.stem
    begun, ended = pictures(playback, measures.ways)
    result = log.result
    body = [
        what_ran(log, result),
        "<h2>Start and end</h2>",
        figure(begun, f"After the first tick, {number(log.times[0])} s."),
        figure(ended, f"At the end, {number(log.times[-1])} s, with the ways of all robots."),
        *what_happened(log),
        *driving(log, measures, result),
        *company(log, measures),
        *painting(log, result),
        *reported(log, measures),
        *contacts(log),
        *controllers(log, result),
    ]
    return page(title, body)


def what_ran(log: Log, result: dict[str, Any] | None) -> str:
    """What ran, how it ended, and what repeats it."""
    about = log.about
    words = ["troupe", "run", about.get("world", ""), "--seed", about.get("seed", "")]
    words += ["--duration", f"{log._reader.number('duration'):g}"]
    for setting in settings_of(log):
        words += ["--set", setting]
    ended = (
        "was cut off: how it ended is not known"
        if result is None
        else OUTCOMES.get(result["outcome"], result["outcome"])
    )
    packages = ("python", "numpy", "numba", "pymunk")
    made = ", ".join(f"{name} {about[name]}" for name in packages if name in about)
    rows = [
        ("the run", ended),
        ("world", about.get("world", "")),
        ("seed", about.get("seed", "")),
        ("simulated", f"{log.times[-1]:g} s, {counted(len(log), 'tick')} of {log.interval:g} s"),
    ]
    if result is not None:
        rows.append(("took", f"{result['wall_time']:.2f} s, {result['speed']:.0f} x real time"))
        rows.append(("digest", result["digest"]))
    rows.append(("made by", f"troupe {about.get('version', '')} ({made})"))
    rows.append(("on", about.get("machine", "")))
    cells = "".join(
        f'<tr><th scope="row">{name}</th><td class="text">{escaped(value)}</td></tr>'
        for name, value in rows
    )
    touched = (result or {}).get("touched") or []
    by_hand = (
        f"<p>{counted(len(touched), 'time')} a hand reached into the run: the command does not "
        "repeat that.</p>"
        if touched
        else ""
    )
    command = escaped(shlex.join(words))
    return f"<table>{cells}</table>\n{by_hand}<p>Again:</p><pre>{command}</pre>"


def settings_of(log: Log) -> list[str]:
    """The changes to the world with which it ran."""
    try:
        return [str(setting) for setting in json.loads(log.about.get("settings") or "[]")]
    except (ValueError, TypeError):
        raise log._reader.damaged("its settings cannot be read") from None


def what_happened(log: Log) -> list[str]:
    """What robots said, touched, and how their controllers ended, in time."""
    names = log.robots
    if not names:
        return []
    shown = names[:MOST_LINED]
    rows = {name: row for row, name in enumerate(shown)}
    said, touches, ends = log.said, log.touches, log.controllers
    happened = [
        *(Mark(one.time, rows[one.robot], "touch", f"{one.robot} touches something")
          for one in touches if one.robot in rows),
        *(Mark(one.time, rows[one.robot], "said", f"{one.robot}: {one.text}")
          for one in said if one.robot in rows),
        *(Mark(one.time, rows[one.robot], "end", f"{one.robot}: {one.state}")
          for one in ends if one.robot in rows and one.state != "running"),
    ]  # fmt: skip
    more = f" Shown are the first {len(shown)} of {len(names)} robots." * (len(names) > len(shown))
    marks = happened[:: max(1, -(-len(happened) // MOST_MARKS))]
    svg = time_line(shown, marks, float(log.times[-1]), "What happened when")
    parts = [
        "<h2>What happened</h2>",
        figure(svg, "Dots: something was said; bars: a contact began; triangles: the controller "
               "ended. Each tells what, under the pointer." + more),
    ]  # fmt: skip
    if said:
        parts.append(
            table(
                ("time, s", "robot", "said"),
                [(f"{one.time:.1f}", one.robot, one.text) for one in said],
                texts=(1, 2),
            )
        )
    counts = entered_and_ended(log)
    if counts is not None:
        parts.append(counts)
    return parts


def entered_and_ended(log: Log) -> str | None:
    """How many had entered, and how many controllers had ended, where that is many."""
    entries = np.sort([entry.time for entry in log.entries])
    last = {one.robot: one.time for one in log.controllers if one.state != "running"}
    ends = np.sort(list(last.values()))
    if len(entries) < EACH or (not len(ends) and entries[-1] == 0.0):
        return None
    until = float(log.times[-1])
    series = [Series("entered", CURVE, *steps(entries, until))]
    if len(ends):
        series.append(Series("controller ended", "#d55e00", *steps(ends, until)))
    svg = chart(series, "Robots that have entered and ended", "time, s", "robots")
    told = f", controllers ended from {ends[0]:.1f} to {ends[-1]:.1f} s" if len(ends) else ""
    entered = f"Robots entered from {entries[0]:.1f} to {entries[-1]:.1f} s{told}."
    return figure(svg, entered)


def steps(times: np.ndarray, until: float) -> tuple[np.ndarray, np.ndarray]:
    """A count that goes up at these times, as a curve."""
    x = np.repeat(np.r_[times, until], 2)[:-1]
    y = np.repeat(np.arange(len(times) + 1), 2)[1:]
    return x.astype(float), y.astype(float)


def contacts(log: Log) -> list[str]:
    """When and where robots began to touch something."""
    touches = log.touches
    if not touches:
        return ["<h2>Contacts</h2>", "<p>No robot touched anything.</p>"]
    rows = [(f"{t.time:.1f}", t.robot, f"{t.point[0]:.2f}", f"{t.point[1]:.2f}") for t in touches]
    return ["<h2>Contacts</h2>", table(("time, s", "robot", "x, m", "y, m"), rows, texts=(1,))]


def controllers(log: Log, result: dict[str, Any] | None) -> list[str]:
    """The controllers' states, with the last lines that each printed."""
    states: dict[str, tuple[str, int | None, str | None]] = {}
    for one in log.controllers:
        states[one.robot] = one.state, one.exit_code, one.error
    for robot in (result or {}).get("robots", ()):
        driver = robot["controller"]
        states[robot["name"]] = driver["state"], driver["exit_code"], driver["error"]
    lines: dict[str, list[str]] = {}
    for line in log.lines:
        lines.setdefault(line.who, []).append(line.text)
    rows = []
    for name in log.robots:
        state, code, error = states.get(name, ("running", None, None))
        told = "\n".join([*([] if error is None else [error]), *lines.get(name, [])[-LAST_LINES:]])
        rows.append((name, state, "" if code is None else str(code), told))
    rows.sort(key=lambda row: row[1] not in ("failed", "hung", "lost"))
    if all(state == "none" for _, state, _, _ in rows):
        return ["<h2>Controllers</h2>", "<p>No robot had a controller.</p>"]
    others = [line for who, told in lines.items() if who not in states for line in told]
    more = (
        ["<h3>Other lines</h3>", f"<pre>{preformatted(others[-MOST_ROWS:])}</pre>"]
        if others
        else []
    )
    header = ("robot", "controller", "exit code", "its last lines")
    return ["<h2>Controllers</h2>", table(header, rows, texts=(1, 3)), *more]
