"""`troupe view`: a run in the browser, which stands until somebody lets it go on."""

from __future__ import annotations

from typing import Annotated

import typer

from troupe.commands.run import Watched, run_and_show


def view(
    world: Annotated[
        str, typer.Argument(metavar="WORLD", help="A world file, or the name of one of Troupe's.")
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
    read_only: Annotated[
        bool, typer.Option("--read-only", help="Whoever watches can only watch.")
    ] = False,
    seed: Annotated[
        int | None,
        typer.Option(help="All that is random follows from it.", show_default="the world's"),
    ] = None,
    duration: Annotated[
        float | None,
        typer.Option(help="Simulated seconds at most.", show_default="the world's"),
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Change the world, as in models.rover.drive.max_speed=0.3. May be repeated.",
            show_default="no change",
        ),
    ] = None,
    realtime: Annotated[
        float,
        typer.Option(metavar="FACTOR", help="The pace at first; the page can change it."),
    ] = 1.0,
    listen: Annotated[
        str | None,
        typer.Option(
            metavar="HOST:PORT",
            help="Let Player clients connect over TCP.",
            show_default="only where the world says so",
        ),
    ] = None,
    patience: Annotated[
        float,
        typer.Option(
            help="Wall-clock seconds that a controller may hold up the others; twice that until "
            "its first request. 0: for ever."
        ),
    ] = 60.0,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the last run's result as one JSON object.")
    ] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", help="No progress, no controllers' output.")
    ] = False,
) -> None:
    """Watch a world in the browser: it stands at its beginning until you let it go on.

    The page stays when the run is over, and can begin it again. Ctrl-C ends it.
    """
    run_and_show(
        world,
        as_json=as_json,
        quiet=quiet,
        watched=Watched(address, not no_open, read_only, paused=not read_only, stays=True),
        seed=seed,
        duration=duration,
        settings=set_ or [],
        realtime=realtime,
        listen=listen,
        patience=patience,
    )
