"""`troupe view`: a run, or a log of one, in the browser; it stands until somebody lets it go on."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from player.printable import printable_lines
from sim.interrupts import Interrupts
from troupe import run_options as common
from troupe.commands.run import Watched, run_and_show
from troupe.given_options import given_options
from troupe.interrupts import leave
from troupe.show import Screen
from troupe.usage import UsageError, told


def view(
    context: typer.Context,
    world: Annotated[
        str,
        typer.Argument(
            metavar="WORLD|LOG.mcap",
            help="A world file, the name of one of Troupe's, or a log (`LOG.mcap#t=12.5`: from "
            "12.5 s on).",
        ),
    ],
    address: Annotated[
        str | None,
        typer.Option(
            "--at",
            metavar="HOST:PORT",
            help="Where the page is served.",
            show_default="a free port of this machine",
        ),
    ] = None,
    no_open: Annotated[
        bool, typer.Option("--no-open", help="Tell the address, but open no browser.")
    ] = False,
    read_only: common.ReadOnly = False,
    seed: common.Seed = None,
    duration: common.Duration = None,
    set_: common.Changes = None,
    realtime: Annotated[
        float,
        typer.Option(metavar="[FACTOR]", help="The pace at first; the page can change it."),
    ] = 1.0,
    listen: common.Listen = None,
    patience: common.Patience = 60.0,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the last run's result as one JSON object.")
    ] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", help="No progress, no controllers' output.")
    ] = False,
) -> None:
    """Watch a world in the browser, or a log: it stands at its beginning until you let it go on.

    The page stays when the run is over, and can begin it again. Of a log it shows any time. Ctrl-C
    ends it.
    """
    paused = not read_only  # or nobody could let it go on
    watched = Watched(address, not no_open, read_only, paused=paused, stays=True, option="at")
    try:
        log, start = as_log(world)
    except UsageError as error:
        print(printable_lines(str(error)), file=sys.stderr)
        raise typer.Exit(2) from None
    if log is not None:
        given = given_options(context, {"world", "address", "no_open", "read_only", "quiet"})
        show_log(log, start, watched, given, quiet=quiet)
    run_and_show(
        world,
        as_json=as_json,
        quiet=quiet,
        watched=watched,
        seed=seed,
        duration=duration,
        settings=set_ or [],
        realtime=realtime,
        listen=listen,
        patience=patience,
    )


PLACE = re.compile(r"(.+\.mcap)(#.*)?", re.IGNORECASE | re.DOTALL)
"""A log, and where in it to begin."""
MOMENT = re.compile(r"#t=([0-9]+(?:\.[0-9]+)?)")
"""From which second of a log on, as in the page's links."""


def as_log(name: str) -> tuple[Path | None, float]:
    """A log's file and the second to begin at; None for what is a world.

    Raises UsageError where what follows the file's name is no moment of it.
    """
    found = PLACE.fullmatch(name)
    if found is None:
        return None, 0.0
    if found[2] is None or Path(name).is_file():
        return Path(name), 0.0
    moment = MOMENT.fullmatch(found[2])
    if moment is None:
        raise UsageError(f"{name}: no moment of a log; from 12.5 s on is {found[1]}#t=12.5")
    return Path(found[1]), float(moment[1])


def show_log(
    path: Path, start: float, watched: Watched, given: list[str], *, quiet: bool
) -> NoReturn:
    """Show a log until somebody ends it, and exit. `given`: options that only a run can have."""
    from sim.log.errors import LogError  # noqa: PLC0415

    interrupts = Interrupts(again=leave)
    code = 0
    try:
        if given:
            raise UsageError(f"{given[0]}: {path} is a log of a run that is over")
        with Screen(quiet) as screen:
            from troupe.log import Log  # noqa: PLC0415 - `troupe --help` stays quick
            from troupe.warm import warm_once  # noqa: PLC0415

            log = Log(path)
            warm_once(screen.say)
            with watched.of_log(screen, log, start) as view:
                interrupts.hold()
                view.play(lambda: not interrupts.noted)
    except (UsageError, LogError) as error:
        print(printable_lines(str(error)), file=sys.stderr)
        code = 2
    except OSError as error:
        print(printable_lines(told(error)), file=sys.stderr)
        code = 2
    interrupts.release()
    raise typer.Exit(code)
