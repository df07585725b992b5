"""From what is written on the command line to a sweep's plan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sim.worldfile.nodes import Mark
from troupe.sweep.plan import Plan, make_plan
from troupe.sweep.recordings import check_words
from troupe.sweep.results import Each, Judge
from troupe.sweep.samplers import Sampler
from troupe.sweep.seeds import parse_seeds
from troupe.sweep.spec import Spec, combinations, parse_setting
from troupe.sweep.specfile import FromFile, is_sweep_file, read_sweep_file, read_table
from troupe.usage import UsageError


def asked_plan(
    worlds: Sequence[str],
    *,
    seeds: str | None,
    settings: Sequence[str],
    table: Path | None,
    duration: float | None,
    each: Sequence[str],
    judge: Sequence[str] = (),
    recorded: Mapping[str, str] | None = None,
    about: Mapping[str, Any],
    mistakes: Sequence[str] = (),
) -> Plan:
    """The plan; raises UsageError with every mistake that was found, here and before.

    One of `worlds` may be a sweep.yaml; what is said on the command line goes before it.
    `recorded`: of which runs there is to be a "video" or a "log".
    """
    files = [name for name in worlds if is_sweep_file(name)]
    named = tuple(name for name in worlds if name not in files)
    found = list(mistakes)
    if len(files) > 1:
        found.append(f"{files[1]}: there is a sweep already, {files[0]}")
    said, rows = FromFile(), None
    files_read = len(found)
    with noted(found):
        said = read_sweep_file(Path(files[0])) if files else said
    with noted(found):
        path = table if table is not None else said.table and Path(said.table)
        rows = read_table(path) if path else None
    complete = len(found) == files_read  # else nobody knows which worlds and settings there are
    parameters: dict[str, Sampler] = dict(said.parameters)
    places: dict[str, Mark] = dict(said.places)
    for text in settings:
        with noted(found):
            key, sampler = parse_setting(text)
            parameters[key] = sampler
            places.pop(key, None)
    chosen: tuple[int, ...] | None = None
    with noted(found):
        chosen = said.seeds if seeds is None else tuple(parse_seeds(seeds))
    most = said.duration if duration is None else duration
    if most is not None and not 0 < most < 1e15:
        found.append(f"--duration {most:g}: must be above 0 and below 1e15")
        most = None
    here = str(Path.cwd())
    functions = [Each(name, here) for name in (each or said.each)]
    judges: tuple[Judge, ...] = ()
    for one in functions:
        with noted(found):
            one.load()
    for name in judge or said.judge:
        with noted(found):
            Judge(name, here).load()
            judges += (Judge(name, here),)
    plan = None
    if complete:
        with noted(found):
            spec = Spec(
                named or said.worlds,
                chosen,
                parameters,
                rows,
                said.samples,
                said.sampling_seed,
                places,
            )
            added = {**about, "each": [vars(one) for one in functions]}
            plan = make_plan(combinations(spec), most, added, judges)
    with noted(found):
        check_words(plan, recorded or {})
    if found or plan is None:
        raise UsageError("\n".join(found))
    return plan


@contextmanager
def noted(mistakes: list[str]) -> Iterator[None]:
    """What cannot be used within is a mistake among others."""
    try:
        yield
    except UsageError as error:
        mistakes.append(str(error))
