"""From what is written on the command line to a sweep's plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sim.worldfile.mistakes import Mistake
from troupe.sweep.plan import Plan, make_plan
from troupe.sweep.results import Each, Judge
from troupe.sweep.samplers import Sampler
from troupe.sweep.seeds import Unusable, parse_seeds
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
    about: Mapping[str, Any],
) -> Plan:
    """The plan; raises Unusable with every mistake that was found, and UsageError.

    One of `worlds` may be a sweep.yaml; what is said on the command line goes before it.
    """
    files = [name for name in worlds if is_sweep_file(name)]
    named = tuple(name for name in worlds if name not in files)
    if len(files) > 1:
        raise UsageError(f"{files[1]}: there is a sweep already, {files[0]}")
    mistakes: list[Mistake] = []
    said = FromFile()
    parameters: dict[str, Sampler] = {}
    chosen: tuple[int, ...] | None = None
    rows = None
    try:
        said = read_sweep_file(Path(files[0])) if files else said
    except Unusable as error:
        mistakes += error.mistakes
    parameters.update(said.parameters)
    for text in settings:
        try:
            key, sampler = parse_setting(text)
            parameters[key] = sampler
        except Unusable as error:
            mistakes += error.mistakes
    try:
        chosen = said.seeds if seeds is None else tuple(parse_seeds(seeds))
    except Unusable as error:
        mistakes += error.mistakes
    try:
        path = table if table is not None else said.table and Path(said.table)
        rows = read_table(path) if path else None
    except Unusable as error:
        mistakes += error.mistakes
    if mistakes:
        raise Unusable(*mistakes)
    here = str(Path.cwd())
    functions = [Each(name, here) for name in (each or said.each)]
    judges = tuple(Judge(name, here) for name in (judge or said.judge))
    for one in (*functions, *judges):
        one.load()
    spec = Spec(
        named or said.worlds,
        chosen,
        parameters,
        rows,
        said.samples,
        said.sampling_seed,
        said.duration if duration is None else duration,
    )
    return make_plan(
        combinations(spec),
        spec.duration,
        {**about, "each": [vars(one) for one in functions]},
        judges,
    )
