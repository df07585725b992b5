"""All commands of `troupe`, put together."""

from __future__ import annotations

from typing import Annotated

import typer

from troupe import __version__
from troupe.check import check
from troupe.devices_command import devices
from troupe.disperse import disperse
from troupe.import_command import import_
from troupe.print_command import print_
from troupe.run_command import run
from troupe.schema import schema
from troupe.sensors_command import sensors
from troupe.warm import warm
from troupe.worlds_command import worlds

app = typer.Typer(
    help="A 2D physics simulator for teams of mobile robots that speaks Player's protocol.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def show_version(wanted: bool) -> None:
    if wanted:
        print(f"troupe {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=show_version, is_eager=True, help="Show it.")
    ] = False,
) -> None:
    """What every command has in common."""


app.command("run")(run)
app.command("worlds")(worlds)
app.command("check")(check)
app.command("schema")(schema)
app.command("sensors")(sensors)
app.command("disperse")(disperse)
app.command("devices")(devices)
app.command("print")(print_)
app.command("import")(import_)
app.command("warm")(warm)
