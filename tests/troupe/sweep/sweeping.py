"""Small sweeps for the tests: worlds, and the command line."""

from __future__ import annotations

from pathlib import Path

from tests.started import troupe
from troupe.sweep.asked import asked_plan
from troupe.sweep.plan import Plan

__all__ = ["DRIVEN", "QUIET", "driven_world", "plan_of", "quiet_world", "troupe"]

QUIET = """\
size: [6, 6]
duration: 0.5
until: duration
models: {rover: {body: {shape: circle, radius: 0.2}}}
robots: [{model: rover, count: 3, placement: random}]
"""

DRIVEN = """\
size: [8, 8]
duration: 2
models:
  rover: {body: {shape: circle, radius: 0.3}, sensors: [{type: laser, samples: 36}]}
robots: [{name: one, model: rover, placement: random, controller: mine}]
controllers: {mine: {program: ./mine.py}}
"""


def quiet_world(folder: Path) -> Path:
    """A world of robots that stand still: a run takes milliseconds."""
    (folder / "quiet.yaml").write_text(QUIET)
    return folder / "quiet.yaml"


def driven_world(folder: Path, program: str) -> Path:
    """A world of one robot with a program."""
    (folder / "mine.py").write_text(program)
    (folder / "driven.yaml").write_text(DRIVEN)
    return folder / "driven.yaml"


def plan_of(
    world: Path,
    seeds: str,
    *settings: str,
    each: tuple[str, ...] = (),
    judge: tuple[str, ...] = (),
) -> Plan:
    return asked_plan(
        [str(world)], seeds=seeds, settings=settings, table=None, duration=None, each=each,
        judge=judge, about={},
    )  # fmt: skip
