"""What `troupe log info` tells of a log."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from troupe.log import Log
from troupe.summary import OUTCOMES, counted

MOST_ROBOTS = 40
"""Robots listed one by one."""
MOST_TOPICS = 60


def described(path: Path) -> Iterator[str]:
    """The lines, one by one."""
    log = Log(path)
    about, result, ticks = log.about, log.result, log.ticks
    world = f"{about.get('title', '')} ({about.get('world', '')})"
    yield f"{path}: {world}, seed {about.get('seed', '')}"
    if result is None:
        yield "the log ends before the run: how that ended is not known"
    else:
        outcome = OUTCOMES.get(result["outcome"], result["outcome"])
        yield f"{outcome}, {result['digest']}"
    span = f"{log.times[0]:g} s to {log.times[-1]:g} s" if len(ticks) else "no time"
    yield f"{counted(len(ticks), 'tick')} of {log.interval:g} s, {span}"
    size = log._reader.size
    yield sized(size) + (f", {sized(size / len(ticks))} a tick" if len(ticks) else "")
    made = ", ".join(
        f"{name} {about[name]}" for name in ("python", "numpy", "numba", "pymunk") if name in about
    )
    yield f"troupe {about.get('version', '')} on {about.get('machine', '')} ({made})"
    yield ""
    entries = log.entries
    yield counted(len(entries), "robot")
    width = max((len(entry.name) for entry in entries[:MOST_ROBOTS]), default=0)
    for entry in entries[:MOST_ROBOTS]:
        x, y, _ = entry.pose
        where = f"entered at {entry.time:g} s at ({x:.2f}, {y:.2f})"
        yield f"  {entry.name:{width}}  {entry.model}, {where}"
    if len(entries) > MOST_ROBOTS:
        yield f"  ... and {len(entries) - MOST_ROBOTS} more"
    yield ""
    topics = sorted(log._reader.topics.items())
    yield counted(len(topics), "topic")
    for topic, (_, kind) in topics[:MOST_TOPICS]:
        yield f"  {log._reader.count(topic):8} {topic} ({kind})"
    if len(topics) > MOST_TOPICS:
        yield f"           ... and {len(topics) - MOST_TOPICS} more"


def sized(size: float) -> str:
    """Bytes, as people read them."""
    for unit in ("bytes", "kB", "MB"):
        if size < 1000.0:
            return f"{size:.0f} {unit}" if unit == "bytes" else f"{size:.1f} {unit}"
        size /= 1000.0
    return f"{size:.2f} GB"
