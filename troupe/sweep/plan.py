"""A sweep's plan: every combination checked before the first run, and the name of every run."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sim.build import LoadedWorld, load
from sim.worldfile import WorldError
from sim.worldfile.mistakes import MOST_TOLD, Mistake
from troupe.sweep.fingerprint import Fingerprint, drivers, fingerprint
from troupe.sweep.functions import Function, arguments, function_mark, is_function
from troupe.sweep.results import Judge
from troupe.sweep.seeds import parse_seeds, written
from troupe.sweep.spec import Combination
from troupe.usage import UsageError
from troupe.worlds import find_world

FORMAT = 1


@dataclass(frozen=True)
class Point:
    """One combination that has been checked: its runs differ in nothing but the seed."""

    hash: str
    world: str  # as it was asked for
    path: str  # absolute: the world's file, or the folder that a function is called in
    settings: Mapping[str, Any]
    duration: float | None  # simulated seconds; a function has none
    seeds: tuple[int, ...]
    judges: tuple[Judge, ...] = ()

    @property
    def function(self) -> Function | None:
        """The function that is run in a world's place, if it is one."""
        return Function(self.world, self.path) if self.duration is None else None


@dataclass(frozen=True)
class Run:
    """One run of a plan; its name says all that its result depends on."""

    point: Point
    seed: int

    @property
    def name(self) -> str:
        return f"{self.point.hash}-s{self.seed}"


@dataclass(frozen=True)
class Plan:
    """All runs of a sweep, in their order. `about` is for people, and no part of its name."""

    points: tuple[Point, ...]
    about: Mapping[str, Any]

    @property
    def size(self) -> int:
        return sum(len(point.seeds) for point in self.points)

    def runs(self, shard: tuple[int, int] = (1, 1)) -> Iterator[Run]:
        """The runs of shard I of N: every N-th one, so that all shards have about as much to do."""
        first, number = shard
        index = 0
        for point in self.points:
            for seed in point.seeds:
                if index % number == first - 1:
                    yield Run(point, seed)
                index += 1

    @property
    def name(self) -> str:
        """A hash of the runs."""
        text = json.dumps([point_as_json(point) for point in self.points], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def as_json(self) -> dict[str, Any]:
        points = [point_as_json(point) for point in self.points]
        return {"format": FORMAT, "about": dict(self.about), "points": points}


def point_as_json(point: Point) -> dict[str, Any]:
    judges = {"judges": [vars(one) for one in point.judges]} if point.judges else {}
    return {
        **judges,
        "hash": point.hash,
        "world": point.world,
        "settings": dict(point.settings),
        "duration": point.duration,
        "seeds": written(list(point.seeds)),
    }


def plan_of_json(data: Mapping[str, Any]) -> Plan:
    """The plan that a folder holds."""
    paths = data["about"].get("paths", {})
    points = tuple(
        Point(
            one["hash"],
            one["world"],
            paths.get(one["world"], one["world"]),
            one["settings"],
            one["duration"],
            tuple(parse_seeds(one["seeds"])),
            tuple(Judge(**judge) for judge in one.get("judges", ())),
        )
        for one in data["points"]
    )
    return Plan(points, data["about"])


def as_settings(settings: Mapping[str, Any]) -> list[str]:
    """Settings as the command line has them; JSON is YAML."""
    return [f"{key}={json.dumps(value)}" for key, value in settings.items()]


def load_point(
    world: str | Path,
    settings: Sequence[str],
    duration: float | None,
    judges: Sequence[Judge] = (),
) -> tuple[LoadedWorld, Fingerprint, float]:
    """A combination's world, its fingerprint and how long its runs last at most.

    Raises WorldError, also for what cannot be run by the thousand.
    """
    loaded = load(world, settings=settings)
    mistakes = [
        Mistake(
            ("controllers", name, "external"),
            "a sweep has nobody who connects by hand",
            allowed="program, or command",
            file=str(loaded.path),
        )
        for name, controller in loaded.world.controllers.items()
        if controller.external and name in drivers(loaded)
    ]
    if mistakes:
        raise WorldError(mistakes)
    most = loaded.world.duration if duration is None else duration
    return loaded, fingerprint(loaded, most, judges), most


def make_plan(
    asked: Sequence[Combination],
    duration: float | None,
    about: Mapping[str, Any],
    judges: tuple[Judge, ...] = (),
) -> Plan:
    """Check every combination; raises UsageError with every mistake of all of them, each once.

    Combinations of the same effect are one: they would be the same runs.
    """
    points: dict[str, Point] = {}
    found: dict[str, list[Combination]] = {}  # a mistake's text: where it is
    for one in asked:
        try:
            check = function_point if is_function(one.world) else world_point
            point = check(one, duration, judges)
        except WorldError as error:
            for mistake in error.mistakes:
                found.setdefault(text_of(mistake, one), []).append(one)
            continue
        known = points.get(point.hash)
        if known is not None:
            point = replace(known, seeds=tuple(dict.fromkeys((*known.seeds, *point.seeds))))
        points[point.hash] = point
    if found:
        texts = [told(text, at, len(asked)) for text, at in found.items()]
        more = [f"... and {len(texts) - MOST_TOLD} more mistakes"] * (len(texts) > MOST_TOLD)
        raise UsageError("\n".join([*texts[:MOST_TOLD], *more]))
    paths = {point.world: point.path for point in points.values()}
    return Plan(tuple(points.values()), {**about, "paths": paths})


def world_point(
    asked: Combination, duration: float | None, judges: tuple[Judge, ...] = ()
) -> Point:
    """A world with settings, checked; raises WorldError."""
    path = find_world(asked.world)
    if path.suffix == ".py":
        what = "is a program; a sweep runs a function in it"
        raise WorldError([Mistake((), what, None, f"{asked.world}:FUNCTION", asked.world)])
    if not path.is_file():
        what = "a sweep reads its worlds many times: it must be a file"
        raise WorldError([Mistake((), what, file=asked.world)])
    loaded, mark, most = load_point(path, as_settings(asked.settings), duration, judges)
    seeds = (loaded.world.seed,) if asked.seeds is None else asked.seeds
    place = str(path.resolve())
    return Point(mark.hash, asked.world, place, asked.settings, most, seeds, judges)


def function_point(
    asked: Combination, duration: float | None, judges: tuple[Judge, ...] = ()
) -> Point:
    """A function with parameters, checked; raises WorldError."""
    folder = str(Path.cwd())
    function = Function(asked.world, folder)
    mistakes = []
    if duration is not None:
        what = "a function has no simulated time of ours"
        instead = "its own parameter, as --set duration=60"
        mistakes.append(Mistake((), what, None, instead, "--duration"))
    if judges:
        what = "a function's run has no ticks to be judged; let it return what is to be told"
        mistakes.append(Mistake((), what, file=str(judges[0])))
    try:
        arguments(function, asked.settings)
        mark = function_mark(function, asked.settings)
    except UsageError as error:
        mistakes.append(Mistake((), str(error)))
    except WorldError as error:
        mistakes += error.mistakes
    if mistakes:
        raise WorldError(mistakes)
    seeds = (0,) if asked.seeds is None else asked.seeds
    return Point(mark.hash, asked.world, folder, asked.settings, None, seeds)


def text_of(mistake: Mistake, asked: Combination) -> str:
    """A mistake as a line, at the place where the setting was given.

    It is the same for all values of a setting if it is about the key.
    """
    file = mistake.file or ""
    if file.startswith("--set "):
        option, _, _ = file.partition("=")
        place = asked.places.get(option.removeprefix("--set "))
        if place is None:
            return str(replace(mistake, file=option))
        line = place.line if mistake.given is not None or place.column is not None else None
        return str(replace(mistake, file=place.file, line=line, column=place.column))
    return str(mistake)


def told(text: str, at: Sequence[Combination], number: int) -> str:
    """A mistake with the combinations that have it."""
    if len(at) == number or number == 1:
        return text
    settings = ", ".join(f"{key}={json.dumps(v)}" for key, v in at[0].settings.items())
    such = f"{at[0].world} with {settings}" if settings else at[0].world
    return f"{text} [in {len(at)} of {number} combinations, such as {such}]"
