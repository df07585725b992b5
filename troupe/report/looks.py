"""Runs to look at: the best, the one in the middle and the worst, each run again for a picture."""

from __future__ import annotations

import shlex
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.video.errors import VideoError
from sim.worldfile import WorldError
from troupe.report.groups import Group, Measure
from troupe.sweep.plan import Plan, Point, as_settings, load_point
from troupe.sweep.rows import Row

PATIENT = 60.0
"""Seconds that a run may have taken to be run again for a picture."""


@dataclass(frozen=True)
class Look:
    """One run: why it is shown, how to watch it, its picture as PNG or why there is none."""

    title: str
    label: str
    seed: int
    value: float
    command: str
    picture: bytes | None
    why_not: str


def command_of(point: Point, seed: int, more: str = "--video watch.mp4") -> str:
    """The command that runs a run again; of a function's, into a folder of its own."""
    if point.duration is None:
        words = ["troupe", "sweep", point.world, "--seeds", str(seed)]
        for setting in as_settings(point.settings):
            words += ["--set", setting]
        return shlex.join([*words, "--out", "again"])
    words = ["troupe", "run", point.world, "--seed", str(seed), "--duration", f"{point.duration:g}"]
    for setting in as_settings(point.settings):
        words += ["--set", setting]
    return f"{shlex.join(words)} {more}".strip()


def points_of(plans: Sequence[Plan]) -> dict[str, Point]:
    """The combinations of all plans by their hashes."""
    return {point.hash: point for plan in plans for point in plan.points}


def looks(
    groups: Sequence[Group],
    measure: Measure,
    plans: Sequence[Plan],
    seconds: dict[tuple[str, int], float],
    *,
    pictures: bool,
) -> list[Look]:
    """Three runs, fewer where there are not so many."""
    points = points_of(plans)
    values = []
    rows: list[tuple[Group, Row]] = []
    for group in groups:
        numbers, mine = group.values(measure)
        values += list(numbers)
        rows += [(group, row) for row in mine]
    if not rows:
        return []
    order = np.argsort(np.array(values), kind="stable")
    if measure.higher:
        order = order[::-1]
    chosen = {"best": order[0], "median": order[len(order) // 2], "worst": order[-1]}
    found = []
    seen = set()
    for title, index in chosen.items():
        if index in seen:
            continue
        seen.add(index)
        group, row = rows[index]
        point = points[row["hash"]]
        picture, why_not = None, "left out"
        if pictures:
            taken = seconds.get((row["hash"], row["seed"]), 0.0)
            picture, why_not = picture_of(point, row, taken)
        command = command_of(point, row["seed"])
        found.append(
            Look(title, group.label, row["seed"], values[index], command, picture, why_not)
        )
    return found


def picture_of(point: Point, row: Row, taken: float) -> tuple[bytes | None, str]:
    """The end of a run as PNG, or why there is none: only a run of the same digest is shown."""
    from troupe.running import run_file  # noqa: PLC0415 - loads the simulator

    if point.duration is None:
        return None, "a function has none"
    if taken > PATIENT:
        return None, f"running it again would take {taken:.0f} s"
    settings = as_settings(point.settings)
    try:
        _, mark, _ = load_point(point.path, settings, point.duration)
        if mark.hash != point.hash:
            return None, "the world, a file that it names, or Troupe has been changed since"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "end.png"
            done = run_file(
                point.path,
                seed=row["seed"],
                duration=point.duration,
                settings=[*settings, "player.port=null", "log=null"],
                picture=path,
                say=lambda line: None,
            )
            if done.video_error is not None:
                return None, done.video_error
            if done.result.digest != row["digest"]:
                return None, "this machine gives another digest than the one that it was run on"
            return path.read_bytes(), ""
    except (WorldError, VideoError, OSError) as error:
        return None, str(error)
