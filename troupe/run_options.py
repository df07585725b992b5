"""The options of a run and of its page, which `troupe run` and `troupe view` share."""

from __future__ import annotations

from typing import Annotated

import typer

Seed = Annotated[
    int | None,
    typer.Option(help="All that is random follows from it.", show_default="the world's"),
]
Duration = Annotated[
    float | None,
    typer.Option(help="Simulated seconds at most.", show_default="the world's"),
]
Changes = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change the world, as in models.rover.drive.max_speed=0.3. May be repeated.",
        show_default="no change",
    ),
]
Listen = Annotated[
    str | None,
    typer.Option(
        metavar="HOST:PORT",
        help="Let Player clients connect over TCP.",
        show_default="only where the world says so",
    ),
]
Patience = Annotated[
    float,
    typer.Option(
        help="Wall-clock seconds that a controller may hold up the others; twice that until "
        "its first request. 0: for ever."
    ),
]
ReadOnly = Annotated[bool, typer.Option("--read-only", help="Whoever watches can only watch.")]
