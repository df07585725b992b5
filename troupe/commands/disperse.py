"""`troupe disperse`: uniform dispersal on the grid, without bodies."""

import difflib
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from controllers.dispersal.rules import RULES
from troupe.interrupts import raised
from troupe.usage import UsageError, told

if TYPE_CHECKING:
    from gridworld.grid import GridRun, Outcome
    from gridworld.regions import Region

# The rest of the package is loaded by the command itself: other commands need no compiler.
# ruff: noqa: PLC0415


def disperse(
    map_file: Annotated[
        Path | None,
        typer.Argument(
            metavar="MAP",
            help="Text map: # wall, . free, S a door. A file, or the name of a map "
            "that comes with Troupe (`troupe worlds` lists them).",
            show_default="none: give --grid",
        ),
    ] = None,
    *,
    grid: Annotated[
        str | None,
        typer.Option(
            metavar="WxH",
            help="Instead of a map: so many columns and rows.",
            show_default="none: give a map",
        ),
    ] = None,
    door: Annotated[
        list[str] | None,
        typer.Option(
            metavar="COL,ROW",
            help="Cell of a door, counted from the top left, from 0, in place of the map's doors; "
            "may be given several times. 'best': where total travel is least.",
            show_default="the map's",
        ),
    ] = None,
    rule: Annotated[
        str, typer.Option(help=f"One of {', '.join(RULES)}. light is AsynchFCDFS.")
    ] = "fcdfs",
    seed: Annotated[int, typer.Option(min=0, max=2**63 - 1, help="For all chance.")] = 0,
    q: Annotated[float, typer.Option(help="Probability that a robot misses a step.")] = 0.0,
    conflict: Annotated[
        str,
        typer.Option(
            metavar="stop|stay",
            help="Two robots would meet in a cell: stop the run, or the later one stays.",
        ),
    ] = "stop",
    force: Annotated[bool, typer.Option("--force", help="Run a region with holes too.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
    max_steps: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="End the run after so many steps at the latest.",
            show_default="no limit",
        ),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.png|.svg", help="Draw the last step.", show_default="none is made"
        ),
    ] = None,
    at: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="STEP",
            help="Draw the end of this step instead.",
            show_default="the last",
        ),
    ] = None,
    video_file: Annotated[
        Path | None,
        typer.Option(
            "--video", metavar="FILE.mp4", help="Draw every step.", show_default="none is made"
        ),
    ] = None,
) -> None:
    """Disperse robots over a region of the grid, by the paper's synchronous model.

    Exit code 0 if every cell came to hold a settled robot, 1 if the run ended short, 2 for bad
    usage or a bad map.
    """
    rule = _one_of("--rule", rule, list(RULES))
    conflict = _one_of("--conflict", conflict, ["stop", "stay"])
    if not 0 <= q < 1:
        raise typer.BadParameter(f"{q} is not at least 0 and less than 1", param_hint="--q")
    if at is not None and picture is None:
        raise typer.BadParameter("needs --picture", param_hint="--at")
    from sim.video.errors import VideoError
    from sim.video.target import check_target
    from troupe.compiling import Compiling
    from troupe.maps import find_map
    from troupe.warm import tell, warm_once

    try:
        if picture is not None:
            check_target(picture, endings=(".png", ".svg"), what="picture")
        if video_file is not None:
            check_target(video_file)
    except VideoError as error:
        _fail(str(error))
    try:
        found = None if map_file is None else find_map(map_file)
    except UsageError as error:
        _fail(str(error))
    warm_once(tell)
    with Compiling(), raised():
        run, outcome = _dispersed(
            found,
            grid,
            door or [],
            rule,
            seed,
            q,
            conflict,
            force,
            max_steps,
            picture,
            at,
            video_file,
        )
    result = {
        "map": str(map_file) if map_file else grid,
        "doors": [list(cell) for cell in run.region.doors],
        "rule": rule,
        "seed": seed,
        "q": q,
        "conflict": conflict,
        **outcome.figures(),
    }
    print(json.dumps(result) if as_json else _in_words(result))
    raise typer.Exit(0 if outcome.all_settled else 1)


def _dispersed(
    map_file: Path | None,
    grid: str | None,
    doors: list[str],
    rule: str,
    seed: int,
    q: float,
    conflict: str,
    force: bool,
    max_steps: int | None,
    picture: Path | None,
    at: int | None,
    video_file: Path | None,
) -> "tuple[GridRun, Outcome]":
    """The run when it is over, and what came out of it; what cannot be ends the command."""
    from gridworld.grid import GridRun
    from gridworld.regions import RegionError
    from sim.video.errors import VideoError
    from troupe.grid_film import record

    try:
        region = _region(map_file, grid, doors, force)
        run = GridRun(region, rule, seed=seed, q=q, conflict=conflict)
        record(run, max_steps=max_steps, picture=picture, at=at, film=video_file, rule=rule)
    except (RegionError, UsageError, VideoError) as error:
        _fail(str(error))
    except OSError as error:
        _fail(told(error))
    except KeyboardInterrupt:
        raise typer.Exit(130) from None
    return run, run.outcome()


def _in_words(result: dict[str, Any]) -> str:
    where = f" at {result['where'][0]},{result['where'][1]}" if result["where"] else ""
    lines = {
        "outcome": result["outcome"].replace("_", " ") + where,
        "cells": f"{result['cells']}, {result['settled']} settled",
        "makespan": result["makespan"] or "not covered",
        "total travel": f"{result['total_travel']} (without pauses {result['total_moves']}; "
        f"sum of distances {result['sum_of_distances']})",
        "max travel": f"{result['max_travel']} (without pauses {result['max_moves']}; "
        f"largest distance {result['max_distance']})",
        "collisions": result["collisions"],
        "steps": result["steps"],
    }
    return "\n".join(f"{name:14}{value}" for name, value in lines.items())


def _region(map_file: Path | None, grid: str | None, doors: list[str], force: bool) -> "Region":
    from gridworld.regions import load, rectangle
    from troupe.grid import two_numbers, with_doors

    if (map_file is None) == (grid is None):
        raise UsageError("MAP: give either a map or --grid WxH")
    region = load(map_file) if map_file else rectangle(*two_numbers("--grid", str(grid), "x"))
    return with_doors(region, doors, holes=force)


def _one_of(option: str, text: str, allowed: list[str]) -> str:
    if text in allowed:
        return text
    close = difflib.get_close_matches(text, allowed, 1)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    message = f"{text!r} is not one of {', '.join(allowed)}{hint}"
    raise typer.BadParameter(message, param_hint=option)


def _fail(message: str) -> NoReturn:
    print(message, file=sys.stderr)
    raise typer.Exit(2)
